//! Scenes far from the origin under the contact law `rigid` (docs/physics section 11.1).

use std::path::Path;

use glam::Vec3;
use rockfall::{Backend, Options, Scene, Simulation};

use crate::hard::check_split_and_resumed;

const FRAME: f32 = 1.0 / 60.0;
/// A point of the grid at which coordinates may begin, with coordinates that are multiples of 1/128 in single precision.
const FAR: f32 = 102_400.0;

both! {
    a_machine_far_from_the_origin_moves_as_one_near_it,
    split_and_resumed_runs_far_from_the_origin_have_the_same_bits,
}

/// A box slides on a floor, a turning plate carries another one, a ball hangs on a tether and a door on a hinge of the world.
fn scene(x: f32) -> Scene {
    let text = format!(
        "set contact_law rigid\nset gravity 9.81\n@run substeps=4\n@body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n\
         B {} -1 -8 20 0 0 0 1 0 0 0 16\n@place cube at={x},0.5,0 velocity=1,0,0\n@name door\n@place cube at={},3,0\n@name -\n\
         @joint hinge world door at={},3,0 axis=0,0,1\nS 1 {} 2 2 0 0 0 0 0 0 1 0.25\nT 1 {} 4 2 50 1.5 1\n\
         @motion plate spin=1 axis=0,1,0 through={},0,-4\n@move plate\nB {} 0 -6 4 0 0 0 0.25 0 0 0 4\n@move -\n\
         @place cube at={},0.75,-4\n@cylinder at={},0,4 axis=0,1,0 radius=1 length=2 inside=yes\nS 2 {} 1 4 0 0 0 0 0 0 1 0.25\n",
        x - 10.0,
        x + 4.0,
        x + 4.5,
        x - 3.0,
        x - 3.0,
        x + 4.0,
        x + 2.0,
        x + 4.0,
        x + 2.0,
        x + 2.5,
    );
    Scene::parse(&text, Path::new("far")).expect("a valid scene").scene
}

fn open(x: f32, backend: Backend) -> Simulation {
    Simulation::with_options(scene(x), Options::new().backend(backend)).expect("it opens")
}

/// Places and velocities of bodies and loose balls.
fn state(simulation: &mut Simulation) -> Vec<(Vec3, Vec3)> {
    let scene = simulation.sync().expect("states");
    let bodies = scene.bodies().iter().map(|body| (body.position, body.velocity));
    let loose = scene.spheres().iter().filter(|sphere| sphere.radius == 0.25);
    bodies.chain(loose.map(|sphere| (sphere.position, sphere.velocity))).collect()
}

fn a_machine_far_from_the_origin_moves_as_one_near_it(backend: Backend) {
    let [mut near, mut far] = [0.0, FAR].map(|x| open(x, backend));
    for simulation in [&mut near, &mut far] {
        simulation.run(if backend == Backend::Cpu { 60 } else { 20 }, FRAME).expect("frames");
    }
    let contacts = [&mut near, &mut far].map(|simulation| simulation.contacts().expect("contacts"));
    assert!(!contacts[0].is_empty() && contacts[0].len() == contacts[1].len());
    for (near, far) in contacts[0].iter().zip(&contacts[1]) {
        assert!((far.point - near.point - FAR * Vec3::X).length() < 0.01, "{} {}", near.point, far.point);
    }
    let states = [state(&mut near), state(&mut far)];
    assert_eq!(states[0].len(), 5);
    for ((near, speed), (far, far_speed)) in states[0].iter().zip(&states[1]) {
        assert_eq!(speed, far_speed);
        assert!((*far - *near - FAR * Vec3::X).length() < 0.01, "{near} {far}");
    }
}

fn split_and_resumed_runs_far_from_the_origin_have_the_same_bits(backend: Backend) {
    check_split_and_resumed(|| open(1e5 + 0.3, backend), 40, 5, &[0, 1, 17]);
}
