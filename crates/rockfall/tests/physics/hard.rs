//! The contact law `rigid` through the doors of the library (docs/physics section 11): scene text, frames, substeps, observations,
//! checkpoints and refusals. The problems of the solver itself are tested beside it.

use std::path::Path;

use rockfall::{Backend, Checkpoint, ContactAction, ContactLaw, Error, Options, Scene, Simulation};

const FRAME: f32 = 1.0 / 60.0;

fn scene(text: &str) -> Scene {
    Scene::parse(&format!("set contact_law rigid\nset gravity 9.81\n{text}"), Path::new("test")).expect("a valid scene").scene
}

fn open(text: &str) -> Simulation {
    open_on(text, Backend::Cpu)
}

fn open_on(text: &str, backend: Backend) -> Simulation {
    Simulation::with_options(scene(text), Options::new().backend(backend)).expect("it opens")
}

both! {
    a_stack_of_cubes_stands_and_sinks_as_its_springs_say,
    a_ball_returns_as_its_restitution_says,
    bodies_of_all_kinds_come_to_rest,
    split_and_resumed_runs_have_the_same_bits,
    contacts_of_another_scene_in_a_checkpoint_are_refused,
    a_checkpoint_after_an_edit_is_taken_up,
    edits_between_frames_are_felt,
    bodies_that_stop_being_finite_are_reported,
    substeps_of_the_scene_make_contacts_stiffer,
    a_stack_finds_its_new_rest_after_a_change_of_the_frame,
    bodies_turn_back_below_a_ceiling,
    other_laws_do_not_replace_it_on_a_gpu,
    a_slope_of_triangles_is_a_slope,
}

/// Two boxes and a ball on triangles that are turned by atan 0.45 move as on one parallelogram: with a friction of 0.4 the boxes slide
/// down by g (sin - mu cos) t^2 / 2.
fn a_slope_of_triangles_is_a_slope(backend: Backend) {
    let (sine, cosine) = (0.45_f32 / 1.2025_f32.sqrt(), 1.0 / 1.2025_f32.sqrt());
    let place = |x: f32, up: f32| [x * cosine - up * sine, x * sine + up * cosine];
    let turn = 0.45_f32.atan().to_degrees();
    let mut walls = [
        String::new(),
        format!("P {} {} -4  0 0 8  {} {} 0\n", place(-6.0, 0.0)[0], place(-6.0, 0.0)[1], 12.0 * cosine, 12.0 * sine),
    ];
    for k in 0..12 {
        let edge = k as f32 - 6.0;
        let [x, y] = place(edge, 0.0);
        walls[0] += &format!("@triangle {x} {y} -4  0 0 8  {cosine} {sine} 0\n");
        let [x, y] = place(edge + 1.0, 0.0);
        walls[0] += &format!("@triangle {x} {y} 4  0 0 -8  {} {} 0\n", -cosine, -sine);
    }
    let objects: String = [-2.0, 2.0]
        .iter()
        .map(|z| {
            let [x, y] = place(4.0, 0.5);
            format!("@place cube at={x},{y},{z} axis=0,0,1 turn={turn}\n")
        })
        .collect();
    let [x, y] = place(4.0, 0.3);
    let objects = format!("set coulomb_friction 0.4\n{CUBE}{objects}S 1 {x} {y} 0  0 0 0  0 0 0  1 0.3\n");
    let ends = walls.map(|wall| {
        let mut simulation = open_on(&format!("{wall}{objects}"), backend);
        simulation.run(60, FRAME).expect("1 s");
        let scene = simulation.sync().expect("states");
        let mut all: Vec<_> = scene.bodies().iter().map(|body| body.position).collect();
        all.push(scene.spheres().iter().find(|sphere| sphere.radius == 0.3).expect("a ball").position);
        all
    });
    let down = |at: glam::Vec3| 4.0 - (at.x * cosine + at.y * sine);
    let expected = 0.5 * 9.81 * (sine - 0.4 * cosine);
    for (on_triangles, on_one) in ends[0].iter().zip(&ends[1]) {
        assert!(on_triangles.distance(*on_one) < 2e-3, "{on_triangles} {on_one}");
    }
    for at in &ends[0][..2] {
        assert!((down(*at) - expected).abs() < 0.01, "{} {expected}", down(*at));
    }
}

