//! A chain of rods is touched at its nearest point (E29, docs/physics section 2.13).

use std::fmt::Write as _;

use rockfall::{Backend, Body, Integrator, Simulation, SphereState};

use super::scenes::{Random, kinetic, opened, scene, within};
use crate::common::on;

/// Elastic frictionless grains of the law of Hertz and Mindlin, without gravity.
const ELASTIC: &str = "set gravity 0\nset contact_law hertz-mindlin\n@material a young=1500 poisson=.3\n\
                       @pair a a restitution=1 friction=0\n@use a\n";

/// A fixed capsule with a radius of 0.15 along x, from -0.4 to 0.4.
const FIXED_CAPSULE: &str = "S 1 -0.4 0 0 0 0 0 0 0 0 1 0.15 1\nS 2 0.4 0 0 0 0 0 0 0 0 1 0.15 1\nR 1 2 0.15 0.8\n";

/// Kinetic energy after a ball has met the fixed capsule. It must have come within reach.
fn after_a_hit(ball: &str, backend: Backend) -> f64 {
    let text = format!("{ELASTIC}{FIXED_CAPSULE}{ball}");
    let mut simulation = opened(scene(&text), backend, Integrator::VelocityVerlet);
    let speed = |simulation: &mut Simulation| simulation.spheres().expect("spheres")[2].velocity;
    let before = speed(&mut simulation);
    let (steps, dt) = on(backend, (3_200, 2.5e-4), (400, 2e-3));
    simulation.run(steps, dt).expect("steps");
    assert!(simulation.contacts().expect("contacts").is_empty(), "the ball must have left");
    assert!(speed(&mut simulation).distance(before) > 1e-3, "the ball must hit the capsule");
    kinetic(&simulation.spheres().expect("spheres"))
}

/// A ball meets a fixed capsule near its end. It left with 0.854 of 0.5.
fn e29_a_ball_that_meets_the_end_of_a_capsule_keeps_its_energy(backend: Backend) {
    let ball = "S 3 -0.52242774 0.21219958 0.25307111 0.61338201 -0.56261584 -0.55427964 0 0 0 1 0.15 0";
    within(after_a_hit(ball, backend), 0.5, 1e-3, "kinetic energy");
}

/// Balls from random directions at speed 1, aimed at points near the ends. They left with 0.56 to 1.71 of their energy.
fn e29_random_hits_of_a_capsule_keep_the_energy(backend: Backend) {
    let mut random = Random::new(29);
    for number in 0..on(backend, 100, 3) {
        let mut draw = |size: f64| random.between(-size, size);
        let (aim, way) = ([0.4 + draw(0.15), draw(0.1), draw(0.1)], [draw(1.0), draw(1.0), draw(1.0)]);
        let length = way.iter().map(|part| part * part).sum::<f64>().sqrt();
        if !(0.2..=1.0).contains(&length) {
            continue;
        }
        let [x, y, z] = std::array::from_fn(|axis| aim[axis] - 0.5 * way[axis] / length);
        if (x.abs() - 0.4).max(0.0).hypot(y.hypot(z)) < 0.31 {
            continue;
        }
        let [u, v, w] = way.map(|part| part / length);
        let ball = format!("S 3 {x} {y} {z} {u} {v} {w} 0 0 0 1 0.15 0");
        within(after_a_hit(&ball, backend), 0.5, 2e-3, &format!("kinetic energy of hit {number}"));
    }
}

