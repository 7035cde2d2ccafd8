//! Rebound of a spinning ball with friction in the collision, against the relations of the rigid body.

use rockfall::{Cuboid, Integrator, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const RADIUS: f64 = 0.5;
const SPEED: f64 = 10.0;
const E: f64 = 0.75;
const MU: f64 = 0.2;
const STEP: f64 = 1.0 / 16384.0;

/// Velocity along the floor and surface velocity r omega after the rebound. `angle` and `surface` describe the ball before it.
fn theory(angle: f64, surface: f64) -> (f64, f64) {
    let (along, normal) = (SPEED * angle.sin(), SPEED * angle.cos());
    let slip = along + surface;
    // The friction impulse either stops the slip or is mu times the normal impulse.
    let change = -(MU * (1.0 + E) * normal).min(2.0 / 7.0 * slip.abs()) * slip.signum();
    (along + change, surface + 2.5 * change)
}

/// Measured velocity along the floor, surface velocity and normal velocity after the rebound.
fn rebound(angle: f64, surface: f64) -> Result<[f64; 3]> {
    let mut scene = with(|settings| {
        (settings.gravity, settings.friction) = (0.0, 0.0);
        (settings.restitution, settings.collision_friction) = (E as f32, MU as f32);
    });
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]))?;
    let (along, normal) = (SPEED * angle.sin(), SPEED * angle.cos());
    let mut ball = Sphere::new([0.0, RADIUS as f32 + 0.01, 0.0], RADIUS as f32).velocity([along as f32, -normal as f32, 0.0]);
    ball.angular_momentum.z = (0.4 * RADIUS * surface) as f32;
    let ball = scene.add_sphere(ball)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run((0.03 / normal / STEP) as u64, STEP as f32)?;
    let state = simulation.sphere(ball)?;
    Ok([f64::from(state.velocity.x), RADIUS * f64::from(state.spin().z), f64::from(state.velocity.y)])
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        let axes = (
            Axis::linear("angle of incidence (degrees)"),
            Axis::linear("velocity along the floor after / before impact speed"),
        );
        let mut chart = Chart::new("rebound", "A ball that rebounds with friction", axes.0, axes.1);
        let (mut along, mut spin, mut normal): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for (colour, surface) in [-10.0, 0.0, 10.0].into_iter().enumerate() {
            let mut points = Vec::new();
            for degrees in [0.0_f64, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0] {
                let angle = degrees.to_radians();
                let found = rebound(angle, surface)?;
                let expected = theory(angle, surface);
                along = along.max((found[0] - expected.0).abs() / SPEED);
                spin = spin.max((found[1] - expected.1).abs() / SPEED);
                normal = normal.max((found[2] - E * SPEED * angle.cos()).abs() / SPEED);
                points.push((degrees, found[0] / SPEED));
            }
            let line = curve(0.0, 80.0, 81, |degrees| theory(degrees.to_radians(), surface).0 / SPEED);
            let label = format!("surface velocity {surface}");
            chart = chart.add(colour, Mark::Line, format!("{label}, theory"), line).add(colour, Mark::Points, label, points);
        }
        outcome.check("velocity along the floor: largest departure / impact speed", 0.0, along, 2e-3);
        outcome.check("surface velocity of the spin: largest departure / impact speed", 0.0, spin, 2e-3);
        outcome.check("normal velocity: largest departure / impact speed", 0.0, normal, 1e-5);
        outcome.charts.push(chart);
        Ok(outcome)
    })
}