const FLOOR: &str = "B -20 -1 -20 40 0 0 0 1 0 0 0 40\n";
const CUBE: &str = "@body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n";

fn stack(count: usize) -> String {
    let cubes: String = (0..count).map(|number| format!("@place cube at=0,{},0\n", number as f32 + 0.5)).collect();
    format!("{FLOOR}{CUBE}{cubes}")
}

/// Cubes of 1 m in a stack sink by N (N - 1) / 2 of 0.266 mm, and N of 0.033 mm on the floor (section 11).
fn a_stack_of_cubes_stands_and_sinks_as_its_springs_say(backend: Backend) {
    let mut simulation = open_on(&stack(10), backend);
    simulation.run(600, FRAME).expect("10 s");
    assert_eq!(simulation.substeps(), Some(4));
    let top = simulation.sync().expect("states").bodies().last().expect("ten cubes").clone();
    let sink = 9.5 - top.position.y;
    assert!((sink - 0.0123).abs() < 0.001, "{sink}");
    assert!(top.position.x.hypot(top.position.z) < 1e-3, "{}", top.position);
    // Each contact carries the weight above it.
    let contacts = simulation.contacts().expect("contacts");
    let on_floor = contacts.iter().filter(|contact| contact.b.kind() == "box");
    let force = |action| if let ContactAction::Force(force) = action { force } else { panic!("{action:?}") };
    let carried: f32 = on_floor.clone().map(|contact| force(contact.action).y).sum();
    assert_eq!(on_floor.count(), 4);
    assert!((carried + 98.1).abs() < 0.2, "{carried}");
    let overlap = simulation.max_overlap().expect("overlaps").units;
    assert!(overlap > 0.002 && overlap < 0.004, "{overlap}");
}

/// A ball with e = 0.5 that falls from 1 m returns to 0.25 m.
fn a_ball_returns_as_its_restitution_says(backend: Backend) {
    let mut simulation = open_on(&format!("set restitution 0.5\n{FLOOR}S 1 0 1.5 0 0 0 0 0 0 0 1 0.5\n"), backend);
    let mut apex = 0.0_f32;
    for frame in 0..60 {
        simulation.run(1, FRAME).expect("a frame");
        let height = simulation.spheres().expect("states")[0].position.y - 0.5;
        // It lands after 0.4515 s.
        apex = if frame > 30 { apex.max(height) } else { 0.0 };
    }
    // The apex lies between two frames.
    assert!(apex < 0.2501 && apex > 0.249, "{apex}");
}

/// Loose spheres, capsules, clumps and bodies of boxes meet planes, boxes and each other, and none is lost.
fn bodies_of_all_kinds_come_to_rest(backend: Backend) {
    let text = format!(
        "{FLOOR}P -20 -2 -20 0 0 40 40 0 0\n{CUBE}@body jack mass=1\nS 1 -0.4 0 0 0 0 0 0 0 0 - 0.2\nS 2 0.4 0 0 0 0 0 0 0 0 - 0.2\n\
         S 3 0 0.4 0 0 0 0 0 0 0 - 0.2\n@end\n@place cube at=0,1,0 axis=1,2,3 turn=40\n@place jack at=0.1,3,0.2\n\
         S 1 3 2 0 0 0 0 0 0 0 1 0.5\nC -3 2 0 -2 2.2 0 0 0 0 2 0.3\n"
    );
    let mut simulation = open_on(&text, backend);
    simulation.run(600, FRAME).expect("10 s");
    let energy = simulation.energy().expect("energies");
    assert!(energy.kinetic < 1e-4, "{energy:?}");
    let scene = simulation.sync().expect("states");
    assert!(scene.spheres().iter().all(|sphere| sphere.position.y > 0.0), "something fell through the floor");
}