/// Two free capsules meet in random positions. Their energy and momentum stay, in the law of Hertz without damping.
fn e29_two_capsules_that_meet_keep_their_energy(backend: Backend) {
    let mut random = Random::new(31);
    let mut hits = 0;
    for number in 0..on(backend, 60, 2) {
        let mut text = ELASTIC.to_owned();
        for (at, speed) in [(-0.5, 1.0), (0.5, -1.0)] {
            let mut draw = |size: f64| random.between(-size, size);
            let ([x, y, z], [i, j, k]) = ([at, draw(0.15), draw(0.15)], [draw(0.2), draw(0.3), draw(0.3)]);
            let _ = writeln!(text, "C {} {} {} {} {} {} {speed} 0 0 1 0.15", x - i, y - j, z - k, x + i, y + j, z + k);
        }
        let mut simulation = opened(scene(&text), backend, Integrator::VelocityVerlet);
        let (steps, dt) = on(backend, (2_400, 5e-4), (600, 2e-3));
        simulation.run(steps, dt).expect("steps");
        assert!(simulation.contacts().expect("contacts").is_empty(), "the capsules of hit {number} must have left each other");
        let spheres = simulation.spheres().expect("spheres");
        hits += u32::from(spheres[0].velocity.x < 0.99);
        let energy = simulation.energy().expect("energies");
        within(energy.kinetic, 1.0, 5e-3, &format!("kinetic energy of hit {number}"));
        assert!(energy.momentum.x.abs() < 1e-4, "momentum {} of hit {number}", energy.momentum.x);
    }
    assert!(hits > on(backend, 40, 1), "{hits} hits");
}

/// Capsules in a room whose walls are six boxes. The energy grew from 16.0 to 26.8 in 60 s. Their rods touched the edges of the walls,
/// which are no edges of the room, and the other capsules twice.
fn e29_elastic_capsules_in_a_room_keep_their_energy(backend: Backend) {
    let mut text = ELASTIC.to_owned();
    let (low, high, thick) = (-1.3, 1.3, 1.0);
    for axis in 0..3 {
        for at in [low - thick, high] {
            let (mut corner, mut edges) = ([low - thick; 3], [high - low + 2.0 * thick; 3]);
            (corner[axis], edges[axis]) = (at, thick);
            let [[x, y, z], [i, j, k]] = [corner, edges];
            let _ = writeln!(text, "B {x} {y} {z} {i} 0 0 0 {j} 0 0 0 {k}");
        }
    }
    let mut random = Random::new(16);
    for place in 0..7 {
        let [x, y, z] = [place & 1, place >> 1 & 1, place >> 2].map(|bit| if bit == 1 { 0.6 } else { -0.6 });
        let mut draw = |size: f64| random.between(-size, size);
        let ([i, j, k], [u, v, w]) = ([draw(0.25), draw(0.25), draw(0.25)], [draw(3.0), draw(3.0), draw(3.0)]);
        let _ = writeln!(text, "C {} {} {} {} {} {} {u} {v} {w} 1 0.15", x - i, y - j, z - k, x + i, y + j, z + k);
    }
    let mut simulation = opened(scene(&text), backend, Integrator::VelocityVerlet);
    let total = |simulation: &mut Simulation| {
        let energy = simulation.energy().expect("energies");
        energy.kinetic + energy.contact
    };
    let before = total(&mut simulation);
    simulation.run(on(backend, 20_000, 150), 1e-3).expect("steps");
    within(total(&mut simulation), before, 5e-3, "energy");
}

/// Two rows of fixed rods along x, at z = -0.5 and 0.5, each of `count` rods.
fn rails(count: u32) -> String {
    let mut text = String::new();
    for (row, z) in [(0, -0.5), (1, 0.5)] {
        for place in 0..=count {
            let _ = writeln!(text, "S {} {place} 0 {z} 0 0 0 0 0 0 1 0.3 1", row * 100 + place + 1);
        }
        for place in 1..=count {
            let _ = writeln!(text, "R {} {} 0.3 1", row * 100 + place, row * 100 + place + 1);
        }
    }
    text
}

/// A ball slides without friction on two rails, each a row of twelve rods. It kept 2.25 of its speed of 3, after 30 collisions.
fn e29_a_ball_on_rails_of_rods_keeps_its_velocity(backend: Backend) {
    let text = format!("set gravity 9.81\nset friction 0\n{}S 900 0.5 0.61819979983984 0 3 0 0 0 0 0 1 0.5 0\n", rails(12));
    let mut simulation = opened(scene(&text), backend, Integrator::Rk4);
    simulation.run(on(backend, 730, 120), 0.005).expect("steps");
    let ball: SphereState = *simulation.spheres().expect("spheres").last().expect("a ball");
    within(f64::from(ball.velocity.x), 3.0, 1e-4, "velocity");
    assert_eq!(simulation.report().total_collisions, 0);
}

