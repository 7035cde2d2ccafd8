//! Periodic boundaries under the contact law `rigid` (docs/physics section 11.1).

use std::path::Path;

use glam::{Vec3, Vec3Swizzles};
use rockfall::{Backend, ContactAction, Options, Scene, Simulation};

use crate::hard::check_split_and_resumed;

const FRAME: f32 = 1.0 / 60.0;

both! {
    bodies_meet_at_a_face_as_in_the_middle,
    a_gas_keeps_its_momentum_and_its_energy,
    a_brick_slides_down_an_endless_plane,
    a_box_rests_on_a_floor_of_one_period,
    a_pendulum_and_a_spring_reach_through_a_face,
    a_floor_that_moves_for_ever_carries_a_box,
    split_and_resumed_runs_have_the_same_bits,
}

fn scene(text: &str) -> Scene {
    Scene::parse(&format!("set contact_law rigid\n{text}"), Path::new("periodic")).expect("a valid scene").scene
}

fn open(text: &str, backend: Backend) -> Simulation {
    Simulation::with_options(scene(text), Options::new().backend(backend)).expect("it opens")
}

/// Places, velocities and angular momenta of bodies and loose balls.
fn state(simulation: &mut Simulation) -> Vec<[Vec3; 3]> {
    let scene = simulation.sync().expect("states");
    let bodies: Vec<_> = scene.bodies().iter().map(|body| [body.position, body.velocity, body.angular_momentum]).collect();
    let loose = scene.spheres().iter().filter(|sphere| sphere.radius == 0.25);
    bodies.into_iter().chain(loose.map(|sphere| [sphere.position, sphere.velocity, sphere.angular_momentum])).collect()
}

const CUBE: &str = "@body cube mass=1\nB -0.25 -0.25 -0.25 0.5 0 0 0 0.5 0 0 0 0.5\n@end\n";
const ROD: &str = "@body rod mass=1\nS 1 -0.4 0 0 0 0 0 0 0 0 1 0.2\nS 2 0.4 0 0 0 0 0 0 0 0 1 0.2\nR 1 2 0.2\n@end\n";

/// Two cubes, a rod and a ball collide and rub at x. Whole coordinates and halves are exact, so that all that differs is rounding.
fn crash(x: f32, backend: Backend) -> Vec<[Vec3; 3]> {
    let text = format!(
        "set gravity 0\nset restitution 0.5\n@run substeps=4\n@periodic x 0 8\n@periodic z -4 4\n{CUBE}{ROD}\
         @place cube at={},0,0 velocity=1,0,0\n@place cube at={},0.25,0.125 velocity=-1,0,0\n\
         @place rod at={},-0.5,0 velocity=1.5,0.25,0\nS 9 {} 0.25 0 -2 0 0 0 0 0 1 0.25\n",
        x - 0.5,
        x + 0.5,
        x - 1.5,
        x + 1.5,
    );
    let mut simulation = open(&text, backend);
    let most = if backend == Backend::Cpu { 60 } else { 24 };
    simulation.run(most, FRAME).expect("frames");
    let moved = state(&mut simulation);
    moved.into_iter().map(|[place, velocity, momentum]| [place - x * Vec3::X, velocity, momentum]).collect()
}

fn bodies_meet_at_a_face_as_in_the_middle(backend: Backend) {
    let middle = crash(4.0, backend);
    assert_eq!(middle.len(), 4);
    assert!(middle[0][2].length() > 0.01 && middle[2][2].length() > 0.01, "they must have met: {middle:?}");
    for x in [0.0, 8.0] {
        for (one, other) in middle.iter().zip(&crash(x, backend)) {
            for (one, other) in one.iter().zip(other) {
                assert!(one.distance(*other) < 2e-3, "{middle:?} at {x}: {other}");
            }
        }
    }
}

