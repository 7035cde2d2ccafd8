//! Special words in every number of a scene of the contact law `rigid`: a clear error, or a run whose states are finite.

use std::path::Path;

use rockfall::glam::Vec3;
use rockfall::{Backend, Error, Options, Scene, Simulation};

/// Everything that the law takes. The bodies lie on the floor, on each other and against the walls.
const SCENE: &str = "\
set contact_law rigid
set gravity 9.81
set gravity_direction 0,-1,0
set restitution 0.5
set coulomb_friction 0.5
@run dt=0.016 substeps=4
@material ice density=900
@material steel density=8000
@pair ice steel restitution=0.25 friction=0.125
@use ice
@surface velocity=1,0,0.5
B -9 -1 -9 18 0 0 0 1 0 0 0 18
@surface -
P 3 0 -9 -1 0 18 -1 5 0
@plane at=-9,0,0 normal=1,0.25,0
S 1 0 0.5 0 0 -3 0 0 0.1 0 1 0.5
S 2 0.2 1.4 0.1 0 0 0 0 0 0 - 0.5 0
S 3 2 0.25 0 0 0 0 0 0 0 1 0.25 1
C -2 0.3 0 -1 0.3 0 0 -1 0 1 0.3
@force 1 1 2 3
@orientation 1 1 0 0 0
@use steel
@body cube mass=2 rounding=0.05
B -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1
@end
@body jack mass=3 centre=0,0,0 inertia=0.1,0.2,0.2,0,0,0
S 1 -0.3 0 0 0 0 0 0 0 0 - 0.2
S 2 0.3 0 0 0 0 0 0 0 0 - 0.2
R 1 2 0.1
@end
@body pill density=3
C 0 0 -0.3 0 0 0.3 0 0 0 - 0.1
@end
@body odd mass=2 centre=0,0.1,0 inertia=1,2,2.5,0,0,0.1
@hull -0.5,0,-0.5 0.5,0,-0.5 0,0,0.5 0,0.75,0
@end
@place cube at=0,0.45,3 axis=0,1,0 turn=30 velocity=0,-1,0 spin=0,1,0
@place cube centre=0,1.5,3 orientation=1,0,0,0 momentum=0,0.5,0 force=0,1,0.5 torque=0.25,0,0
@place cube at=4,0.5,4 fixed=1
@place jack at=4,1.2,4 axis=1,2,3 turn=40 first=20
@place pill at=2,0.1,-2
@place odd at=-4,0,4 spin=0,0,1
@force 20 0 0 1
@group 2
S 9 4 0.4 4 0 0 0 0 0 0 1 0.5
";

const POISONS: [&str; 14] =
    ["nan", "inf", "-inf", "1e300", "3.4e38", "1e30", "1e18", "1e-18", "1e-30", "1e-45", "-1", "0", "", "x"];

/// Start and end of each number of a line that starts a word, or follows `=` or `,`.
fn numbers(line: &str) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut start = 0;
    for (end, _) in line.char_indices().filter(|(_, c)| " ,=".contains(*c)).chain([(line.len(), ' ')]) {
        if line[start..end].parse::<f32>().is_ok() {
            found.push((start, end));
        }
        start = end + 1;
    }
    found
}

/// The error must name a line and a field, and what would be right.
fn check_error(what: &str, line: usize, error: &Error) {
    let Error::SceneLine { line: told, field, message, .. } = error else { panic!("{what}: {error}") };
    assert!(["expected", "is not a"].iter().any(|words| message.contains(words)), "{what}: {error}");
    assert!(!field.is_empty() && message.len() < 400, "{what}: {error}");
    // A wrong mass or reference is seen at a line that uses it.
    assert!(*told >= line || what.starts_with("B ") || what.starts_with("C ") || what.starts_with("@hull"), "{what}: {error}");
}

fn check_run(what: &str, scene: &Scene, keep_going: bool) -> bool {
    let options = Options::new().backend(Backend::Cpu).keep_going(keep_going);
    let mut simulation = match Simulation::with_options(scene.clone(), options) {
        Ok(simulation) => simulation,
        Err(Error::Invalid { expected, .. }) => {
            assert!(!expected.is_empty());
            return false;
        }
        Err(error) => panic!("{what}: {error}"),
    };
    let dt = scene.run.dt.unwrap_or(0.016);
    for _ in 0..4 {
        match simulation.run(1, dt) {
            Ok(_) => {}
            Err(Error::NonFinite { .. }) if !keep_going => {}
            Err(error) => panic!("{what}: {error}"),
        }
    }
    simulation.contacts().unwrap_or_else(|error| panic!("{what}: {error}"));
    simulation.energy().unwrap_or_else(|error| panic!("{what}: {error}"));
    let scene = simulation.sync().unwrap();
    let is_finite = |vectors: &[Vec3]| vectors.iter().all(|vector| vector.is_finite());
    for sphere in scene.spheres() {
        let finite = is_finite(&[sphere.position, sphere.velocity, sphere.angular_momentum]);
        assert!(finite && sphere.orientation.is_finite(), "{what}: {sphere:?}");
    }
    for body in scene.bodies() {
        let finite = is_finite(&[body.position, body.velocity, body.angular_momentum]);
        assert!(finite && body.orientation.is_finite(), "{what}: {body:?}");
    }
    true
}

#[test]
fn every_number_of_hard_contacts_is_rejected_or_contained() {
    let lines: Vec<&str> = SCENE.lines().collect();
    let (mut rejected, mut run) = (0, 0);
    for (number, line) in lines.iter().enumerate() {
        for (start, end) in numbers(line) {
            for poison in POISONS {
                let poisoned = format!("{}{poison}{}", &line[..start], &line[end..]);
                let mut text = lines.clone();
                text[number] = &poisoned;
                match Scene::parse(&text.join("\n"), Path::new("poison.txt")) {
                    Ok(loaded) => {
                        let again = Scene::parse(&loaded.scene.to_text(), Path::new("again.txt")).expect(&poisoned).scene;
                        assert_eq!(again.to_text(), loaded.scene.to_text(), "{poisoned}");
                        run += [true, false]
                            .map(|keep_going| i32::from(check_run(&poisoned, &loaded.scene, keep_going)))
                            .iter()
                            .sum::<i32>();
                    }
                    Err(error) => {
                        check_error(&poisoned, number + 1, &error);
                        rejected += 1;
                    }
                }
            }
        }
    }
    assert!(rejected > 1000 && run > 1000, "{rejected} rejected, {run} run");
}
