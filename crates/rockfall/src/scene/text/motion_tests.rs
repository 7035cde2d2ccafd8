use std::path::Path;

use glam::{DVec3, Vec3};

use crate::scene::{MotionTerm, Scene, Surface};

fn parse(text: &str) -> crate::Result<Scene> {
    Scene::parse(text, Path::new("walls.txt")).map(|loaded| loaded.scene)
}

const WALLS: &str = "# Walls
@motion drum spin=0.5 axis=0,0,1 through=0,1,0
@motion lid velocity=0,-0.25,0 from=1 to=2.5
@motion lid amplitude=0,0.001,0 frequency=50 phase=0.25
@move drum
B 0 0 0  1 0 0  0 1 0  0 0 1
@move lid
P 0 1 0  0 0 1  1 0 0
@move -
P 0 -1 0  0 0 1  1 0 0
";

#[test]
fn motions_are_read_and_written() {
    let scene = parse(WALLS).unwrap();
    let [drum, lid] = scene.motions() else { panic!("two motions") };
    assert_eq!(drum.terms, [MotionTerm::turn(0.5, DVec3::Z, [0.0, 1.0, 0.0])]);
    let slide = MotionTerm::translation([0.0, -0.25, 0.0]).during(1.0, 2.5);
    assert_eq!(lid.terms, [slide, MotionTerm::oscillation([0.0, 0.001, 0.0], 50.0).phase(0.25)]);
    assert_eq!(scene.boxes()[0].motion, scene.find_motion("drum"));
    assert_eq!([0, 1].map(|index| scene.polygons()[index].motion), [scene.find_motion("lid"), None]);

    let text = scene.to_text();
    let again = parse(&text).unwrap();
    assert_eq!(again.motions(), scene.motions());
    assert_eq!(again.to_text(), text);
    assert!(text.contains("@move lid\nP 0 1 0 "), "{text}");
}

#[test]
fn wrong_lines_name_the_field() {
    for (line, message) in [
        ("@motion a velocity=1,2", "walls.txt:2: @motion velocity: '1,2' is not allowed, expected three numbers x,y,z"),
        ("@motion a velocity=1,2,inf", "@motion velocity: 'inf' is not a finite number"),
        ("@motion a speed=1", "@motion 'speed': an unknown key"),
        ("@motion a spin=1", "@motion spin: given without axis"),
        ("@motion a amplitude=1,0,0", "@motion amplitude: given without frequency"),
        ("@motion a spin=1 axis=0,0,0", "@motion axis"),
        ("@motion a velocity=1,0,0 velocity=1,0,0", "given twice"),
        ("@motion velocity=1,0,0", "@motion NAME: missing"),
        ("@motion a velocity=1,0,0 from=3 to=1", "@motion to"),
        ("@move a", "@move 'a': an unknown motion"),
        ("@move", "@move NAME: missing"),
        (
            "@motion a velocity=1,0,0\n@move a\nS 0 0 0 0 1 0 0 0 0 0 1 1 1",
            "S velocity: a fixed sphere that follows a motion has no velocity of its own, expected 0",
        ),
    ] {
        let error = parse(&format!("# Walls\n{line}\n")).unwrap_err().to_string();
        assert!(error.contains(message), "{line}: {error}");
    }
}

#[test]
fn fixed_spheres_that_follow_a_motion_are_smooth_walls() {
    let text = "@motion pin velocity=1,0,0\n@move pin\n@name left\nS 0 1 2 3 0 0 0 0 0 0 1 0.25 1\n@move -\nS 1 0 0 0 0 0 0 0 0 0 1 0.5 1\n";
    let scene = parse(text).unwrap();
    let ball = scene.polygons()[0];
    assert_eq!((scene.spheres().len(), scene.polygons().len()), (1, 1));
    assert_eq!((ball.corner, ball.surface), (Vec3::new(1.0, 2.0, 3.0), Surface::Ball { inside: false }));
    assert!(ball.motion.is_some());
    assert!(scene.to_text().contains("@move pin\n@ball at=1,2,3 radius=0.25\n"), "{}", scene.to_text());
}