/// Balls and cubes without gravity, with e = 1 and without friction. Nothing is lost, and nobody leaves.
fn a_gas_keeps_its_momentum_and_its_energy(backend: Backend) {
    let mut text = format!(
        "set gravity 0\nset restitution 1\nset coulomb_friction 0\n@run substeps=8\n@periodic x -1.5 1.5\n@periodic y -1.5 1.5\n\
         @periodic z -1.5 1.5\n{CUBE}"
    );
    for k in 0..27 {
        let at = [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1].map(|step| step as f32);
        let velocity = [(7 * k) % 5 - 2, (3 * k) % 7 - 3, (5 * k) % 3 - 1].map(|speed| 0.5 * speed as f32);
        let ([x, y, z], [u, v, w]) = (at, velocity);
        if k % 2 == 0 {
            text += &format!("S {k} {x} {y} {z} {u} {v} {w} 0 0 0 1 0.25\n");
        } else {
            text += &format!("@place cube at={x},{y},{z} velocity={u},{v},{w}\n");
        }
    }
    let mut simulation = open(&text, backend);
    let sums = |simulation: &mut Simulation| {
        let all = state(simulation);
        let momentum: Vec3 = all.iter().map(|[_, velocity, _]| *velocity).sum();
        let sizes = all.iter().map(|[place, ..]| place.abs().max_element());
        (momentum, sizes.fold(0.0, f32::max), simulation.energy().expect("energies").kinetic)
    };
    let (momentum, _, energy) = sums(&mut simulation);
    simulation.run(if backend == Backend::Cpu { 240 } else { 20 }, FRAME).expect("frames");
    let (later, farthest, now) = sums(&mut simulation);
    assert!(momentum.distance(later) < 1e-4, "{momentum} {later}");
    assert!((now / energy - 1.0).abs() < 1e-4, "{energy} {now}");
    assert!(backend != Backend::Cpu || farthest > 3.0, "somebody must have gone around: {farthest}");
}

/// Down a slope of 30 degrees with mu = 0.3 a brick gains g (sin a - mu cos a) t, over many periods.
fn a_brick_slides_down_an_endless_plane(backend: Backend) {
    let (sine, cosine) = (30_f32.to_radians().sin(), 30_f32.to_radians().cos());
    let text = format!(
        "set gravity 10\nset gravity_direction {sine} {} 0\nset coulomb_friction 0.3\n@run substeps=4\n@periodic x -1 1\n\
         @plane at=0,0,0 normal=0,1,0\n{CUBE}@place cube at=0.5,0.25,0\n",
        -cosine
    );
    let mut simulation = open(&text, backend);
    let frames = if backend == Backend::Cpu { 240 } else { 60 };
    simulation.run(frames, FRAME).expect("frames");
    let time = frames as f32 * FRAME;
    let pull = 10.0 * (sine - 0.3 * cosine);
    let [place, velocity, _] = state(&mut simulation)[0];
    assert!((velocity.x / (pull * time) - 1.0).abs() < 2e-3, "{velocity}");
    assert!(((place.x - 0.5) / (0.5 * pull * time * time) - 1.0).abs() < 1e-2 && place.yz().length() < 0.26, "{place}");
}

/// The floor ends at the faces of the box, and a box stands on both its ends.
fn a_box_rests_on_a_floor_of_one_period(backend: Backend) {
    let text = format!(
        "set gravity 10\n@run substeps=4\n@periodic x 0 2\n@periodic z 0 2\nB 0 -1 0 2 0 0 0 1 0 0 0 2\n{CUBE}\
         @place cube at=2,0.25,0\n@place cube at=0.05,0.75,1.95\nS 5 1 0.25 1 0 0 0.5 0 0 0 1 0.25\n"
    );
    let mut simulation = open(&text, backend);
    simulation.run(if backend == Backend::Cpu { 120 } else { 30 }, FRAME).expect("frames");
    let all = state(&mut simulation);
    for ([place, velocity, _], height) in all.iter().zip([0.25, 0.75, 0.25]) {
        assert!((place.y - height).abs() < 2e-3 && velocity.y.abs() < 1e-3, "{all:?}");
    }
    assert!((all[0][0].x - 2.0).abs() < 1e-3 && all[1][1].length() < 1e-3, "{all:?}");
    let contacts = simulation.contacts().expect("contacts");
    // The corners of the lower cube stand on four images of the floor, the upper one stands on the lower one, and the ball on a floor.
    assert!(contacts.len() >= 9, "{}", contacts.len());
    let force = |action| if let ContactAction::Force(force) = action { force.y.abs() } else { panic!("{action:?}") };
    let carried: f32 = contacts.iter().filter(|contact| contact.point.y < 0.1).map(|contact| force(contact.action)).sum();
    assert!((carried / 30.0 - 1.0).abs() < 1e-2, "{carried}");
}

