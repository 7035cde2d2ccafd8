//! Springs, tethers and muscles under the contact law `rigid` (docs/physics sections 11.9 and 11.10).

use rockfall::glam::{Quat, Vec3};
use rockfall::{
    Backend, Checkpoint, ContactLaw, Cuboid, Muscle, Placement, RigidBodyId, Scene, Shape, Simulation, Sphere, SphereId,
    Spring, SpringId, Tether,
};

use crate::common::{bits_of, floor_box, on, simulation, with};

both! {
    an_oscillator_has_its_period_and_keeps_its_energy,
    a_body_hangs_where_its_spring_says,
    a_body_swings_in_two_tethers,
    free_bodies_keep_their_momenta,
    a_tether_swings_as_a_pendulum,
    a_muscle_moves_as_its_formula_says,
    muscles_do_the_work_that_the_energy_grows_by,
    a_moving_surface_drags_by_the_damping,
    springs_are_stable_as_the_bound_says,
    springs_hold_while_bodies_touch,
    split_and_resumed_runs_have_the_same_bits,
    edits_of_springs_are_felt_and_kept,
}

const FRAME: f32 = 1.0 / 60.0;
const G: f32 = 9.81;

fn hard(gravity: f32) -> Scene {
    with(|settings| (settings.contact_law, settings.gravity) = (ContactLaw::Rigid, gravity))
}

fn ball(scene: &mut Scene, at: [f32; 3], mass: f32) -> SphereId {
    scene.add_sphere(Sphere::new(at, 0.05).mass(mass)).expect("a ball")
}

fn nail(scene: &mut Scene, at: [f32; 3]) -> SphereId {
    scene.add_sphere(Sphere::new(at, 0.01).fixed()).expect("a fixed sphere")
}

/// A plank of 1 x 0.4 x 0.6 with spheres at these places.
fn plank(scene: &mut Scene, mass: f32, places: &[[f32; 3]], at: impl FnOnce(Placement) -> Placement) -> RigidBodyId {
    let shape = Shape::new().cuboid(Cuboid::between([-0.5, -0.2, -0.3], [0.5, 0.2, 0.3]));
    let shape = places.iter().fold(shape, |shape, place| shape.sphere(*place, 0.02));
    let moments = [(0.16 + 0.36) / 12.0, (1.0 + 0.36) / 12.0, (1.0 + 0.16) / 12.0].map(|part: f32| mass * part);
    let shape = shape.mass_properties(mass, [0.0; 3], [moments[0], moments[1], moments[2], 0.0, 0.0, 0.0]);
    let shape = scene.add_shape(shape).expect("a shape");
    scene.add_body(at(Placement::new(shape))).expect("a body")
}

fn end(scene: &Scene, body: RigidBodyId, number: usize) -> SphereId {
    scene.body(body).expect("a body").spheres()[number]
}

fn all(simulation: &mut Simulation) -> f64 {
    let energy = simulation.energy().expect("energies");
    energy.kinetic + energy.potential + energy.spring
}

/// A symplectic Euler step of h makes x_n = x_0 cos((n + 1/2) a) / cos(a / 2) with sin(a / 2) = w h / 2 of a tether that was let go at
/// x_0, and keeps v² + w² x² - h w² x v. The closed form of the physics has the period 2 pi / w.
fn an_oscillator_has_its_period_and_keeps_its_energy(backend: Backend) {
    let mut scene = hard(0.0);
    let mass = ball(&mut scene, [0.1, 0.0, 0.0], 2.0);
    scene.add_tether(Tether::new(mass, [0.0; 3], 200.0)).expect("a tether");
    let mut simulation = simulation(scene, backend);
    let (omega, h) = (10.0_f64, f64::from(FRAME) / 4.0);
    let angle = 2.0 * (0.5 * omega * h).asin();
    let mut worst = 0.0_f64;
    for frame in 1..=on(backend, 600, 60) {
        simulation.run(1, FRAME).expect("a frame");
        assert_eq!(simulation.substeps(), Some(4));
        let phase = 4.0 * angle * f64::from(frame);
        let state = simulation.spheres().expect("states")[0];
        let (x, v) = (f64::from(state.position.x), f64::from(state.velocity.x));
        worst = worst.max((x - 0.1 * (phase + 0.5 * angle).cos() / (0.5 * angle).cos()).abs());
        let kept = v * v + omega * omega * x * x - h * omega * omega * x * v;
        assert!((kept - 1.0).abs() < 2e-5, "frame {frame}: {kept}");
        // 1/2 m w² A², up to the term of first order.
        assert!((all(&mut simulation) - 1.0).abs() < 0.5 * omega * h + 1e-3, "frame {frame}");
    }
    println!("{backend}: {worst:.1e} off, the angle of a substep is {:.1e} off", angle / (omega * h) - 1.0);
    assert!(worst < 2e-5, "{worst}");
    assert!((angle / (omega * h) - 1.0).abs() < 1e-4, "the period of the physics");
}

