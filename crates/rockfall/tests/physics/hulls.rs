//! Convex hulls of rigid bodies under the contact law `rigid`, from scene text to checkpoints.

use std::path::Path;

use rockfall::glam::Vec3;
use rockfall::{Backend, Checkpoint, Options, Scene, Simulation};

const FRAME: f32 = 1.0 / 60.0;
const FLOOR: &str = "set contact_law rigid\nset gravity 9.81\nB -20 -1 -20 40 0 0 0 1 0 0 0 40\n";
const CORNERS: &str =
    "@hull -0.5,-0.5,-0.5 0.5,-0.5,-0.5 -0.5,0.5,-0.5 0.5,0.5,-0.5 -0.5,-0.5,0.5 0.5,-0.5,0.5 -0.5,0.5,0.5 0.5,0.5,0.5";
const TETRAHEDRON: &str = "@hull 0,0,0 1,0,0 0,1,0 0,0,1";

fn scene(text: &str) -> Scene {
    Scene::parse(text, Path::new("test")).unwrap_or_else(|error| panic!("{error}")).scene
}

fn open(text: &str, backend: Backend) -> Simulation {
    Simulation::with_options(scene(text), Options::new().backend(backend)).expect("it opens")
}

both! {
    a_tetrahedron_comes_to_rest_at_the_height_of_its_centre,
    a_hull_of_the_corners_of_a_cube_moves_like_the_cube,
    hulls_of_several_bodies_and_shapes_meet,
    resumed_hulls_have_the_same_bits,
}

/// Its centre is a quarter of its edge above the ground, less the sink of a contact with the ground: g / w² as for a cube, 0.03 mm.
fn a_tetrahedron_comes_to_rest_at_the_height_of_its_centre(backend: Backend) {
    let text = format!("{FLOOR}@body t density=1000\n{TETRAHEDRON}\n@end\n@place t at=0,0.3,0\n");
    let mut simulation = open(&text, backend);
    simulation.run(240, FRAME).expect("4 s");
    let body = simulation.sync().expect("states").bodies()[0].clone();
    assert!((body.position.y - 0.25).abs() < 1e-4, "{}", body.position);
    let energy = simulation.energy().expect("the energy");
    // Of the 1635 J of its weight times 1 unit.
    assert!(energy.kinetic < 1e-6, "{energy:?}");
}

fn a_hull_of_the_corners_of_a_cube_moves_like_the_cube(backend: Backend) {
    let run = |part: &str| {
        let place = "@place b at=0,0.8,0 axis=1,2,3 turn=40 velocity=1,0,0.5 spin=0,1,2\n";
        let mut simulation = open(&format!("{FLOOR}@body b mass=3\n{part}\n@end\n{place}"), backend);
        // The first contact of an edge or corner comes after a few frames.
        simulation.run(60, FRAME).expect("1 s");
        simulation.sync().expect("states").bodies()[0].clone()
    };
    let (hull, solid) = (run(CORNERS), run("B -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1"));
    assert!(hull.position.distance(solid.position) < 1e-5, "{} {}", hull.position, solid.position);
    assert!(1.0 - hull.orientation.dot(solid.orientation).abs() < 1e-5, "{} {}", hull.orientation, solid.orientation);
    assert!(hull.position.y < 0.8 && solid.velocity.length() > 0.0);
}

/// Two hulls on a box of a body, hulls with a ball in one body, and two shapes of which neither takes the place of the other.
fn hulls_of_several_bodies_and_shapes_meet(backend: Backend) {
    let text = format!(
        "{FLOOR}@body a mass=1\n{CORNERS}\n@end\n@body b mass=1\n{TETRAHEDRON}\nS 1 -0.3 0.3 0.3 0 0 0 0 0 0 - 0.3\n@end\n\
         @body c mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n@place c at=0,0.5,0\n@place a at=0,1.5,0\n@place a at=0,2.5,0\n\
         @place b at=4,0.1,0\n@place b at=-4,0.1,0 axis=0,1,0 turn=90\n"
    );
    let mut simulation = open(&text, backend);
    simulation.run(300, FRAME).expect("5 s");
    let heights: Vec<f32> = simulation.sync().expect("states").bodies().iter().map(|body| body.position.y).collect();
    for (height, expected) in heights.iter().zip([0.5, 1.5, 2.5]) {
        assert!((height - expected).abs() < 2e-3, "{heights:?}");
    }
    // The tetrahedron of 1/6 with its centre at 1/4, and the ball of 0.036 pi at 0.3.
    let (tetrahedron, ball) = (1.0 / 6.0, 0.036 * std::f32::consts::PI);
    let expected = (0.25 * tetrahedron + 0.3 * ball) / (tetrahedron + ball);
    assert!(heights[3..].iter().all(|height| (height - expected).abs() < 1e-3), "{heights:?}, expected {expected}");
    let contacts = simulation.contacts().expect("contacts");
    assert!(contacts.iter().all(|contact| contact.a.kind() == "sphere"), "a hull goes by the name of its sphere");
    // The faces of the cubes: 4 points each. A tetrahedron has 3 on the ground, and its ball one.
    assert_eq!(contacts.len(), 3 * 4 + 2 * 4, "{contacts:?}");
}

