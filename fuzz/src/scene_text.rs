//! The target `scene_text`: any bytes as a scene text.

use std::path::Path;

use rockfall::{Backend, ContactLaw, Error, Integrator, ObjectId, Options, RigidBody, Scene, Simulation, Sphere, Tag};

use super::message::{LONGEST_MESSAGE, assert_short};

/// A block of a few bytes may stand for a million spheres, which take too long to compare.
const LARGE: usize = 10_000;
/// Most objects of a scene that is run.
const FEW: usize = 200;

/// Reads any bytes as a scene. The error for a rejected text must name its line. An accepted text is written and read again,
/// and the objects must be bitwise identical.
///
/// # Panics
/// When the reader breaks one of these promises.
pub fn scene_text(bytes: &[u8]) {
    let read = match Scene::parse_bytes(bytes, Path::new("fuzz.txt")) {
        Ok(loaded) => {
            for warning in &loaded.warnings {
                assert!(warning.text.len() < LONGEST_MESSAGE && !warning.text.contains(char::is_control), "{warning:?}");
            }
            loaded.scene
        }
        Err(error) => return is_told(&error, bytes),
    };
    if read.counts().spheres > LARGE {
        return;
    }
    for integrator in Integrator::ALL {
        let _ = read.check_contact_law(integrator).inspect_err(assert_short);
        for warning in read.stability(0.02, integrator) {
            assert!(!warning.largest_dt.is_nan() && warning.largest_dt < 0.02, "{warning:?}");
        }
    }
    let text = read.to_text();
    let again = match Scene::parse(&text, Path::new("again.txt")) {
        Ok(loaded) => loaded,
        Err(error) => panic!("the written text cannot be read: {error}\n{text}"),
    };
    assert_eq!(again.warnings, [], "{text}");
    assert_eq!(all(&again.scene), all(&read), "{text}");
    assert_eq!(again.scene.to_text(), text);
    if read.settings.contact_law == ContactLaw::Rigid {
        run(read);
    }
}

/// Runs two frames of hard contacts, if the scene is small. Its states must stay finite.
fn run(mut scene: Scene) {
    let counts = scene.counts();
    if counts.spheres + counts.boxes + counts.polygons > FEW {
        return;
    }
    let dt = scene.run.dt.unwrap_or(1.0 / 60.0);
    scene.run.substeps = Some(4);
    let options = Options::new().backend(Backend::Cpu).keep_going(true);
    let ended = Simulation::with_options(scene, options).and_then(|mut simulation| {
        simulation.run(2, dt)?;
        simulation.contacts()?;
        simulation.sync().cloned()
    });
    match ended {
        Ok(scene) => {
            let is_finite = |sphere: &Sphere| sphere.position.is_finite() && sphere.velocity.is_finite();
            assert!(scene.spheres().iter().all(is_finite), "{:?}", scene.spheres());
            let is_finite = |body: &RigidBody| body.position.is_finite() && body.angular_momentum.is_finite();
            assert!(scene.bodies().iter().all(is_finite), "{:?}", scene.bodies());
        }
        Err(error) => assert_short(&error),
    }
}

/// Checks that a message has the form `fuzz.txt:LINE: FIELD: ...`, is short, and has no control characters.
fn is_told(error: &Error, bytes: &[u8]) {
    assert_short(error);
    let message = error.to_string();
    let line = message.strip_prefix("fuzz.txt:").and_then(|rest| rest.split(':').next()?.parse::<usize>().ok());
    // A text without lines cannot be wrong, so an error always has a line.
    let lines = bytes.split(|byte| *byte == b'\n').count();
    assert!(line.is_some_and(|line| (1..=lines).contains(&line)), "{message}");
}

/// Returns all data of a scene as text. Numbers are printed so that they can be read back exactly. Handles are printed as
/// slots, which are insertion indices in a scene that was just read.
fn all(scene: &Scene) -> String {
    let spheres = (scene.spheres(), scene.rods(), scene.capsules());
    let movers = (tags(scene, scene.sphere_ids()), tags(scene, scene.rod_ids()), tags(scene, scene.capsule_ids()));
    let others = (tags(scene, scene.spring_ids()), tags(scene, scene.box_ids()), tags(scene, scene.polygon_ids()));
    let tags = (movers, others);
    format!(
        "{:?} {:?} {:?} {spheres:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {tags:?}",
        scene.settings,
        scene.run,
        scene.materials(),
        scene.springs(),
        scene.tethers(),
        scene.joints(),
        scene.boxes(),
        scene.polygons(),
        scene.inlets(),
        scene.outlets(),
        scene.sensors()
    )
}

/// The names, colours, looks and labels of objects of one kind.
fn tags(scene: &Scene, ids: impl Iterator<Item = impl Into<ObjectId>>) -> Vec<Option<&Tag>> {
    ids.map(|id| scene.tag(id).unwrap_or_default()).collect()
}
