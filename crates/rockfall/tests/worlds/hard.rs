//! Worlds with hard contacts (the contact law `rigid`) advance as simulations of their own.

use std::path::Path;

use rockfall::glam::Vec3;
use rockfall::{Backend, Options, Scene, Simulation, WorldPath, Worlds};

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
    worlds_that_share_frames_have_the_bits_of_simulations,
    a_world_that_stops_leaves_the_others,
    joints_of_worlds_are_read_and_driven,
    joints_of_worlds_are_placed,
}

/// A walker of three links that falls on a floor with a wall, and as many loose cubes and balls beside it as the world's number.
fn walker(number: usize) -> Scene {
    let loose: String = (0..number)
        .map(|k| {
            format!(
                "@place cube at={},{},0.3\nS {k} -1 {} 0.2 1 0 0 0 0 0 1 0.2\n",
                1.2 + 0.1 * k as f32,
                0.6 + k as f32,
                0.5 + k as f32
            )
        })
        .collect();
    let text = format!(
        "set contact_law rigid\nset gravity 9.81\n@run substeps=4\n@plane at=0,0,0 normal=0,1,0\nB 3 0 -5 1 0 0 0 2 0 0 0 10\n\
         @body link mass=1\nB -0.4 -0.1 -0.1 0.8 0 0 0 0.2 0 0 0 0.2\n@end\n@body cube mass=1\nB -0.25 -0.25 -0.25 0.5 0 0 0 0.5 0 0 0 0.5\n@end\n\
         @name a\n@place link at=0,{y},0\n@name b\n@place link at=1,{y},0\n@name c\n@place link at=2,{y},0 velocity=2,0,0\n@name -\n\
         @joint hinge a b at=0.5,{y},0 axis=0,0,1 limits=-90..90 speed=1 torque=2\n@joint ball b c at=1.5,{y},0 axis=1,0,0 cone=60\n{loose}",
        y = 0.5 + 0.25 * number as f32,
    );
    Scene::parse(&text, Path::new("test")).expect("a valid scene").scene
}

fn path(backend: Backend) -> WorldPath {
    if backend == Backend::Gpu { WorldPath::Joined } else { WorldPath::Simulation }
}

/// With other worlds, after a reset, and with other drives a world has the states that it has alone.
fn worlds_that_share_frames_have_the_bits_of_simulations(backend: Backend) {
    let options = Options::new().backend(backend);
    let scenes: Vec<Scene> = (0..4).map(walker).collect();
    let alone = |scene: &Scene, frames: u64, speed: Option<f32>| {
        let mut simulation = Simulation::with_options(scene.clone(), options.clone()).expect("it opens");
        simulation.run(frames, FRAME).expect("frames");
        if speed.is_some() {
            let hinge = simulation.scene().joint_ids().next().expect("a hinge");
            simulation.update_joint(hinge, |joint| joint.speed = speed).expect("a motor");
            simulation.run(10, FRAME).expect("frames");
        }
        bits(&simulation.spheres().expect("states"))
    };
    let mut worlds = Worlds::new(scenes.clone(), options.clone()).expect("worlds");
    worlds.run(20, FRAME).expect("frames");
    worlds.reset(&[1]).expect("a reset");
    worlds.run(20, FRAME).expect("frames");
    for (number, frames) in [(0, 40), (1, 20), (2, 40), (3, 40)] {
        let report = worlds.report(number, None).expect("a report");
        assert_eq!((report.path, report.report.steps), (path(backend), frames));
        assert_eq!(bits(&worlds.states(number).expect("states")), alone(&scenes[number], frames, None), "world {number}");
    }
    assert!((0..4).any(|world| worlds.report(world, None).expect("a report").report.contacts > 0));
    worlds.update_joint(2, 0, |joint| joint.speed = Some(-3.0)).expect("a motor");
    worlds.run(10, FRAME).expect("frames");
    assert_eq!(bits(&worlds.states(2).expect("states")), alone(&scenes[2], 40, Some(-3.0)), "other drives");
    assert_eq!(bits(&worlds.states(3).expect("states")), alone(&scenes[3], 50, None), "no other drives");
    // A world with other walls goes on alone.
    let mut other = walker(1);
    other.add_box(rockfall::Cuboid::between([-9.0, 0.0, -1.0], [-8.0, 1.0, 1.0])).expect("a box");
    worlds.replace(1, other.clone()).expect("another world");
    worlds.run(10, FRAME).expect("frames");
    assert_eq!(bits(&worlds.states(1).expect("states")), alone(&other, 10, None), "other walls");
    assert_eq!(bits(&worlds.states(0).expect("states")), alone(&scenes[0], 60, None), "the others");
}