fn resumed_hulls_have_the_same_bits(backend: Backend) {
    let text = format!(
        "{FLOOR}@body a density=2\n{CORNERS}\n@end\n@body b mass=1\n@name tip\n{TETRAHEDRON}\n@end\n@place a at=0,0.6,0 spin=0,1,2\n\
         @place b at=0.1,1.5,0.2 axis=1,2,3 turn=50\n"
    );
    let mut whole = open(&text, backend);
    whole.run(30, FRAME).expect("frames");
    let file = std::env::temp_dir().join(format!("rockfall-hulls-{}-{backend:?}.ckpt", std::process::id()));
    whole.checkpoint().expect("a checkpoint").save(&file).expect("a file");
    let mut resumed = Simulation::resume(Checkpoint::load(&file).expect("a checkpoint")).expect("it goes on");
    std::fs::remove_file(file).expect("the file");
    whole.run(60, FRAME).expect("frames");
    resumed.run(60, FRAME).expect("frames");
    let states = |simulation: &mut Simulation| format!("{:?}", simulation.sync().expect("states").bodies());
    let bits = |simulation: &mut Simulation| {
        let bodies = simulation.sync().expect("states").bodies();
        let numbers =
            bodies.iter().flat_map(|body| [body.position, body.velocity, body.angular_momentum].map(|v| v.to_array()));
        numbers.flatten().map(f32::to_bits).collect::<Vec<_>>()
    };
    assert_eq!(bits(&mut whole), bits(&mut resumed), "{}", states(&mut whole));
}

#[test]
fn other_laws_refuse_hulls() {
    for law in ["thesis", "linear", "hertz-mindlin"] {
        let text = format!("set contact_law {law}\n@body t mass=1\n{TETRAHEDRON}\n@end\n@place t at=0,1,0\n");
        let error = Simulation::new(scene(&text)).map(drop).expect_err(law).to_string();
        assert!(error.contains(law) && error.contains("hulls need `set contact_law rigid`"), "{error}");
    }
    // So do simulations that run already.
    let mut simulation = open(&format!("{FLOOR}@body t mass=1\n{TETRAHEDRON}\n@end\n@place t at=0,1,0\n"), Backend::Cpu);
    let mut settings = *simulation.settings();
    settings.set("contact_law", "thesis").expect("a setting");
    let error = simulation.set_settings(settings).expect_err("the thesis has no hulls").to_string();
    assert!(error.contains("hulls need"), "{error}");
    simulation.run(1, FRAME).expect("nothing has changed");
}

#[test]
fn a_ray_meets_the_faces_of_a_hull() {
    let mut simulation = open(&format!("{FLOOR}@body t mass=1\n{TETRAHEDRON}\n@end\n@place t at=0,1,0\n"), Backend::Cpu);
    let hit = simulation.cast_ray([0.2, 5.0, 0.2], [0.0, -1.0, 0.0]).expect("a ray").expect("a hit");
    assert!((hit.point.y - 1.6).abs() < 1e-5 && hit.normal.distance(Vec3::splat(1.0 / 3_f32.sqrt())) < 1e-5, "{hit:?}");
    // Inside the sphere around it, beside the hull.
    let hit = simulation.cast_ray([0.6, 5.0, 0.6], [0.0, -1.0, 0.0]).expect("a ray").expect("a hit");
    assert!(hit.point.y.abs() < 1e-6, "{hit:?}");
}

#[test]
fn a_hull_beside_others_does_not_overlap_them() {
    let text =
        format!("{FLOOR}@body a mass=1\n{CORNERS}\n@end\n@place a at=0,0.5,0\n@place a at=1.001,0.5,0\n@place a at=5,0.4,0\n");
    let found = scene(&text).placement().expect("placements");
    let depths: Vec<f32> = found.overlaps.iter().map(|overlap| overlap.units).collect();
    assert!(depths.len() == 1 && (depths[0] - 0.1).abs() < 1e-4, "{depths:?}");
}