/// A hinge of the world and a spring between two balls, with ends on both sides of a face.
fn a_pendulum_and_a_spring_reach_through_a_face(backend: Backend) {
    let run = |x: f32| {
        let text = format!(
            "set gravity 10\n@run substeps=8\n@periodic x -4 4\n{CUBE}@name bob\n@place cube at={},0,0\n@name -\n\
             @joint hinge world bob at={},0,0 axis=0,0,1\nS 1 {} 2 3 0 0 0 0 0 0 1 0.25\nS 2 {} 2 3 0 0 0 0 0 0 1 0.25\nK 1 2 50 0.8 0\n",
            x - 0.5,
            x + 0.5,
            x - 0.5,
            x + 0.5,
        );
        let mut simulation = open(&text, backend);
        simulation.run(if backend == Backend::Cpu { 90 } else { 20 }, FRAME).expect("frames");
        state(&mut simulation).into_iter().map(|[place, velocity, _]| (place - x * Vec3::X, velocity)).collect::<Vec<_>>()
    };
    let middle = run(0.0);
    for x in [-4.0, 4.0] {
        for ((one, speed), (other, other_speed)) in middle.iter().zip(run(x)) {
            assert!(one.distance(other) < 1e-3 && speed.distance(other_speed) < 1e-3, "{one} {other} {speed} {other_speed}");
        }
    }
}

/// A plate of one period moves at 1 unit/s. After several periods the box on it has its speed.
fn a_floor_that_moves_for_ever_carries_a_box(backend: Backend) {
    let text = format!(
        "set gravity 10\n@run substeps=4\n@periodic x -1 1\n@motion belt velocity=1,0,0\n@move belt\nB -1 -0.5 -1 2 0 0 0 0.5 0 0 0 2\n\
         @move -\n{CUBE}@place cube at=0.5,0.25,0\n"
    );
    let mut simulation = open(&text, backend);
    let frames = if backend == Backend::Cpu { 300 } else { 90 };
    simulation.run(frames, FRAME).expect("frames");
    let [place, velocity, _] = state(&mut simulation)[0];
    // It slides for v / (mu g) = 0.2 s first.
    let way = frames as f32 * FRAME - 0.1;
    assert!(velocity.distance(Vec3::X) < 2e-3 && (place.x - 0.5 - way).abs() < 0.02, "{place} {velocity}");
    assert!((place.y - 0.25).abs() < 2e-3, "{place}");
}

fn split_and_resumed_runs_have_the_same_bits(backend: Backend) {
    let text = format!(
        "set gravity 10\nset gravity_direction 0.6 -0.8 0\n@run substeps=4\n@periodic x -2 2\n@plane at=0,0,0 normal=0,1,0\n{CUBE}{ROD}\
         @place cube at=0.5,0.3,0 velocity=3,0,0\n@place rod at=-0.5,0.5,0.2\nS 4 0.75 1 0 5 0 0 0 0 0 1 0.25\n"
    );
    check_split_and_resumed(|| open(&text, backend), 40, 5, &[0, 1, 17]);
}

/// What has no meaning in all images is refused by name.
#[test]
fn shears_leaning_planes_and_turning_walls_are_refused() {
    let ball = "S 1 0 1 0 0 0 0 0 0 0 1 0.25\n";
    for (text, named) in [
        ("@periodic x -2 2\n@periodic y -2 2 shear=0.5\n", "a sheared box"),
        ("@periodic x -2 2\n@plane at=0,0,0 normal=1,1,0\n", "leans"),
        (
            "@periodic x -2 2\n@motion m spin=1 axis=0,1,0 through=0,0,0\n@move m\nB -1 -1 -1 2 0 0 0 1 0 0 0 2\n@move -\n",
            "turns",
        ),
        ("@periodic x -0.4 0.4\n", "half of the period"),
    ] {
        let scene = scene(&format!("{text}{ball}"));
        let found = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect_err(text).to_string();
        assert!(found.contains(named), "{found}");
    }
}
