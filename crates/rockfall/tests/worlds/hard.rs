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