/// A plank of 2 kg hangs by a damped spring of 400 N/m from a place beside its centre: straight below the nail, by m g / k = 0.04905 m
/// longer. Let go 0.1 m above, it comes to rest there, and rests to the last digits.
fn a_body_hangs_where_its_spring_says(backend: Backend) {
    let mut scene = hard(G);
    let nail = nail(&mut scene, [0.0, 2.0, 0.0]);
    // The arm of 0.5 points up.
    let turn = Quat::from_rotation_z(0.3_f32.atan2(0.4));
    let rest = 2.0 - 0.5 - 0.04905 - 0.5;
    let body = plank(&mut scene, 2.0, &[[0.3, 0.4, 0.0]], |at| at.at([0.0, rest + 0.1, 0.0]).turned(turn));
    let spring = Spring::new(end(&scene, body, 0), nail, 400.0, 0.5).damping(20.0);
    scene.add_spring(spring).expect("a spring");
    let mut simulation = simulation(scene, backend);
    simulation.run(on(backend, 300, 180), FRAME).expect("frames");
    let state = simulation.sync().expect("states").body(body).expect("it is there").clone();
    println!("{backend}: {} {} {}", state.position, state.velocity, state.angular_momentum);
    assert!((f64::from(state.position.y) - rest).abs() < 2e-5 && state.position.x.abs() < 1e-4, "{}", state.position);
    assert!(state.velocity.length() < 2e-4 && state.angular_momentum.length() < 2e-4, "{}", state.velocity);
    let energy = simulation.energy().expect("energies");
    // 1/2 k (m g / k)².
    assert!((energy.spring - 0.5 * 400.0 * 0.04905 * 0.04905).abs() < 1e-4, "{energy:?}");
}

/// A plank between two tethers of rest length 0 at b = 2 on both sides of its ends at a = 0.45 turns as a pendulum with
/// w² = 2 k a b / J: all of the torque is that of forces that turn about the arms.
fn a_body_swings_in_two_tethers(backend: Backend) {
    let mut scene = hard(0.0);
    let start = 0.02_f64;
    let turned = |at: Placement| at.turned(Quat::from_rotation_z(start as f32));
    let body = plank(&mut scene, 2.0, &[[0.45, 0.0, 0.0], [-0.45, 0.0, 0.0]], turned);
    for (number, b) in [(0, 2.0), (1, -2.0)] {
        scene.add_tether(Tether::new(end(&scene, body, number), [b, 0.0, 0.0], 5.0)).expect("a tether");
    }
    let mut simulation = simulation(scene, backend);
    let omega = (2.0 * 5.0 * 0.45 * 2.0 / (2.0 * 1.16 / 12.0_f64)).sqrt();
    for frame in 1..=on(backend, 300, 60) {
        simulation.run(1, FRAME).expect("a frame");
        let state = simulation.sync().expect("states").body(body).expect("it is there").clone();
        let angle = 2.0 * f64::from(state.orientation.z);
        let time = (f64::from(frame) + 0.125) / 60.0;
        // w h = 0.028: the first order is in the half substep.
        assert!((angle - start * (omega * time).cos()).abs() < 0.01 * start, "frame {frame}: {angle}");
        assert!(state.position.length() < 1e-6, "{}", state.position);
    }
}

