//! Cohesion (docs/physics section 4.13): pull-off force, sticking speed, and bound bodies.

use std::f64::consts::PI;

use rockfall::{Backend, ContactLaw, Pair, Simulation, Sphere};

use super::{ball, scene_with, simulation, soft};

const LAWS: [ContactLaw; 2] = [ContactLaw::Linear, ContactLaw::HertzMindlin];
const GAMMA: f64 = 2.0;
/// E* of the material `soft` with itself, and k_n.
const YOUNG: f64 = 1e5 / (2.0 * (1.0 - 0.0625));
const STIFFNESS: f64 = 1e4;

/// Two balls of radius 0.5 and 0.3, one above the other at an overlap, with cohesion. The upper one may be fixed.
fn two_balls(law: ContactLaw, backend: Backend, overlap: f64, is_fixed: bool, change: impl Fn(Sphere) -> Sphere) -> Simulation {
    let mut scene = scene_with(law);
    let material = soft(&mut scene, "soft");
    let properties = Pair::default().restitution(0.5).friction(0.5).stiffness(STIFFNESS as f32);
    scene.set_pair(material, material, properties.surface_energy(GAMMA as f32)).expect("a valid pair");
    let upper = ball(&scene, material, [0.0; 3], 0.5);
    scene.add_sphere(if is_fixed { upper.fixed() } else { upper }).expect("a valid sphere");
    let lower = ball(&scene, material, [0.0, (overlap - 0.8) as f32, 0.0], 0.3);
    scene.add_sphere(change(lower)).expect("a valid sphere");
    simulation(scene, backend)
}

/// R* of the two balls.
fn radius() -> f64 {
    0.5 * 0.3 / 0.8
}

/// Overlap at which the elastic force has a size.
fn overlap_of(law: ContactLaw, force: f64) -> f64 {
    match law {
        ContactLaw::HertzMindlin => (3.0 * force / (4.0 * YOUNG * radius().sqrt())).powf(2.0 / 3.0),
        _ => force / STIFFNESS,
    }
}

fn height(simulation: &mut Simulation) -> f64 {
    simulation.sync().expect("the state").spheres()[1].position.y.into()
}

/// A ball hangs below a fixed one as long as the force that pulls it is less than 4 pi gamma R*, at the overlap of the closed form.
fn a_ball_hangs_up_to_the_pull_off_force(backend: Backend) {
    let (steps, dt) = crate::common::on(backend, (8000, 1e-4), (600, 1e-3));
    for law in LAWS {
        let most = 4.0 * PI * GAMMA * radius();
        for share in [0.5_f64, 0.97, 1.03] {
            let overlap = overlap_of(law, (1.0 - share).max(0.01) * most);
            let pull = [0.0, (-share * most) as f32, 0.0];
            let mut simulation = two_balls(law, backend, overlap, true, |ball| ball.force(pull));
            let energy = simulation.energy().expect("energies").contact;
            let elastic = if law == ContactLaw::Linear { 0.5 } else { 0.4 } * (1.0 - share).max(0.01) * most * overlap;
            let expected = elastic - most * overlap;
            assert!((energy - expected).abs() < 1e-3 * expected.abs(), "{law}, {share}: energy {energy}, expected {expected}");
            simulation.run(steps, dt).expect("steps");
            let found = height(&mut simulation) + 0.8;
            if share < 1.0 {
                assert!((found - overlap).abs() < 0.01 * overlap + 1e-7, "{law}, {share}: overlap {found}, expected {overlap}");
            } else {
                assert!(found < -0.1, "{law}, {share}: it hangs with the overlap {found}");
            }
        }
    }
}

/// Speed of approach below which two bodies stick, in f64, from the equation of motion of an impact.
fn sticking_speed(law: ContactLaw, mass: f64, damping: f64) -> f64 {
    let attraction = 4.0 * PI * GAMMA * radius();
    let sticks = |speed: f64| {
        let (mut overlap, mut approach, dt) = (0.0_f64, speed, 2e-6);
        for _ in 0..400_000 {
            let (stiffness, elastic) = match law {
                ContactLaw::Linear => (STIFFNESS, STIFFNESS * overlap),
                _ => {
                    let stiffness = 2.0 * YOUNG * (radius() * overlap.max(0.0)).sqrt();
                    (stiffness, 2.0 / 3.0 * stiffness * overlap)
                }
            };
            let push = (elastic + damping * (stiffness * mass).sqrt() * approach).max(0.0);
            approach -= dt * (push - attraction) / mass;
            overlap += dt * approach;
            if overlap < 0.0 {
                return false;
            }
        }
        true
    };
    let (mut low, mut high) = (0.0, 10.0);
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if sticks(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Balls that meet more slowly than the sticking speed stay together; faster ones separate.
#[test]
fn slow_balls_stick() {
    for law in LAWS {
        let masses = [0.5_f64, 0.3].map(|radius| 4.0 / 3.0 * PI * radius.powi(3));
        let mass = masses[0] * masses[1] / (masses[0] + masses[1]);
        // For e = 0.5, as tests/laws/witness.rs finds it.
        let damping = super::witness::damping(law, 0.5);
        let critical = sticking_speed(law, mass, damping);
        assert!(critical > 0.05, "{law}: {critical}");
        for (share, sticks) in [(0.97, true), (1.03, false)] {
            let speed = (share * critical) as f32;
            let mut simulation = two_balls(law, Backend::Cpu, -1e-4, false, |ball| ball.velocity([0.0, speed, 0.0]));
            simulation.run(60_000, 1e-5).expect("steps");
            let [one, two] = [0, 1].map(|k| simulation.sync().expect("the state").spheres()[k].position);
            let is_together = one.distance(two) < 0.8;
            assert_eq!(is_together, sticks, "{law}: {share} of the critical speed {critical}");
        }
    }
}

both!(a_ball_hangs_up_to_the_pull_off_force);