/// The bits of all spheres and bodies.
fn bits(simulation: &mut Simulation) -> Vec<Vec<u32>> {
    let scene = simulation.sync().expect("states");
    let spheres = scene.spheres().iter().map(|sphere| sphere.position.to_array().map(f32::to_bits).to_vec());
    let of_body = |body: &rockfall::RigidBody| {
        let vectors = [body.position, body.velocity, body.angular_momentum].map(|vector| vector.to_array()).concat();
        vectors.into_iter().chain(body.orientation.to_array()).map(f32::to_bits).collect()
    };
    spheres.chain(scene.bodies().iter().map(of_body)).collect()
}

/// Checks that a run in parts, and runs that go on from the bytes of a checkpoint after some frames, end with the bits of a whole run.
/// Returns the whole run.
pub(crate) fn check_split_and_resumed(open: impl Fn() -> Simulation, frames: u64, part: u64, stops: &[u64]) -> Simulation {
    let mut whole = open();
    whole.run(frames, FRAME).expect("frames");
    let mut split = open();
    for _ in 0..frames / part {
        split.run(part, FRAME).expect("frames");
    }
    assert_eq!(bits(&mut whole), bits(&mut split));
    for stop in stops {
        let mut first = open();
        first.run(*stop, FRAME).expect("frames");
        let bytes = first.checkpoint().expect("a checkpoint").to_bytes();
        let mut resumed = Simulation::resume(Checkpoint::from_bytes(&bytes, "test").expect("it reads")).expect("it resumes");
        resumed.run(frames - stop, FRAME).expect("frames");
        assert_eq!(bits(&mut whole), bits(&mut resumed), "after {stop} frames");
    }
    whole
}

/// Split runs, and runs through the bytes of a checkpoint, have the same bits.
fn split_and_resumed_runs_have_the_same_bits(backend: Backend) {
    let text = format!("set restitution 0.3\n{}@place cube at=0.3,8,0.2 axis=1,2,3 turn=30\n", stack(3));
    check_split_and_resumed(|| open_on(&text, backend), 90, 10, &[0, 1, 47, 70]);
}

/// Words of a checkpoint that do not fit the bodies are refused.
fn contacts_of_another_scene_in_a_checkpoint_are_refused(backend: Backend) {
    let mut simulation = open_on(&stack(2), backend);
    simulation.run(3, FRAME).expect("frames");
    let good = simulation.checkpoint().expect("a checkpoint").to_bytes();
    // Substeps, then the number of bodies: the world and two cubes.
    let pattern: Vec<u8> = [4_u32, 3].iter().flat_map(|word| word.to_le_bytes()).collect();
    let place = good.windows(8).position(|window| window == pattern).expect("the words of the law");
    for (at, word) in [(place, 0), (place + 4, 2), (place + 8, f32::NAN.to_bits()), (place + 32, 0)] {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        let end = bytes.len() - 4;
        let sum = crc32fast::hash(&bytes[..end]);
        bytes[end..].copy_from_slice(&sum.to_le_bytes());
        let error = Simulation::resume(Checkpoint::from_bytes(&bytes, "test").expect("it reads")).expect_err("refused");
        assert!(error.to_string().contains("hard contacts"), "{error}");
    }
}

/// A checkpoint has the bodies after the edits before it, not those of the last frame.
fn a_checkpoint_after_an_edit_is_taken_up(backend: Backend) {
    let mut simulation = open_on(&stack(3), backend);
    simulation.run(10, FRAME).expect("frames");
    let last = simulation.scene().body_ids().last().expect("three cubes");
    simulation.remove_body(last).expect("it is there");
    let checkpoint = simulation.checkpoint().expect("a checkpoint");
    let mut resumed = Simulation::resume(checkpoint.clone()).expect("it resumes");
    simulation.run(10, FRAME).expect("frames");
    resumed.run(10, FRAME).expect("frames");
    let there = |simulation: &mut Simulation| simulation.sync().expect("states").bodies()[1].position.to_array();
    assert_eq!(there(&mut simulation), there(&mut resumed));
    simulation.restore(&checkpoint).expect("it is restored");
    simulation.run(10, FRAME).expect("frames");
    assert_eq!(there(&mut simulation), there(&mut resumed));
}

