//! A resumed run ends in a state that is bitwise identical to that of an uninterrupted run, and damaged checkpoint
//! files are rejected.

use rockfall::glam::{Quat, Vec3};
use rockfall::{
    Backend, BroadPhase, Checkpoint, Counts, Error, Gauge, GaugeReading, Integrator, Material, Options, Pair, Scene,
    Simulation, Sphere, SphereId,
};

use crate::common::mixed::{Run, assert_bitwise_identical, mixed};
use crate::common::*;

const DT: f32 = 0.01;

/// Resumes a simulation from the bytes of a checkpoint, as another process would from a file.
fn resumed(simulation: &mut Simulation) -> Simulation {
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("a valid checkpoint")).expect("the simulation opens")
}

/// Gravity and balls in motion give lists, margins and rod lengths a history before a checkpoint is taken. Checkpoints
/// are taken before the first step and up to the middle of collisions.
fn a_resumed_run_is_bitwise_identical(backend: Backend) {
    let (steps, stops) = on(backend, (120, vec![0, 1, 37, 60, 61, 100]), (24, vec![9, 14]));
    for integrator in Integrator::ALL {
        for method in [BroadPhase::BruteForce, BroadPhase::SortAndSkip, BroadPhase::Grid] {
            let options = Options::new().backend(backend).integrator(integrator).broad_phase(method);
            let start = || Simulation::with_options(mixed(80), options.clone()).expect("the simulation opens");
            let mut whole = start();
            whole.run(steps, DT).expect("steps");
            let whole = Run::of(&mut whole);
            assert!(whole.report.total_collisions > 10, "{:?}", whole.report);
            let mut interrupted = start();
            for stop in &stops {
                interrupted.run(stop - interrupted.report().steps, DT).expect("steps");
                let mut resumed = resumed(&mut interrupted);
                assert_eq!(resumed.report(), interrupted.report());
                assert_eq!(resumed.time_step().to_bits(), interrupted.time_step().to_bits());
                resumed.run(steps - stop, DT).expect("steps");
                assert_bitwise_identical(&whole, &Run::of(&mut resumed));
            }
            // Taking checkpoints must not change the course of the interrupted run either.
            interrupted.run(steps - interrupted.report().steps, DT).expect("steps");
            assert_bitwise_identical(&whole, &Run::of(&mut interrupted));
        }
    }
}

/// A checkpoint keeps the results of edits: gaps in the handles, external forces, groups, changed settings.
fn a_checkpoint_keeps_the_results_of_edits(backend: Backend) {
    let mut scene = mixed(40);
    let thrown = scene.add_sphere(Sphere::new([0.2, 3.0, 0.1], 0.2).group(7)).expect("a valid sphere");
    let mut simulation = simulation(scene, backend);
    simulation.run(10, DT).expect("steps");
    let first: Vec<SphereId> = simulation.scene().sphere_ids().take(6).collect();
    simulation.remove_sphere(first[2]).expect("a ball to remove");
    simulation.add_sphere(Sphere::new([0.0, 4.0, 0.0], 0.25).velocity([0.0, -4.0, 0.0])).expect("a valid sphere");
    simulation.set_force(first[4], [0.0, 30.0, 0.0]).expect("a ball to lift");
    simulation.set_orientation(first[5], Quat::from_rotation_x(1.0)).expect("a ball to turn");
    let mut settings = *simulation.settings();
    settings.gravity_direction = Vec3::new(0.0, -3.0, 0.5);
    settings.restitution = 0.3;
    settings.contact_pull = true;
    simulation.set_settings(settings).expect("valid settings");

    // A checkpoint includes edits that have not reached the device yet.
    simulation.set_velocity(first[3], [1.0, 2.0, 0.0]).expect("a ball to throw");
    let checkpoint = simulation.checkpoint().expect("a checkpoint");
    let from_file = Checkpoint::from_bytes(&checkpoint.to_bytes(), "memory").expect("a valid checkpoint");
    assert_eq!(from_file.scene.settings, settings);
    assert_eq!(from_file.scene.spheres(), checkpoint.scene.spheres());
    assert_eq!(from_file.scene.counts(), checkpoint.scene.counts());
    assert_eq!(from_file.to_bytes(), checkpoint.to_bytes());

    let mut from_file = Simulation::resume(from_file).expect("the simulation opens");
    let mut in_memory = Simulation::resume(checkpoint).expect("the simulation opens");
    assert!(from_file.sphere(thrown).is_err(), "a checkpoint from a file must not accept handles of another scene");
    assert!(
        in_memory.sphere(thrown).is_ok() && in_memory.sphere(first[2]).is_err(),
        "a checkpoint in memory must keep the handles"
    );
    for simulation in [&mut simulation, &mut from_file, &mut in_memory] {
        simulation.run(on(backend, 60, 10), DT).expect("steps");
    }
    let end = Run::of(&mut simulation);
    assert_bitwise_identical(&end, &Run::of(&mut from_file));
    assert_bitwise_identical(&end, &Run::of(&mut in_memory));
}