/// Two planks that turn and fly, joined by two damped and undamped springs beside their centres: momentum and angular momentum stay. Without
/// damping the energy stays, with damping it falls.
fn free_bodies_keep_their_momenta(backend: Backend) {
    for damping in [0.0, 0.5] {
        let mut scene = hard(0.0);
        let places = [[0.6, 0.25, 0.1], [-0.6, -0.2, 0.35]];
        let one =
            plank(&mut scene, 1.0, &places, |at| at.at([0.0, 0.0, 0.0]).velocity([0.3, -0.2, 0.1]).spin([0.5, 1.0, -0.7]));
        let two =
            plank(&mut scene, 3.0, &places, |at| at.at([0.2, 3.0, 0.1]).velocity([-0.4, 0.1, 0.2]).spin([-0.3, 0.2, 0.9]));
        for number in [0, 1] {
            let spring = Spring::new(end(&scene, one, number), end(&scene, two, 1 - number), 40.0, 2.5).damping(damping);
            scene.add_spring(spring).expect("a spring");
        }
        scene.run.substeps = Some(8);
        let mut simulation = simulation(scene, backend);
        let before = simulation.energy().expect("energies");
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for _ in 0..on(backend, 300, 60) {
            simulation.run(1, FRAME).expect("a frame");
            least = least.min(all(&mut simulation));
            most = most.max(all(&mut simulation));
        }
        let after = simulation.energy().expect("energies");
        let sum = before.kinetic + before.spring;
        let (p, l) = (after.momentum - before.momentum, after.angular_momentum - before.angular_momentum);
        println!("{backend} {damping}: {:.1e} {:.1e}, energy {sum:.4} from {least:.4} to {most:.4}", p.length(), l.length());
        assert!(p.length() < 1e-5 && l.length() < 5e-5, "{p} {l}");
        if damping == 0.0 {
            assert!(least > 0.96 * sum && most < 1.04 * sum, "{sum} {least} {most}");
        } else {
            assert!(most < 1.02 * sum && after.kinetic + after.spring < 0.9 * sum, "{sum} {after:?}");
        }
        assert!(after.kinetic > 0.1 && (after.kinetic - before.kinetic).abs() > 1e-3, "they move");
    }
}

/// A ball on a stiff tether is a pendulum of the length l + m g / k.
fn a_tether_swings_as_a_pendulum(backend: Backend) {
    let mut scene = hard(G);
    let length = 1.0 + G / 2000.0;
    let start = 0.05_f32;
    let bob = ball(&mut scene, [length * start.sin(), -length * start.cos(), 0.0], 1.0);
    scene.add_tether(Tether::new(bob, [0.0; 3], 2000.0).length(1.0)).expect("a tether");
    let mut simulation = simulation(scene, backend);
    let omega = f64::from(G / length).sqrt();
    for frame in 1..=on(backend, 360, 90) {
        simulation.run(1, FRAME).expect("a frame");
        let place = simulation.spheres().expect("states")[0].position;
        assert!((place.length() - length).abs() < 2e-4, "{place}");
        let x = f64::from(place.x);
        let time = (f64::from(frame) + 0.125) / 60.0;
        // The period grows by start² / 16, and the weight of the swing stretches the tether.
        let expected = f64::from(length * start.sin()) * (omega * time * (1.0 - f64::from(start * start) / 16.0)).cos();
        assert!((x - expected).abs() < 5e-4, "frame {frame}: {x} {expected}");
    }
}

