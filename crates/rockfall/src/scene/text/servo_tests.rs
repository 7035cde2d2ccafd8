use std::path::Path;

use glam::DVec3;

use crate::scene::{Scene, Servo};

fn parse(text: &str) -> crate::Result<Scene> {
    Scene::parse(text, Path::new("press.txt")).map(|loaded| loaded.scene)
}

const PRESS: &str = "# A press
@servo lid force=0,-20,0 speed=0.5
@servo vane torque=-3 axis=0,2,0 through=1,0,0 speed=2 displacement=0.25 velocity=-1.5
@move lid
B 0 1 0  1 0 0  0 1 0  0 0 1
";

#[test]
fn servos_are_read_and_written() {
    let scene = parse(PRESS).unwrap();
    let [lid, vane] = scene.motions() else { panic!("two motions") };
    assert_eq!((lid.servo, lid.terms.len()), (Some(Servo::force([0.0, -20.0, 0.0], 0.5)), 0));
    let mut turning = Servo::torque(-3.0, [0.0, 2.0, 0.0], [1.0, 0.0, 0.0], 2.0);
    (turning.displacement, turning.velocity) = (0.25, -1.5);
    assert_eq!(vane.servo, Some(turning));
    assert_eq!((turning.target(), turning.direction()), (-3.0, DVec3::Y));
    assert_eq!(scene.boxes()[0].motion, scene.find_motion("lid"));

    let text = scene.to_text();
    let again = parse(&text).unwrap();
    assert_eq!(again.motions(), scene.motions());
    assert_eq!(again.to_text(), text);
    assert!(text.contains("@servo lid force=0,-20,0 speed=0.5\n"), "{text}");
}

#[test]
fn wrong_lines_name_the_field() {
    for (line, message) in [
        ("@servo a force=0,1 speed=1", "press.txt:2: @servo force: '0,1' is not allowed, expected three numbers x,y,z"),
        ("@servo a force=0,0,0 speed=1", "@servo force: [0.0, 0.0, 0.0] is not allowed, expected three finite numbers that"),
        ("@servo a force=0,1,0", "@servo speed: missing, expected `@servo NAME force=x,y,z|torque=T"),
        ("@servo a force=0,1,0 speed=0", "@servo speed: 0 is not allowed, expected a finite number above 0"),
        ("@servo a force=0,1,0 speed=-1", "@servo speed: -1 is not allowed"),
        ("@servo a force=0,1,0 speed=1 speed=2", "@servo speed: given twice in the line"),
        ("@servo a force=0,1,0 torque=1 speed=1", "@servo torque: given with force, expected one of them"),
        ("@servo a force=0,1,0 axis=0,1,0 speed=1", "@servo axis: given with force, expected it with torque only"),
        ("@servo a torque=1 speed=1 through=0,0,0", "@servo axis: missing"),
        ("@servo a torque=1 speed=1 axis=0,0,1", "@servo through: missing"),
        ("@servo a torque=1 axis=0,0,0 through=0,0,0 speed=1", "@servo axis: [0.0, 0.0, 0.0] is not allowed"),
        ("@servo a torque=inf axis=0,0,1 through=0,0,0 speed=1", "@servo torque: 'inf' is not a finite number"),
        (
            "@servo a force=0,1,0 speed=1 velocity=2",
            "@servo velocity: 2 is not allowed, expected a number from -speed to speed",
        ),
        ("@servo a speed=1", "@servo force or torque: missing"),
        ("@servo a forces=0,1,0 speed=1", "@servo 'forces': an unknown key, did you mean force?"),
        ("@servo force=0,1,0 speed=1", "@servo NAME: missing"),
        ("@servo a force=0,1,0 speed=1\n@servo a force=0,1,0 speed=1", "@servo name: a is not allowed, expected a name"),
        ("@servo a force=0,1,0 speed=1\n@motion a velocity=1,0,0", "@motion terms: 1 and a servo is not allowed"),
    ] {
        let error = parse(&format!("# Press\n{line}\n")).unwrap_err().to_string();
        assert!(error.contains(message), "{line}: {error}");
    }
}