/// No checkpoint can be taken within a step. The forces of a step depend on which contacts collided in it, and only the
/// lists hold that.
fn a_checkpoint_within_a_step_is_an_error(backend: Backend) {
    let mut scene = weightless();
    let balls = [Sphere::new([0.0; 3], 0.5).velocity([1.0, 0.0, 0.0]), Sphere::new([0.9, 0.0, 0.0], 0.5)];
    spheres(&mut scene, balls);
    let mut simulation = simulation(scene, backend);
    simulation.handle_collisions().expect("a phase");
    let error = simulation.checkpoint().expect_err("within a step");
    assert!(error.to_string().contains("between two steps"), "{error}");
    simulation.update_positions(DT).expect("a phase");
    let mut resumed = resumed(&mut simulation);
    for simulation in [&mut simulation, &mut resumed] {
        simulation.run(5, DT).expect("steps");
    }
    assert_bitwise_identical(&Run::of(&mut simulation), &Run::of(&mut resumed));
}

/// A simulation that goes back to a checkpoint repeats the same steps, also after objects were added and a step failed.
fn a_restored_simulation_repeats_its_steps(backend: Backend) {
    let mut simulation = simulation(mixed(40), backend);
    simulation.run(10, DT).expect("steps");
    let checkpoint = simulation.checkpoint().expect("a checkpoint");
    simulation.run(20, DT).expect("steps");
    let first = Run::of(&mut simulation);
    let thrown = simulation.add_sphere(Sphere::new([0.0, 3.0, 0.0], 0.2).force([3e38, 0.0, 0.0])).expect("a valid sphere");
    simulation.run(20, 10.0).expect_err("the added sphere stops being finite");
    simulation.restore(&checkpoint).expect("it goes back");
    assert_eq!(simulation.report(), checkpoint.report);
    assert!(simulation.sphere(thrown).is_err());
    simulation.run(20, DT).expect("steps");
    assert_bitwise_identical(&first, &Run::of(&mut simulation));
}

both!(
    a_resumed_run_is_bitwise_identical,
    a_checkpoint_keeps_the_results_of_edits,
    a_checkpoint_within_a_step_is_an_error,
    a_restored_simulation_repeats_its_steps,
);

