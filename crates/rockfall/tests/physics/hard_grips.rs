//! Points of bodies that are pulled (docs/physics section 11.15).

use std::path::Path;

use rockfall::glam::Vec3;
use rockfall::{Backend, Body, Error, Options, Scene, Simulation};

const FRAME: f32 = 1.0 / 60.0;

fn open(text: &str, backend: Backend) -> Simulation {
    let text = format!("set contact_law rigid\nset gravity 9.81\n{text}");
    let scene = Scene::parse(&text, Path::new("test")).expect("a valid scene").scene;
    Simulation::with_options(scene, Options::new().backend(backend)).expect("it opens")
}

/// The energy of all bodies, in mass units²/s².
fn energy(simulation: &mut Simulation) -> f64 {
    let energy = simulation.energy().expect("energies");
    energy.kinetic + energy.potential
}

both! {
    a_box_of_any_mass_comes_to_the_pointer_and_hangs_from_its_corner,
    a_loose_ball_and_a_capsule_are_held_at_their_surface,
}

/// A corner of a cube is pulled up and to the side. After a second it is there, and in the end the centre hangs below it and is still.
fn a_box_of_any_mass_comes_to_the_pointer_and_hangs_from_its_corner(backend: Backend) {
    for mass in [1e-3, 1e5] {
        let mut simulation = open(
            &format!(
                "@body box mass={mass}\nB -0.5 -0.5 -0.5  1 0 0  0 1 0  0 0 1\n@end\nB -9 -1 -9  18 0 0  0 1 0  0 0 18\n\
                 @place box at=0,0.5,0\n"
            ),
            backend,
        );
        let body = simulation.scene().body_ids().next().expect("a body");
        let sphere = simulation.scene().body(body).expect("a body").spheres()[0];
        let grip = simulation.grip(Body::Sphere(sphere), Vec3::new(0.5, 1.0, 0.5)).expect("a grip").expect("it moves");
        let goal = Vec3::new(1.5, 3.0, 0.0);
        simulation.pull_grip(&grip, goal).expect("a pull");
        let mut greatest = 0.0_f64;
        for _ in 0..60 {
            simulation.step(FRAME).expect("a frame");
            greatest = greatest.max(energy(&mut simulation).abs() / f64::from(mass as f32));
        }
        let point = simulation.grip_point(&grip).expect("states").expect("it is there");
        assert!(point.distance(goal) < 0.02, "{point} with the mass {mass}");
        // 2.5 units of height and the way to the side in half a second.
        assert!(greatest < 100.0, "{greatest} units²/s² with the mass {mass}");
        simulation.run(240, FRAME).expect("4 s");
        let point = simulation.grip_point(&grip).expect("states").expect("it is there");
        let own = simulation.sync().expect("states").body(body).expect("a body").clone();
        let below = goal - 0.75_f32.sqrt() * Vec3::Y;
        assert!(point.distance(goal) < 2e-3, "{point} with the mass {mass}");
        assert!(own.position.distance(below) < 0.01, "{} with the mass {mass}", own.position);
        assert!(own.velocity.length() < 0.02, "{} with the mass {mass}", own.velocity);
        // Without the pull it falls.
        simulation.release_grip();
        simulation.run(6, FRAME).expect("0.1 s");
        let fallen = simulation.sync().expect("states").body(body).expect("a body").velocity;
        assert!((fallen.y + 0.981).abs() < 0.03, "{fallen} with the mass {mass}");
    }
}