/// Edits between frames are felt, and what is known of other contacts stays.
fn edits_between_frames_are_felt(backend: Backend) {
    let mut simulation = open_on(&format!("{}S 1 5 0.5 0 0 0 0 0 0 0 1 0.5\n", stack(2)), backend);
    simulation.run(60, FRAME).expect("frames");
    let ball = simulation.scene().sphere_ids().find(|id| simulation.scene().body_of_sphere(*id).is_none()).expect("a ball");
    simulation.set_velocity(ball, [0.0, 5.0, 0.0]).expect("an edit");
    simulation.run(6, FRAME).expect("frames");
    let height = simulation.sphere(ball).expect("a state").position.y;
    // 0.5 + 5 t - g t² / 2 after 0.1 s.
    assert!((height - 0.951).abs() < 0.002, "{height}");
    let mut settings = *simulation.settings();
    settings.gravity = 0.0;
    simulation.set_settings(settings).expect("settings");
    let before = simulation.sphere(ball).expect("a state").velocity;
    simulation.run(6, FRAME).expect("frames");
    assert_eq!(simulation.sphere(ball).expect("a state").velocity, before);
}

/// What the law does not know is refused by name.
#[test]
fn other_objects_are_refused_by_name() {
    let ball = "S 1 0 1 0 0 0 0 0 0 0 1 0.5\nS 2 0 3 0 0 0 0 0 0 0 1 0.5\n";
    let text = format!("set contact_law rigid\n{ball}@servo m force=0,-1,0 speed=1\n");
    let scene = Scene::parse(&text, Path::new("test")).expect("a valid scene").scene;
    let error = Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).expect_err("a servo");
    assert!(error.to_string().contains("rigid with a servo"), "{error}");
    let mut simulation = open(ball);
    assert!(simulation.update_aabbs().is_err(), "a frame has no phases");
}

/// A device was opened for frames or for steps, and cannot do the others.
fn other_laws_do_not_replace_it_on_a_gpu(backend: Backend) {
    let ball = "S 1 0 1 0 0 0 0 0 0 0 1 0.5\n";
    let thesis = Scene::parse(ball, Path::new("test")).expect("a scene").scene;
    for (scene, law) in [(scene(ball), ContactLaw::Thesis), (thesis, ContactLaw::Rigid)] {
        let mut simulation = Simulation::with_options(scene, Options::new().backend(backend)).expect("it opens");
        let mut settings = *simulation.settings();
        settings.contact_law = law;
        let changed = simulation.set_settings(settings).and_then(|()| simulation.run(1, FRAME).map(drop));
        let refused = matches!(changed, Err(Error::Invalid { field: "contact_law", .. }));
        assert_eq!(refused, backend == Backend::Gpu, "{changed:?}");
    }
}

/// The law sets restitution and friction, wherever the lines that set them stand.
#[test]
fn the_law_has_constants_of_its_own() {
    let settings = |text: &str| Scene::parse(text, Path::new("test")).expect("a scene").scene.settings;
    let of = |text: &str| (settings(text).restitution, settings(text).coulomb_friction);
    assert_eq!(of("set contact_law rigid\n"), (0.0, 0.5));
    assert_eq!(of("set restitution 0.7\nset contact_law rigid\n"), (0.7, 0.5));
    assert_eq!(of("set contact_law rigid\nset coulomb_friction 0.1\n"), (0.0, 0.1));
    let scene = Scene::parse("set contact_law rigid\nset restitution 0.75\n", Path::new("test")).expect("a scene").scene;
    let again = Scene::parse(&scene.to_text(), Path::new("test")).expect("a scene").scene;
    assert_eq!(again.settings, scene.settings, "{}", scene.to_text());
}