/// A small checkpoint with every kind of object.
fn small() -> Vec<u8> {
    let mut simulation = Simulation::with_options(mixed(2), Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.run(3, DT).expect("steps");
    let mut checkpoint = simulation.checkpoint().expect("a checkpoint");
    checkpoint.note = "kept for the caller: \u{3c0}".to_owned();
    without_lows(checkpoint.to_bytes())
}

/// The numbers of objects, as a file has them.
fn counts_of(checkpoint: &Checkpoint) -> Vec<u8> {
    let Counts { spheres, rods, capsules, springs, tethers, boxes, polygons, .. } = checkpoint.scene.counts();
    [spheres, rods, capsules, springs, tethers, boxes, polygons].map(|count| (count as u64).to_le_bytes()).concat()
}

/// The place after the numbers of objects in the bytes of a checkpoint.
fn after_counts(checkpoint: &Checkpoint, bytes: &[u8]) -> usize {
    let counts = counts_of(checkpoint);
    bytes.windows(counts.len()).position(|window| window == counts).expect("the counts are in the file") + counts.len()
}

/// The bytes of a checkpoint without materials, pairs, motions, periods, gauges, laws, springs of contacts, rates and residues, and without the low parts of positions.
fn without_lows(mut bytes: Vec<u8>) -> Vec<u8> {
    let checkpoint = Checkpoint::from_bytes(&bytes, "memory").expect("a valid checkpoint");
    let spheres = checkpoint.scene.spheres().len();
    let at = after_counts(&checkpoint, &bytes) + 108;
    let lows = u64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes")) as usize;
    assert!(lows == 0 || lows == spheres, "{lows}");
    bytes.splice(at..at + 8 + 12 * lows, [0; 8]);
    let version = bytes[8];
    with_version(bytes, version)
}

/// A small checkpoint with materials, and the springs of three contacts.
fn small_with_materials() -> Vec<u8> {
    let text = "set contact_law hertz-mindlin\n@material a density=2 young=1e4 poisson=0.3\n@material b young=1e4 poisson=0\n\
                @pair a b restitution=0.5 friction=0.4\n@use a\nS 7 0 0.49 0 1 0 0 0 0 0 - 0.5\n\
                C 3 0.49 0 4 0.49 0 1 0 0 - 0.5\n@use b\n\
                @motion lift velocity=0,2,0 from=1\n@motion lift spin=3 axis=0,0,1 through=4,0,0 from=0.25 to=0.5\n@move lift\n\
                B -5 -1 -5 10 0 0 0 1 0 0 0 10\n@use -\n@material c\n\
                @gauge name=weight wall=lift\n@gauge name=on plane=0.001,0.5,1,2,0,0\n";
    let scene = Scene::parse(text, "a.txt".as_ref()).expect("a scene").scene;
    let options = Options::new().backend(Backend::Cpu).integrator(Integrator::SymplecticEuler);
    let mut simulation = Simulation::with_options(scene, options).expect("it opens");
    simulation.run(3, 1e-3).expect("steps");
    simulation.checkpoint().expect("a checkpoint").to_bytes()
}

#[test]
fn materials_and_springs_are_kept() {
    let bytes = small_with_materials();
    let checkpoint = Checkpoint::from_bytes(&bytes, "memory").expect("a valid checkpoint");
    let scene = &checkpoint.scene;
    let [a, b] = ["a", "b"].map(|name| scene.find_material(name));
    assert_eq!(scene.materials().len(), 3);
    assert_eq!(scene.materials()[0], Material::new("a").density(2.0).young(1e4).poisson(0.3));
    let given = scene.given_pair(a.expect("a"), b.expect("b")).expect("materials of the scene");
    assert_eq!(given, Some(Pair::default().restitution(0.5).friction(0.4)));
    assert!(scene.spheres().iter().all(|sphere| sphere.material == a) && scene.boxes()[0].material == b);
    assert_eq!(scene.rods()[0].material, a);
    let [lift] = scene.motions() else { panic!("one motion") };
    let turn = rockfall::MotionTerm::turn(3.0, [0.0, 0.0, 1.0], [4.0, 0.0, 0.0]).during(0.25, 0.5);
    assert_eq!(lift.terms, [rockfall::MotionTerm::translation([0.0, 2.0, 0.0]).during(1.0, f64::INFINITY), turn]);
    assert_eq!((lift.name.as_str(), scene.boxes()[0].motion), ("lift", scene.find_motion("lift")));
    let gauges = [Gauge::wall("weight", "lift"), Gauge::plane("on", [0.001, 0.5, 1.0], [2.0, 0.0, 0.0])];
    assert_eq!(scene.gauges(), gauges);
    // The first ball has passed the plane since the start.
    let mut resumed = Simulation::resume(checkpoint.clone()).expect("it resumes");
    let [GaugeReading::Wall(load), flow] = resumed.gauges().expect("gauges")[..] else { panic!("a wall first") };
    assert_eq!((load.contacts, flow), (3, GaugeReading::Plane { mass: f64::from(scene.spheres()[0].mass), count: 1 }));
    assert_eq!(checkpoint.to_bytes(), bytes, "the same state must give the same bytes");
    // Three contacts with springs of 28 bytes are more than the bytes of the same scene before its first step.
    let mut fresh = Simulation::with_options(scene.clone(), checkpoint.options.clone()).expect("it opens");
    assert!(fresh.checkpoint().expect("a checkpoint").to_bytes().len() + 3 * 28 <= bytes.len());
}

#[track_caller]
fn assert_rejected(bytes: &[u8]) -> String {
    match Checkpoint::from_bytes(bytes, "file.ckpt") {
        Err(error @ Error::Checkpoint { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn notes_and_options_are_restored() {
    let checkpoint = Checkpoint::from_bytes(&small(), "file.ckpt").expect("a valid checkpoint");
    assert_eq!(checkpoint.note, "kept for the caller: \u{3c0}");
    assert_eq!(checkpoint.options.backend, Backend::Cpu);
    assert_eq!((checkpoint.report.steps, checkpoint.time_step), (3, DT));
    assert_eq!(checkpoint.to_bytes(), small(), "the same state must give the same bytes");
}

#[test]
fn truncated_or_changed_checkpoints_are_rejected() {
    let good = small();
    for length in 0..good.len() {
        assert_rejected(&good[..length]);
    }
    for place in 0..good.len() {
        for flip in [1, 0x80, 0xff] {
            let mut bad = good.clone();
            bad[place] ^= flip;
            assert_rejected(&bad);
        }
    }
    let longer = [good.as_slice(), &[0]].concat();
    assert!(assert_rejected(&longer).contains(&format!("it has {} bytes, expected {}", longer.len(), good.len())));
}

#[test]
fn rejected_checkpoints_are_reported_with_the_reason() {
    let good = small();
    assert_eq!(assert_rejected(&[]), "file.ckpt: not a usable checkpoint: it is empty");
    assert!(assert_rejected(b"S 1 0 0 0 0 0 0 0 0 0 1 1\n").contains("does not begin as a checkpoint"));
    assert!(assert_rejected(&good[..good.len() / 2]).contains("bytes, expected"));
    let mut bad = good.clone();
    bad[100] ^= 4;
    assert!(assert_rejected(&bad).contains("checksum"));
    let mut newer = good;
    for version in [0, 26, 28] {
        newer[8] = version;
        let expected = format!("it has version {version} of the format, this rockfall reads version 27");
        assert!(assert_rejected(&newer).contains(&expected));
    }
}

/// Shapes and rigid bodies are kept, with their groups, materials and names.
#[test]
fn bodies_are_kept() {
    let checkpoint = Checkpoint::from_bytes(&small_with_bodies(), "memory").expect("a valid checkpoint");
    assert_eq!(checkpoint.to_bytes(), small_with_bodies(), "the same state must give the same bytes");
    let text = checkpoint.scene.to_text();
    assert_eq!(text, bodies().to_text());
    let scene = &checkpoint.scene;
    assert_eq!((scene.counts().bodies, scene.shapes().len()), (3, 2));
    for id in scene.body_ids() {
        let body = scene.body(id).expect("a body");
        assert!(body.spheres().iter().all(|sphere| scene.body_of_sphere(*sphere) == Some(id)));
        assert!(body.rods().iter().all(|rod| scene.body_of_rod(*rod) == Some(id)));
    }
    assert_eq!(scene.named("stick").expect("a name").len(), 4);
}

fn bodies() -> Scene {
    let text = "set contact_law rigid\nset precision single\n@material a density=2 young=1e4 poisson=0.3\n@body bone mass=3 rounding=0.1\n@use a\n@group 2\nS 0 0 0 0 0 0 0 0 0 0 - 1\n@colour red\n\
                S 1 4 0 0 0 0 0 0 0 0 - 0.5\nB 6 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n@body top mass=2 centre=0,0.5,0 inertia=1,2,2,0.25,0,0\n\
                C 0 0 0 0 1 0 0 0 0 - 0.25\n@end\nS 7 0 9 0 0 0 0 0 0 0 1 0.5 0\n@place bone at=0,20,0 spin=1,2,3\n\
                @place top at=1,30,0 orientation=0.6,0,0.8,0 velocity=1,2,3 name=stick\n@place bone at=0,40,0 first=9\nK 7 10 1 40 0\n";
    Scene::parse(text, "a.txt".as_ref()).expect("a scene").scene
}

fn small_with_bodies() -> Vec<u8> {
    let mut simulation = Simulation::with_options(bodies(), Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.checkpoint().expect("a checkpoint").to_bytes()
}

fn small_with_hulls() -> Vec<u8> {
    let text = "set contact_law rigid\n@body stone density=2\n@hull 0,0,0 1,0,0 0,1,0 0,0,1\n@group 2\n@colour red\n\
                @hull 5,0,0 6,0,0 5,1,0 5,0,1 4,0,0.5\n@end\n@place stone at=0,3,0 spin=1,2,3\n@place stone at=9,3,0\n";
    let scene = Scene::parse(text, "a.txt".as_ref()).expect("a scene").scene;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.checkpoint().expect("a checkpoint").to_bytes()
}

fn small_with_joints() -> Vec<u8> {
    let text = "set contact_law rigid\n@body bar\nS 0 0 0 0 0 0 0 0 0 0 - 0.5\n@end\n@place bar at=0,3,0 name=a\n@place bar at=2,3,0 name=b\n\
                S 7 4 3 0 0 0 0 0 0 0 1 0.5\n@joint hinge a b at=1,3,0 axis=0,0,1 limits=-20..30 speed=1 torque=2 name=elbow\n\
                @joint distance b 7 at=2,3,0 to=4,3,0 stiffness=3 damping=0.5 target=2\n@joint ball world a at=0,3,0 cone=20 collide=yes\n";
    let scene = Scene::parse(text, "a.txt".as_ref()).expect("a scene").scene;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.checkpoint().expect("a checkpoint").to_bytes()
}

/// A resumed simulation refers to spheres as the scene file does.
#[test]
fn references_are_kept() {
    let ball = |reference: u32, x: u32| format!("S {reference} {x} 0 0 0 0 0 0 0 0 1 0.5\n");
    let text = ball(40, 0) + "C 0 5 0 1 5 0 0 0 0 1 0.25\n" + &ball(u32::MAX, 3);
    let scene = Scene::parse(&text, "a.txt".as_ref()).expect("a scene").scene;
    let mut simulation = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect("a simulation");
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let references = |bytes: &[u8]| -> Vec<Option<u32>> {
        let scene = Checkpoint::from_bytes(bytes, "file.ckpt").expect("a checkpoint").scene;
        scene.sphere_ids().map(|id| scene.reference(id)).collect()
    };
    assert_eq!(references(&bytes), [Some(40), None, None, Some(u32::MAX)]);
}

/// The bytes of a checkpoint with a version, and the length and the checksum that belong to them.
fn with_version(mut bytes: Vec<u8>, version: u8) -> Vec<u8> {
    bytes[8] = version;
    let length = bytes.len() as u64;
    bytes[12..20].copy_from_slice(&length.to_le_bytes());
    let end = bytes.len() - 4;
    let crc32 = crc32fast::hash(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc32.to_le_bytes());
    bytes
}

/// Muscles and their time are kept.
#[test]
fn muscles_are_kept() {
    let mut scene = mixed(2);
    let id = scene.spring_ids().nth(1).expect("a spring");
    let muscle = rockfall::Muscle::new(0.25, 1.5, -3.0);
    scene.update_spring(id, |spring| spring.muscle = Some(muscle)).expect("a muscle");
    let mut simulation = simulation(scene, Backend::Cpu);
    simulation.run(3, DT).expect("steps");
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    let kept = Checkpoint::from_bytes(&bytes, "file.ckpt").expect("a checkpoint");
    let muscles: Vec<_> = kept.scene.springs().iter().map(|spring| spring.muscle).collect();
    assert_eq!(muscles, [None, Some(muscle), None]);
    assert_eq!(Simulation::resume(kept).expect("it resumes").muscle_time(), simulation.muscle_time());
}

/// Checksums detect accidents, not deliberate changes. This test replaces every word by invalid numbers and corrects
/// the checksum. The file is then rejected or accepted, but nothing panics and nothing allocates all memory.
#[test]
fn invalid_numbers_with_a_correct_checksum_cause_no_panic() {
    for good in [small(), small_with_materials(), small_with_bodies(), small_with_hulls(), small_with_joints()] {
        assert_no_panic(&good);
    }
}

fn assert_no_panic(good: &[u8]) {
    let (mut accepted, mut rejected) = (0, 0);
    for place in 20..good.len() - 8 {
        for nonsense in [0, 1, u32::MAX, f32::NAN.to_bits(), f32::INFINITY.to_bits(), 0x8000_0000, 0x7fff_ffff] {
            let mut bad = good.to_vec();
            bad[place..place + 4].copy_from_slice(&nonsense.to_le_bytes());
            let end = bad.len() - 4;
            let crc32 = crc32fast::hash(&bad[..end]);
            bad[end..].copy_from_slice(&crc32.to_le_bytes());
            match Checkpoint::from_bytes(&bad, "file.ckpt") {
                Ok(_) => accepted += 1,
                Err(_) => rejected += 1,
            }
        }
    }
    assert!(accepted > 100 && rejected > 100, "{accepted} accepted, {rejected} rejected");
}

#[test]
fn an_empty_scene_can_be_checkpointed() {
    let mut simulation = Simulation::with_options(Scene::new(), Options::new().backend(Backend::Cpu)).expect("it opens");
    simulation.run(2, DT).expect("steps");
    assert_eq!(resumed(&mut simulation).run(3, DT).expect("steps").steps, 5);
}

#[test]
fn a_checkpoint_file_is_read_back_and_other_paths_are_errors() {
    let folder = std::env::temp_dir().join(format!("rockfall-checkpoint-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("a.ckpt");
    let checkpoint = Checkpoint::from_bytes(&small(), "memory").expect("a valid checkpoint");
    checkpoint.save(&path).expect("it is written");
    assert_eq!(std::fs::read(&path).expect("a file"), small());
    assert_eq!(Checkpoint::load(&path).expect("a valid checkpoint").to_bytes(), small());
    assert!(Checkpoint::load(&folder).expect_err("a folder").to_string().contains("rockfall-checkpoint-"));
    assert!(matches!(Checkpoint::load(folder.join("none.ckpt")), Err(Error::File { .. })));
    assert!(matches!(checkpoint.save(folder.join("no/a.ckpt")), Err(Error::File { .. })));
    std::fs::remove_dir_all(&folder).expect("the folder is removed");
}
