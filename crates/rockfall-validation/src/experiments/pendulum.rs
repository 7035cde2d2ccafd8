//! Periods of pendulums made of rods of fixed length.

use std::f64::consts::{FRAC_PI_4, TAU};

use rockfall::{Integrator, Rod, Scene, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, period, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f64 = 10.0;
const STEP: f32 = 1.0 / 512.0;

/// Arithmetic-geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// Period at an amplitude over the period of small swings: (2/pi) K(sin(amplitude/2)).
fn correction(amplitude: f64) -> f64 {
    1.0 / agm(1.0, (0.5 * amplitude).cos())
}

/// A pendulum of masses at distance 1 from a fixed point, at the angles `arms` from its middle, with rods between all pairs.
fn pendulum(arms: &[f64], amplitude: f64) -> Result<Scene> {
    let mut scene = with(|settings| settings.gravity = GRAVITY as f32);
    let mut ends = vec![scene.add_sphere(Sphere::new([0.0; 3], 0.05).fixed())?];
    for arm in arms {
        let angle = amplitude + arm;
        let place = [angle.sin() as f32, -angle.cos() as f32, 0.0];
        ends.push(scene.add_sphere(Sphere::new(place, 0.1))?);
    }
    for (place, one) in ends.iter().enumerate() {
        for other in &ends[..place] {
            let length = scene.sphere(*one)?.position.distance(scene.sphere(*other)?.position);
            scene.add_rod(Rod::new(*other, *one, 0.02).length(length))?;
        }
    }
    Ok(scene)
}

/// Measured period, as the mean of four swings.
fn swing(arms: &[f64], amplitude: f64, expected: f64) -> Result<f64> {
    let mut simulation = on_cpu(pendulum(arms, amplitude)?, Integrator::Rk4)?;
    let mut samples = Vec::new();
    for step in 1..=(4.9 * expected / f64::from(STEP)) as u32 {
        simulation.step(STEP)?;
        let spheres = simulation.spheres()?;
        let middle: rockfall::glam::DVec3 = spheres[1..].iter().map(|sphere| sphere.position.as_dvec3()).sum();
        samples.push((f64::from(step) * f64::from(STEP), middle.x.atan2(-middle.y)));
    }
    Ok(period(&samples))
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        let axes = (Axis::linear("amplitude (degrees)"), Axis::linear("period / period of small swings"));
        let theory = curve(1.0, 165.0, 83, |degrees| correction(degrees.to_radians()));
        let mut chart = Chart::new("pendulum", "Pendulums of rods of fixed length", axes.0, axes.1)
            .add(0, Mark::Line, "(2/pi) K(sin(amplitude/2))", theory)
            .add(
                5,
                Mark::Line,
                "1 + amplitude²/16",
                curve(1.0, 165.0, 83, |degrees| 1.0 + degrees.to_radians().powi(2) / 16.0),
            );
        let small = TAU / GRAVITY.sqrt();
        // I = 2 m l², and the centre of mass is at l cos 45 degrees.
        let frame = small / FRAC_PI_4.cos().sqrt();
        let cases: [(&str, &[f64], f64); 2] =
            [("one mass on a rod", &[0.0], small), ("frame of three rods", &[-FRAC_PI_4, FRAC_PI_4], frame)];
        for (colour, (name, arms, small)) in cases.into_iter().enumerate() {
            let mut points = Vec::new();
            for degrees in [5.0_f64, 30.0, 60.0, 90.0, 120.0, 150.0] {
                let expected = small * correction(degrees.to_radians());
                let found = swing(arms, degrees.to_radians(), expected)?;
                outcome.check(format!("{name}, {degrees}°: period (s)"), expected, found, 2e-3 * expected);
                points.push((degrees, found / small));
            }
            chart = chart.add(colour + 1, Mark::Points, name, points);
        }
        outcome.charts.push(chart);
        Ok(outcome)
    })
}