/// A body whose state stops being finite is an error, and nothing moves. With `keep_going` it stops, and is counted.
fn bodies_that_stop_being_finite_are_reported(backend: Backend) {
    let text = "S 1 0 5 0 0 0 0 0 0 0 1 0.5\nS 2 10 1 0 3e38 0 0 0 0 0 1 0.5\n@run dt=100\n";
    let mut simulation = open_on(text, backend);
    let before = simulation.spheres().expect("states");
    let error = simulation.run(1, 100.0).expect_err("it leaves the range of f32");
    assert!(matches!(error, Error::NonFinite { sphere: 1, step: 1, .. }), "{error}");
    assert_eq!(simulation.spheres().expect("states"), before);
    let mut simulation =
        Simulation::with_options(scene(text), Options::new().backend(backend).keep_going(true)).expect("it opens");
    let report = simulation.run(1, 100.0).expect("it goes on");
    let after = simulation.spheres().expect("states");
    // It stops in the first substep, and falls from rest in the others.
    assert_eq!((report.non_finite, after[1].velocity.x, after[1].position.x), (1, 0.0, 10.0));
    assert!(after[0].position.y < -1000.0, "{:?}", after[0]);
}

/// Two frames of the same length and other substeps: the overlap of bodies at rest falls with the square of their number.
fn substeps_of_the_scene_make_contacts_stiffer(backend: Backend) {
    let overlap = |substeps: &str| {
        let mut simulation = open_on(&format!("@run substeps={substeps}\n{}", stack(5)), backend);
        simulation.run(300, FRAME).expect("5 s");
        (simulation.substeps(), simulation.max_overlap().expect("overlaps").units)
    };
    let [(four, coarse), (eight, fine)] = ["auto", "8"].map(overlap);
    assert_eq!((four, eight), (Some(4), Some(8)));
    assert!((coarse / fine - 4.0).abs() < 0.3, "{coarse} {fine}");
}

/// Problem 53: N cubes sink by N (N - 1) and N / 4 on the floor, times g / w² with w = 2π · 0.18 / h.
fn a_stack_finds_its_new_rest_after_a_change_of_the_frame(backend: Backend) {
    let sink = |frame: f32| (20.0 + 1.25) * 9.81 / (std::f32::consts::TAU * 0.18 * 4.0 / frame).powi(2);
    for factor in [0.5, 2.0] {
        let mut simulation = open_on(&stack(5), backend);
        let mut top = |frames: u64, frame: f32| {
            simulation.run(frames, frame).expect("frames");
            simulation.sync().expect("states").bodies().last().expect("five cubes").clone()
        };
        let before = top(180, FRAME).position.y;
        let (mut fastest, mut after) = (0.0_f32, before);
        for _ in 0..30 {
            let body = top(if factor < 1.0 { 8 } else { 2 }, factor * FRAME);
            (fastest, after) = (fastest.max(body.velocity.length()), body.position.y);
        }
        let wanted = sink(FRAME) - sink(factor * FRAME);
        assert!((after - before - wanted).abs() < 0.02 * wanted.abs(), "{factor}: {} {wanted}", after - before);
        assert!(fastest < 0.16, "{factor}: {fastest}");
    }
}

/// Problem 46: a body that the field turns back just below a ceiling keeps its energy, and all numbers are finite.
fn bodies_turn_back_below_a_ceiling(backend: Backend) {
    let h = FRAME / 4.0;
    let step = 9.81 * h;
    // The speed over g h, and the gap over g h². With the last ones it touches.
    for (speed, gap) in [(1.1, 1.1), (1.1, 1.4), (10.0, 10.1)] {
        let (at, v) = (-0.5 - gap * step * h, speed * step);
        let text = format!("set restitution 0.5\nB -5 0 -5 10 0 0 0 1 0 0 0 10\nS 1 0 {at} 0 0 {v} 0 0 0 0 1 0.5\n");
        let mut simulation = open_on(&text, backend);
        let total = |simulation: &mut Simulation| {
            let energy = simulation.energy().expect("energies");
            energy.kinetic + energy.potential
        };
        let mut before = total(&mut simulation);
        for _ in 0..10 {
            simulation.run(1, FRAME).expect("a frame");
            let now = total(&mut simulation);
            assert!(now.is_finite() && now - before < 1e-5, "{speed} {gap}: {}", now - before);
            before = now;
        }
    }
}