/// A ball that becomes infinitely fast stops its world, in the state before, and no other one.
fn a_world_that_stops_leaves_the_others(backend: Backend) {
    let options = Options::new().backend(backend);
    let mut scenes: Vec<Scene> = (1..4).map(walker).collect();
    let mut ball = rockfall::Sphere::new([0.0, 50.0, 50.0], 0.2).mass(1e-20);
    ball.force = Vec3::new(1e30, 0.0, 0.0);
    scenes[1].add_sphere(ball).expect("a ball");
    let mut worlds = Worlds::new(scenes.clone(), options.clone()).expect("worlds");
    worlds.run(10, FRAME).expect("frames");
    let reports: Vec<_> = (0..3).map(|world| worlds.report(world, None).expect("a report")).collect();
    assert!(reports[1].stopped.as_ref().is_some_and(|text| text.contains("finite")), "{:?}", reports[1].stopped);
    assert_eq!([0, 1, 2].map(|world| reports[world].report.steps), [10, 0, 10]);
    for number in [0, 2] {
        let mut simulation = Simulation::with_options(scenes[number].clone(), options.clone()).expect("it opens");
        simulation.run(10, FRAME).expect("frames");
        let found = bits(&worlds.states(number).expect("states"));
        assert_eq!(found, bits(&simulation.spheres().expect("states")), "world {number}");
    }
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

/// A cart on a slider along x, with a pole on a hinge about z.
fn joints_of_worlds_are_placed(backend: Backend) {
    let text = "set contact_law rigid\nset gravity 0\n@body cart mass=1\nB -0.2 -0.1 -0.1 0.4 0 0 0 0.2 0 0 0 0.2\n@end\n\
                @body pole mass=1\nB -0.05 0 -0.05 0.1 0 0 0 1 0 0 0 0.1\n@end\n@place cart at=0,0,0 name=cart\n\
                @place pole at=0,0,0 name=pole\n@joint slider world cart at=0,0,0 axis=1,0,0\n\
                @joint hinge cart pole at=0,0,0 axis=0,0,1\n";
    let scene = Scene::parse(text, Path::new("test")).expect("a valid scene").scene;
    let mut worlds = Worlds::new(vec![scene; 2], Options::new().backend(backend)).expect("worlds");
    worlds.place_joints(1, &[2.0, 0.5], &[3.0, -1.0]).expect("places");
    let all = worlds.all_joints().expect("joints");
    assert!(all[0].iter().all(|joint| joint.position == 0.0 && joint.speed == 0.0), "{:?}", all[0]);
    for (joint, (position, speed)) in all[1].iter().zip([(2.0, 3.0), (0.5, -1.0)]) {
        assert!((joint.position - position).abs() < 1e-6 && (joint.speed - speed).abs() < 1e-5, "{joint:?}");
        assert!(joint.error < 1e-6, "{joint:?}");
    }
    worlds.sync().expect("states");
    let scene = worlds.scene(1).expect("a world");
    let (pole, id) = (&scene.bodies()[1], scene.body_ids().nth(1).expect("a pole"));
    let (sine, cosine) = 0.5_f32.sin_cos();
    assert!((pole.position - Vec3::new(2.0 - 0.5 * sine, 0.5 * cosine, 0.0)).length() < 1e-6, "{pole:?}");
    assert!((pole.velocity - Vec3::new(3.0 + 0.5 * cosine, 0.5 * sine, 0.0)).length() < 1e-5, "{pole:?}");
    assert!((scene.body_spin(id).expect("a spin") - Vec3::NEG_Z).length() < 1e-5);

    let spins = [Vec3::new(0.0, 0.0, 2.0)];
    worlds.update_bodies(0, &[1], Some(&spins), |_, pole| pole.velocity = Vec3::new(-1.0, 0.0, 0.0)).expect("a pole");
    let speed = worlds.joints(0).expect("joints")[1].speed;
    assert!((speed - 2.0).abs() < 1e-5, "{speed}");
    let error = worlds.update_bodies(0, &[2], None, |_, _| ()).expect_err("two bodies").to_string();
    assert_eq!(error, "body: 2 of 2 is not allowed, expected a number below that of rigid bodies");
    let error = worlds.place_joints(0, &[1.0], &[0.0, 0.0]).expect_err("two joints").to_string();
    assert_eq!(error, "positions: 1 for 2 is not allowed, expected one number per joint");
}
