use std::path::Path;

use super::*;

const WALLS: &str = "@motion drum spin=1 axis=0,0,1 through=0,0,0\n@move drum\nB 0 0 0 1 0 0 0 1 0 0 0 1\n@move -\n\
                     @name floor\n@triangle 0 0 0 1 0 0 0 0 1\n";

fn parse(gauges: &str) -> std::result::Result<Scene, String> {
    let text = format!("# a scene\n{gauges}\n{WALLS}");
    Scene::parse(&text, Path::new("a.txt")).map(|loaded| loaded.scene).map_err(|error| error.to_string())
}

#[test]
fn gauges_are_read_and_written() {
    let lines = "@gauge name=torque wall=drum\n@gauge plane=0.1,2,-3,0,-2.5,0 name=out\n@gauge name=weight wall=floor";
    let scene = parse(lines).unwrap();
    let expected = [
        Gauge::wall("torque", "drum"),
        Gauge::plane("out", [0.1, 2.0, -3.0], [0.0, -2.5, 0.0]),
        Gauge::wall("weight", "floor"),
    ];
    assert_eq!(scene.gauges(), expected);
    let text = scene.to_text();
    let again = Scene::parse(&text, Path::new("b.txt")).unwrap().scene;
    assert_eq!((again.gauges(), again.to_text()), (&expected[..], text));
}

#[test]
fn a_wrong_gauge_is_an_error_at_its_line() {
    for (line, expected) in [
        (
            "@gauge name=a wall=dram",
            "a.txt:2: @gauge wall: 'dram' (similar: 'drum') is not allowed, expected the name of a motion",
        ),
        ("@gauge name=a wall=a\n", "a.txt:2: @gauge wall: 'a' is not allowed"),
        ("@gauge name=a", "@gauge wall or plane: missing, expected `@gauge name=N wall=NAME|plane=x,y,z,nx,ny,nz`"),
        ("@gauge wall=drum", "@gauge name: missing"),
        ("@gauge name=a wall=drum plane=0,0,0,1,0,0", "@gauge plane: given twice in the line, expected either one wall or one"),
        ("@gauge name=a name=b wall=drum", "@gauge name: given twice in the line, expected one name"),
        ("@gauge name=a plane=0,0,0,1,0", "@gauge plane: '0,0,0,1,0' is not allowed, expected six numbers x,y,z,nx,ny,nz"),
        ("@gauge name=a plane=0,0,0,1,0,inf", "@gauge plane: 'inf' is not a finite number"),
        (
            "@gauge name=a plane=1,0,0,0,0,0",
            "@gauge plane: [1.0, 0.0, 0.0] [0.0, 0.0, 0.0] is not allowed, expected six finite",
        ),
        ("@gauge name=1a wall=drum", "@gauge name: '1a' is not allowed, expected one word"),
        ("@gauge name=a wal=drum", "@gauge 'wal': an unknown key, did you mean wall?"),
        ("@gauge drum name=a", "@gauge 'drum': expected KEY=VALUE with a key of name, wall, plane"),
        ("@gauge drum", "@gauge line: no value, expected `@gauge name=N"),
        (
            "@gauge name=a wall=drum\n@gauge name=a wall=floor",
            "a.txt:3: @gauge name: 'a' is not allowed, expected a name that no",
        ),
    ] {
        let error = parse(line).unwrap_err();
        assert!(error.contains(expected), "{line}: {error}");
    }
}

/// A motion that no wall follows is no wall.
#[test]
fn a_motion_without_walls_has_no_gauge() {
    let mut scene = parse("@motion idle velocity=1,0,0").unwrap();
    let error = scene.add_gauge(Gauge::wall("a", "idle")).unwrap_err().to_string();
    assert!(error.contains("'idle'"), "{error}");
    scene.add_gauge(Gauge::wall("a", "drum")).unwrap();
    assert!(scene.add_gauge(Gauge::wall("a", "drum")).is_err());
    assert!(scene.add_gauge(Gauge::plane("b", [0.0; 3], [0.0; 3])).is_err());
    assert_eq!(scene.gauges().len(), 1);
}
