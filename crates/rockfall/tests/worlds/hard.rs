//! Worlds with hard contacts (the contact law `rigid`) advance as simulations of their own.

use std::path::Path;

use rockfall::{Backend, Options, Scene, Simulation, Worlds};

use crate::common::*;

const FRAME: f32 = 1.0 / 60.0;

/// A tower of cubes that a ball hits, on a table that turns.
fn scene(cubes: usize) -> Scene {
    let places: String = (0..cubes).map(|number| format!("@place cube at=0,{},0\n", number as f32 + 0.5)).collect();
    let text = format!(
        "set contact_law rigid\nset gravity 9.81\n@motion table spin=0.5 axis=0,1,0\n@move table\nB -5 -1 -5  10 0 0  0 1 0  0 0 10\n@move -\n\
         @body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n{places}S 1  -3 1.2 0.1  8 0 0  0 0 0  1 0.4\n"
    );
    Scene::parse(&text, Path::new("test")).expect("a valid scene").scene
}

both! {
    worlds_with_hard_contacts_are_those_of_simulations,
    joints_of_worlds_are_read_and_driven,
}

fn worlds_with_hard_contacts_are_those_of_simulations(backend: Backend) {
    let options = Options::new().backend(backend);
    let scenes: Vec<Scene> = (1..4).map(scene).collect();
    let run = |scene: &Scene, frames: u64| {
        let mut simulation = Simulation::with_options(scene.clone(), options.clone()).expect("it opens");
        simulation.run(frames, FRAME).expect("frames");
        bits(&simulation.spheres().expect("states"))
    };
    let mut worlds = Worlds::new(scenes.clone(), options.clone()).expect("worlds");
    worlds.run(30, FRAME).expect("frames");
    // A reset of some worlds leaves the others as they are.
    worlds.reset(&[0, 2]).expect("a reset");
    worlds.run(15, FRAME).expect("frames");
    for (number, frames) in [(0, 15), (1, 45), (2, 15)] {
        let found = bits(&worlds.states(number).expect("states"));
        assert_eq!(found, run(&scenes[number], frames), "world {number}");
    }
}

/// A door on a hinge in each world, with motors of their own.
fn joints_of_worlds_are_read_and_driven(backend: Backend) {
    let text = "set contact_law rigid\nset gravity 0\n@body door mass=20\nB 0 0 -0.02 0.9 0 0 0 2 0 0 0 0.04\n@end\n\
                @place door at=0,0.01,0 name=door\n@joint hinge world door at=0,1,0 axis=0,1,0 speed=0 torque=50\n";
    let scene = Scene::parse(text, Path::new("test")).expect("a valid scene").scene;
    let mut worlds = Worlds::new(vec![scene; 3], Options::new().backend(backend)).expect("worlds");
    for world in 0..3 {
        worlds.update_joint(world, 0, |joint| joint.speed = Some(world as f32)).expect("a motor");
    }
    worlds.run(60, FRAME).expect("frames");
    let all = worlds.all_joints().expect("joints");
    for (world, joints) in all.iter().enumerate() {
        let [reading] = joints[..] else { panic!("{joints:?}") };
        assert!((reading.speed - world as f32).abs() < 0.01 && reading.position >= 0.8 * world as f32, "{world}: {reading:?}");
        assert_eq!(joints[..], worlds.joints(world).expect("joints")[..]);
    }
    worlds.reset(&[2]).expect("a reset");
    worlds.run(1, FRAME).expect("a frame");
    assert!(worlds.joints(2).expect("joints")[0].position.abs() < 1e-5, "its motor stands still again");
    let error = worlds.update_joint(0, 1, |_| ()).expect_err("one joint").to_string();
    assert_eq!(error, "joint: 1 of 1 is not allowed, expected a number below that of joints");
}