/// A damped oscillator that a muscle drives, from the formula of section 4.9 in f64 with small steps.
fn driven(seconds: f64, muscle: Muscle) -> f64 {
    let [amplitude, frequency, phase] = [muscle.amplitude, muscle.frequency, muscle.phase].map(f64::from);
    let rest = |t: f64| 1.0 + amplitude * (std::f64::consts::TAU * (frequency * t + phase)).sin();
    let pull = |t: f64, [x, v]: [f64; 2]| [v, -100.0 * (x - rest(t)) - v];
    let (mut state, h) = ([1.0, 0.0], 1e-4);
    for step in 0..(seconds / h).round() as u32 {
        let t = f64::from(step) * h;
        let at = |share: f64, [dx, dv]: [f64; 2]| [state[0] + share * h * dx, state[1] + share * h * dv];
        let one = pull(t, state);
        let two = pull(t + 0.5 * h, at(0.5, one));
        let three = pull(t + 0.5 * h, at(0.5, two));
        let four = pull(t + h, at(1.0, three));
        for k in 0..2 {
            state[k] += h / 6.0 * (one[k] + 2.0 * two[k] + 2.0 * three[k] + four[k]);
        }
    }
    state[0]
}

/// The error of a ball on a muscle is small and of first order in the substep, and the rest length is that of the formula.
fn a_muscle_moves_as_its_formula_says(backend: Backend) {
    let muscle = Muscle::new(0.05, 1.3, 0.1);
    let errors = [8, 32].map(|substeps| {
        let mut scene = hard(0.0);
        let (nail, mass) = (nail(&mut scene, [0.0; 3]), ball(&mut scene, [1.0, 0.0, 0.0], 1.0));
        let spring = scene.add_spring(Spring::new(nail, mass, 100.0, 1.0).damping(1.0).muscle(muscle)).expect("a muscle");
        scene.run.substeps = Some(substeps);
        let mut simulation = simulation(scene, backend);
        let mut worst = 0.0_f64;
        for frame in 1..=on(backend, 120, 40) {
            simulation.run(1, FRAME).expect("a frame");
            if frame % 20 == 0 {
                let time = f64::from(frame) * f64::from(FRAME);
                let x = simulation.sphere(mass).expect("a state").position.x;
                worst = worst.max((f64::from(x) - driven(time, muscle)).abs());
                let length = 1.0 + f64::from(0.05_f32) * (std::f64::consts::TAU * (1.3 * time + 0.1)).sin();
                let told = simulation.rest_length(spring).expect("a length");
                assert!((told - length).abs() < 1e-6, "{told} {length}");
            }
        }
        worst
    });
    println!("{backend}: {:.1e} with 8 substeps, {:.1e} with 32", errors[0], errors[1]);
    assert!(errors[0] < 0.005 && errors[1] < 0.3 * errors[0], "{errors:?}");
}

/// Without damping the energy of a ball on a muscle grows by the work -k (|D| - l) l' of the muscle.
fn muscles_do_the_work_that_the_energy_grows_by(backend: Backend) {
    let muscle = Muscle::new(0.05, 1.0, 0.0);
    let mut scene = hard(0.0);
    let (nail, mass) = (nail(&mut scene, [0.0; 3]), ball(&mut scene, [1.0, 0.0, 0.0], 1.0));
    scene.add_spring(Spring::new(nail, mass, 60.0, 1.0).muscle(muscle)).expect("a muscle");
    scene.run.substeps = Some(32);
    let mut simulation = simulation(scene, backend);
    let power = |x: f32, time: f64| {
        let angle = std::f64::consts::TAU * time;
        -60.0 * (f64::from(x) - 1.0 - 0.05 * angle.sin()) * 0.05 * std::f64::consts::TAU * angle.cos()
    };
    let (mut work, mut most, mut last) = (0.0, 0.01_f64, power(1.0, 0.0));
    let start = all(&mut simulation);
    for frame in 1..=on(backend, 240, 40) {
        simulation.run(1, FRAME).expect("a frame");
        let now = power(simulation.sphere(mass).expect("a state").position.x, f64::from(frame) * f64::from(FRAME));
        work += 0.5 * (last + now) * f64::from(FRAME);
        last = now;
        let grown = all(&mut simulation) - start;
        most = most.max(work);
        assert!((grown - work).abs() < 0.03 * most, "frame {frame}: {grown} {work}");
    }
    assert!(most > 0.2, "{most}");
}

