use std::path::Path;

use crate::Checkpoint;
use crate::scene::{Scene, Sensor};

fn parse(text: &str) -> crate::Result<Scene> {
    Scene::parse(text, Path::new("gate.txt")).map(|loaded| loaded.scene)
}

#[test]
fn sensors_are_read_and_written() {
    let text = "# Gates\n@sensor name=gate box=-1,2,-1,1,2.5,1\n@repeat 2 0 10 0\n@sensor box=0,0,0,1,1,1\n@end\n";
    let scene = parse(text).unwrap();
    let expected = [
        Sensor::new("gate", [[-1.0, 2.0, -1.0], [1.0, 2.5, 1.0]]),
        Sensor::new("sensor", [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]),
        Sensor::new("sensor2", [[0.0, 10.0, 0.0], [1.0, 11.0, 1.0]]),
    ];
    assert_eq!(scene.sensors(), expected);
    let written = scene.to_text();
    let again = parse(&written).unwrap();
    assert_eq!(again.sensors(), expected);
    assert_eq!(again.to_text(), written);
}

#[test]
fn wrong_lines_name_the_field_and_what_was_expected() {
    let cases = [
        ("@sensor name=a", "@sensor box: missing, expected six numbers box=x0,y0,z0,x1,y1,z1 without spaces"),
        ("@sensor box=0,0,0,1,1", "@sensor box: '0,0,0,1,1' is not allowed, expected six numbers"),
        ("@sensor box=0,0,0,1,1,0", "expected six finite numbers x0,y0,z0,x1,y1,z1 with x0 < x1, y0 < y1 and z0 < z1"),
        ("@sensor name=2 box=0,0,0,1,1,1", "@sensor name: '2' is not allowed, expected one word that begins with a letter"),
        ("@sensor boxx=0,0,0,1,1,1", "@sensor 'boxx': an unknown key, did you mean box?"),
        ("@sensor 0 0 0 box=0,0,0,1,1,1", "@sensor '0': expected KEY=VALUE with a key of name, box"),
        ("@sensor box=0,0,0,1,1,1 box=0,0,0,1,1,1", "@sensor box: given twice in the line"),
        ("@sensor name=a box=0,0,0,1,1,1\n@sensor name=a box=0,0,0,1,1,1", "expected a name that no other sensor has"),
    ];
    for (text, expected) in cases {
        let error = parse(&format!("# Gates\n{text}\n")).unwrap_err().to_string();
        assert!(error.starts_with("gate.txt:") && error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn a_checkpoint_keeps_sensors() {
    let scene = parse("# Gates\n@sensor name=gate box=-1,2,-1,1,2.5,1\nS 1 0 0 0 0 0 0 0 0 0 1 0.5\n").unwrap();
    let checkpoint = crate::Simulation::with_options(scene, crate::Options::new().backend(crate::Backend::Cpu))
        .and_then(|mut simulation| simulation.checkpoint())
        .unwrap();
    let again = Checkpoint::from_bytes(&checkpoint.to_bytes(), "memory").unwrap();
    assert_eq!(again.scene.sensors(), checkpoint.scene.sensors());
    assert_eq!(again.scene.sensors().len(), 1);
}