/// Fixed rods with a radius of 0.2 through points in the plane z = 0.
fn chain(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for (place, [x, y]) in (1..).zip(points) {
        let _ = writeln!(text, "S {place} {x} {y} 0 0 0 0 0 0 0 1 0.2 1");
    }
    for place in 1..points.len() {
        let _ = writeln!(text, "R {place} {} 0.2 -1", place + 1);
    }
    text
}

/// What a ball with a radius of 0.5 touches: whether it is a rod, and the overlap.
fn touched(chain: &str, [x, y]: [f64; 2], backend: Backend) -> Vec<(bool, f32)> {
    let text = format!("set gravity 0\n{chain}S 900 {x} {y} 0 0 0 0 0 0 0 1 0.5 0\n");
    let mut simulation = opened(scene(&text), backend, Integrator::Rk4);
    let contacts = simulation.contacts().expect("contacts");
    contacts.iter().map(|contact| (matches!(contact.b, Body::Rod(_)), contact.overlap)).collect()
}

/// A ball is moved over a chain whose middle rises, and along a chain whose middle sinks.
fn e29_a_ball_touches_the_nearest_part_of_a_chain(backend: Backend) {
    let straight = chain(&[[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]);
    for step in 0..=on(backend, 200, 6) {
        let x = -1.2 + 2.4 * f64::from(step) / f64::from(on(backend, 200, 6));
        let found = touched(&straight, [x, 0.65], backend);
        assert_eq!(found.len(), 1, "{found:?} at {x}");
        let beyond = (x.abs() - 1.0).max(0.0);
        within(f64::from(found[0].1), 0.7 - 0.65_f64.hypot(beyond), 1e-4, &format!("overlap at {x}"));
        assert_eq!(found[0].0, beyond == 0.0, "{found:?} at {x}");
    }
    let roof = chain(&[[-1.0, -0.5], [0.0, 0.0], [1.0, -0.5]]);
    let found = touched(&roof, [0.1, 0.65], backend);
    assert!(found.len() == 1 && !found[0].0, "{found:?}");
    let groove = chain(&[[-1.0, 0.5], [0.0, 0.0], [1.0, 0.5]]);
    let found = touched(&groove, [0.02, 0.75], backend);
    assert!(found.len() == 2 && found.iter().all(|(is_rod, _)| *is_rod), "{found:?}");
}

/// A bead of 0.5 on rods of 0.2: a ball touches the bead, in the crease also the rod, and further on only the rod.
fn e29_a_ball_in_the_crease_of_a_bead_touches_both(backend: Backend) {
    let beads =
        chain(&[[-3.0, 0.0], [0.0, 0.0], [3.0, 0.0]]).replacen("S 2 0 0 0 0 0 0 0 0 0 1 0.2", "S 2 0 0 0 0 0 0 0 0 0 1 0.5", 1);
    for (x, y, bead, rods) in [(0.0, 0.95, 1, 0), (0.68, 0.69, 1, 1), (1.5, 0.69, 0, 1)] {
        let found = touched(&beads, [x, y], backend);
        let count = |is_rod: bool| found.iter().filter(|(found, _)| *found == is_rod).count();
        assert_eq!((count(false), count(true)), (bead, rods), "{found:?} at {x}");
    }
}

both! {
    e29_a_ball_in_the_crease_of_a_bead_touches_both,
    e29_a_ball_on_rails_of_rods_keeps_its_velocity,
    e29_a_ball_that_meets_the_end_of_a_capsule_keeps_its_energy,
    e29_a_ball_touches_the_nearest_part_of_a_chain,
    e29_elastic_capsules_in_a_room_keep_their_energy,
    e29_random_hits_of_a_capsule_keep_the_energy,
    e29_two_capsules_that_meet_keep_their_energy,
}