/// The damping of a spring to a fixed sphere whose surface moves at 1 m/s brings a ball to 1 - exp(-c t / m).
fn a_moving_surface_drags_by_the_damping(backend: Backend) {
    let mut scene = hard(0.0);
    let belt = scene.add_sphere(Sphere::new([0.0; 3], 0.01).fixed().velocity(Vec3::X)).expect("a fixed sphere");
    let mass = ball(&mut scene, [1.0, 0.0, 0.0], 1.0);
    scene.add_spring(Spring::new(mass, belt, 0.0, 1.0).damping(2.0)).expect("a damper");
    let mut simulation = simulation(scene, backend);
    simulation.run(60, FRAME).expect("frames");
    let speed = f64::from(simulation.sphere(mass).expect("a state").velocity.x);
    let expected = 1.0 - (1.0 - 2.0 / 240.0_f64).powi(240);
    assert!((speed - expected).abs() < 1e-5 && (expected - (1.0 - (-2.0_f64).exp())).abs() < 2e-3, "{speed} {expected}");
}

/// A chain of balls and stiff springs keeps its energy with the substeps that the bound asks for, and explodes with a third of them. The bound
/// is that of the linear chain: 4 k / m.
fn springs_are_stable_as_the_bound_says(backend: Backend) {
    let chain = |substeps: Option<u32>| {
        let mut scene = hard(0.0);
        let ball = |k: u32| {
            Sphere::new([0.2 * k as f32, 0.0, 0.0], 0.05).mass(0.1).velocity([if k == 3 { 0.1 } else { 0.0 }, 0.0, 0.0])
        };
        let balls: Vec<SphereId> = (0..8).map(|k| scene.add_sphere(ball(k)).expect("a ball")).collect();
        for pair in balls.windows(2) {
            scene.add_spring(Spring::new(pair[0], pair[1], 4e4, 0.2)).expect("a spring");
        }
        scene.run.substeps = substeps;
        scene
    };
    let facts = chain(None).hard_contacts(FRAME).expect("it fits the law");
    assert!((facts.spring_stiffness / 1.6e6 - 1.0).abs() < 1e-6, "{facts:?}");
    // 1 / sqrt(1.6e6) s.
    assert_eq!((facts.spring_substeps, facts.auto_substeps, facts.substeps), (22, 22, 22));
    for (substeps, explodes) in [(None, false), (Some(22), false), (Some(7), true)] {
        let scene = chain(substeps);
        let concerns = scene.concerns(FRAME, rockfall::Integrator::SymplecticEuler);
        assert_eq!(concerns.iter().any(|concern| concern.contains("--substeps 22")), explodes, "{concerns:?}");
        let mut simulation = simulation(scene, backend);
        let start = all(&mut simulation);
        let ran = simulation.run(60, FRAME);
        let exploded = ran.is_err() || all(&mut simulation) > 10.0 * start;
        assert_eq!(exploded, explodes, "{substeps:?}: {:?} of {start}", simulation.energy());
        if !explodes {
            assert!((all(&mut simulation) / start - 1.0).abs() < 0.6, "{:?} of {start}", simulation.energy());
        }
    }
}

/// A plank that a spring and a muscle press on the floor and pull along, a ball on a tether that leans on it, and a chain.
fn workshop() -> (Scene, SpringId, SphereId) {
    let mut scene = hard(G);
    floor_box(&mut scene);
    let body = plank(&mut scene, 2.0, &[[0.45, 0.15, 0.2], [-0.4, -0.1, -0.2]], |at| {
        at.at([0.0, 0.25, 0.0]).turned(Quat::from_rotation_y(0.3))
    });
    let nail = nail(&mut scene, [2.0, 0.5, 0.3]);
    let pull = Spring::new(end(&scene, body, 0), nail, 30.0, 1.2).damping(1.0).muscle(Muscle::new(0.5, 1.7, 0.2));
    let pull = scene.add_spring(pull).expect("a muscle");
    let loose = ball(&mut scene, [-1.0, 0.6, 0.1], 0.5);
    scene.add_spring(Spring::new(loose, end(&scene, body, 1), 60.0, 0.6).damping(0.5)).expect("a spring");
    scene.add_tether(Tether::new(loose, [-1.2, 1.5, 0.0], 20.0).length(0.4).damping(0.1)).expect("a tether");
    let other = ball(&mut scene, [-1.5, 0.4, 0.3], 0.3);
    scene.add_spring(Spring::new(other, loose, 50.0, 0.5)).expect("a spring");
    (scene, pull, other)
}