/// They hang below the point of their surface at which they were picked.
fn a_loose_ball_and_a_capsule_are_held_at_their_surface(backend: Backend) {
    let text = "S 1  0 5 0  0 0 0  0 0 0  2 0.5\nC 3 5 0  5 5 0  0 0 0  3 0.25\n";
    for (picked, at) in [(0, Vec3::new(0.5, 5.0, 0.0)), (1, Vec3::new(4.0, 5.25, 0.0))] {
        let mut simulation = open(text, backend);
        let scene = simulation.scene();
        let body = match picked {
            0 => Body::Sphere(scene.sphere_ids().next().expect("a ball")),
            _ => Body::Rod(scene.rod_ids().next().expect("a rod")),
        };
        let grip = simulation.grip(body, at).expect("a grip").expect("it moves");
        simulation.pull_grip(&grip, at + Vec3::Y).expect("a pull");
        simulation.run(300, FRAME).expect("5 s");
        let point = simulation.grip_point(&grip).expect("states").expect("it is there");
        assert!(point.distance(at + Vec3::Y) < 5e-3, "{point}");
        let spheres = simulation.spheres().expect("states");
        if picked == 0 {
            // It has turned by a quarter.
            assert!((spheres[0].position - Vec3::new(0.5, 5.5, 0.0)).length() < 0.02, "{}", spheres[0].position);
        } else {
            // Picked in the middle, it stays level.
            assert!((spheres[1].position.y - spheres[2].position.y).abs() < 0.02);
        }
    }
}

/// The first ragdoll of the scene is lifted by a hand from the ground, and hangs from it.
#[test]
fn a_hand_lifts_a_ragdoll() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/ragdolls.txt")).expect("the scene");
    let scene = Scene::parse(&text, Path::new("test")).expect("a valid scene").scene;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.run(240, FRAME).expect("4 s");
    let body = simulation.scene().body_ids().nth(5).expect("a forearm");
    let hand = simulation.sync().expect("states").body(body).expect("a body").spheres()[1];
    let at = simulation.sphere(hand).expect("a hand").position;
    let grip = simulation.grip(Body::Sphere(hand), at).expect("a grip").expect("it moves");
    let goal = at + Vec3::new(0.0, 2.5, 0.0);
    simulation.pull_grip(&grip, goal).expect("a pull");
    let mut fastest = 0.0_f32;
    for _ in 0..240 {
        simulation.step(FRAME).expect("a frame");
        let bodies = simulation.sync().expect("states").bodies();
        fastest = bodies[..11].iter().map(|body| body.velocity.length()).fold(fastest, f32::max);
    }
    let point = simulation.grip_point(&grip).expect("states").expect("it is there");
    assert!(point.distance(goal) < 0.05, "{point}, {goal}");
    let bodies = simulation.scene().bodies();
    // It hangs from the hand.
    let heights: Vec<f32> = bodies[..11].iter().map(|body| body.position.y - point.y).collect();
    assert!(heights.iter().sum::<f32>() < -3.0 && heights.iter().all(|height| *height < 0.3), "{heights:?}");
    let swing = bodies[..11].iter().map(|body| body.velocity.length()).fold(0.0, f32::max);
    assert!(fastest < 20.0 && swing < 0.5, "at most {fastest} units/s, {swing} at the end");
    for joint in simulation.joints().expect("joints") {
        assert!(joint.error < 0.02, "{}", joint.error);
    }
}

/// Fixed things and other laws have no grip.
#[test]
fn what_cannot_move_has_no_grip() {
    let mut simulation = open("S 1  0 5 0  0 0 0  0 0 0  2 0.5 1\nB 0 0 0  1 0 0  0 1 0  0 0 1\n", Backend::Cpu);
    let sphere = simulation.scene().sphere_ids().next().expect("a sphere");
    let wall = simulation.scene().box_ids().next().expect("a box");
    assert_eq!(simulation.grip(Body::Sphere(sphere), Vec3::ZERO).expect("no grip"), None);
    assert_eq!(simulation.grip(Body::Box(wall), Vec3::ZERO).expect("no grip"), None);
    let scene = Scene::parse("S 1  0 5 0  0 0 0  0 0 0  2 0.5\n", Path::new("test")).expect("a valid scene").scene;
    let mut other = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
    let sphere = other.scene().sphere_ids().next().expect("a sphere");
    let refused = other.grip(Body::Sphere(sphere), Vec3::ZERO);
    assert!(matches!(refused, Err(Error::Invalid { field: "contact_law", .. })), "{refused:?}");
}