fn states(simulation: &mut Simulation) -> Vec<(Vec3, Vec3)> {
    let spheres = simulation.spheres().expect("states");
    spheres.iter().map(|sphere| (sphere.position, sphere.velocity)).collect()
}

/// Both backends move bodies that springs pull over the floor alike.
fn springs_hold_while_bodies_touch(backend: Backend) {
    let mut twin = simulation(workshop().0, Backend::Cpu);
    let mut own = simulation(workshop().0, backend);
    let start = states(&mut own)[0].0;
    let (mut apart, mut most) = ([0.0_f32; 2], 0);
    for _ in 0..on(backend, 60, 30) {
        twin.run(1, FRAME).expect("a frame");
        own.run(1, FRAME).expect("a frame");
        most = most.max(own.report().contacts);
        for (one, other) in states(&mut twin).into_iter().zip(states(&mut own)) {
            apart = [apart[0].max(one.0.distance(other.0)), apart[1].max(one.1.distance(other.1))];
        }
    }
    println!("{backend}: {:.1e} and {:.1e} apart", apart[0], apart[1]);
    // An impact near the end of a substep may come one substep later on the other backend.
    assert!(apart[0] < 1e-3 && apart[1] < 0.1, "{apart:?}");
    assert!(most > 0, "the plank lies on the floor");
    let moved = states(&mut own)[0].0.distance(start);
    assert!(moved > 0.01 && moved < 2.0, "{moved}");
}

fn split_and_resumed_runs_have_the_same_bits(backend: Backend) {
    let frames = on(backend, 90, 30);
    let mut whole = simulation(workshop().0, backend);
    whole.run(frames, FRAME).expect("frames");
    let whole = bits_of(&mut whole);
    let mut split = simulation(workshop().0, backend);
    for _ in 0..frames / 10 {
        split.run(10, FRAME).expect("frames");
        split.energy().expect("energies");
    }
    assert_eq!(whole, bits_of(&mut split));
    for first in [0, 1, 17] {
        let mut begun = simulation(workshop().0, backend);
        begun.run(first, FRAME).expect("frames");
        let bytes = begun.checkpoint().expect("a checkpoint").to_bytes();
        let mut resumed = Simulation::resume(Checkpoint::from_bytes(&bytes, "test").expect("it reads")).expect("it resumes");
        resumed.run(frames - first, FRAME).expect("frames");
        assert_eq!(whole, bits_of(&mut resumed), "after {first} frames");
    }
}

/// Springs come and go between frames. A checkpoint right after the edit goes on with the same bits, and stiff springs get their substeps.
fn edits_of_springs_are_felt_and_kept(backend: Backend) {
    let (scene, pull, other) = workshop();
    let mut simulation = simulation(scene, backend);
    simulation.run(7, FRAME).expect("frames");
    let before = simulation.substeps();
    let start = simulation.sphere(other).expect("a state").position;
    simulation.remove_springs(&[pull]).expect("it is there");
    let tether = Tether::new(other, start + Vec3::Y, 1e6).length(1.0).damping(100.0);
    simulation.add_tether(tether).expect("a tether");
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    simulation.run(10, FRAME).expect("frames");
    // The bodies alone need 20. h² k / m <= 1 with k of 1e6 and m = 0.3 asks for 31; the other spring is far softer.
    assert_eq!((before, simulation.substeps()), (Some(20), Some(31)));
    let height = simulation.sphere(other).expect("a state").position.y;
    // Without the tether it falls by 0.14 and more.
    assert!((height - start.y).abs() < 0.05, "the tether holds it: {height} {start}");
    let mut resumed = Simulation::resume(Checkpoint::from_bytes(&bytes, "test").expect("it reads")).expect("it resumes");
    resumed.run(10, FRAME).expect("frames");
    assert_eq!(simulation.substeps(), resumed.substeps());
    assert_eq!(bits_of(&mut simulation), bits_of(&mut resumed));
}
