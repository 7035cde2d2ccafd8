//! The contact law: oscillation of a pressed sphere, and the overlaps of a resting column.

use std::f64::consts::TAU;

use rockfall::{Cuboid, Integrator, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{line_fit, on_cpu, on_one_thread, period, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f64 = 10.0;
const STIFFNESS: f64 = 1000.0;
const STEP: f64 = 1.0 / 512.0;
/// Initial displacement from rest; the overlap at rest is 0.01.
const AMPLITUDE: f64 = 0.005;

/// Displacement from rest over time of a sphere on a fixed one. The amplitude is half of the overlap at rest, so that the
/// spheres never separate.
fn oscillation(damping: f64, mass: f32, seconds: f64) -> Result<Vec<(f64, f64)>> {
    let mut scene = with(|settings| {
        settings.gravity = GRAVITY as f32;
        settings.contact_damping = damping as f32;
        settings.collisions = false;
    });
    // The contact point is near the origin, where the resolution of f32 is finest.
    let rest = 0.25 - GRAVITY / STIFFNESS;
    scene.add_sphere(Sphere::new([0.0, -0.25, 0.0], 0.25).fixed())?;
    let ball = scene.add_sphere(Sphere::new([0.0, (rest + AMPLITUDE) as f32, 0.0], 0.25).mass(mass))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let mut samples = vec![(0.0, AMPLITUDE)];
    for step in 1..=(seconds / STEP) as u32 {
        simulation.step(STEP as f32)?;
        samples.push((f64::from(step) * STEP, f64::from(simulation.sphere(ball)?.position.y) - rest));
    }
    Ok(samples)
}

/// Decay rate in 1/s, from the logarithms of the maxima.
fn decay(samples: &[(f64, f64)]) -> f64 {
    let peaks: Vec<_> = samples
        .windows(3)
        .filter(|three| three[1].1 > three[0].1 && three[1].1 >= three[2].1)
        .map(|three| {
            // The maximum of the parabola through three samples.
            let (left, middle, right) = (three[0].1, three[1].1, three[2].1);
            let curvature = left - 2.0 * middle + right;
            let height = middle - (right - left).powi(2) / (8.0 * curvature);
            (three[1].0, height.ln())
        })
        .collect();
    -line_fit(&peaks).0
}

fn oscillations(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("time (s)"), Axis::linear("displacement from rest (units)"));
    let mut chart = Chart::new("contact-oscillation", "A sphere pressed on another", axes.0, axes.1);
    for (place, (damping, mass)) in [(2.0, 1.0), (12.5, 7.0)].into_iter().enumerate() {
        let rate = 0.5 * damping;
        let frequency = (STIFFNESS - rate * rate).sqrt();
        let seconds = 1.0;
        let samples = oscillation(damping, mass, seconds)?;
        let exact = |t: f64| {
            let (sin, cos) = (frequency * t).sin_cos();
            AMPLITUDE * (-rate * t).exp() * (cos + rate / frequency * sin)
        };
        let worst = samples.iter().map(|(t, y)| (y - exact(*t)).abs()).fold(0.0, f64::max);
        let name = format!("Cd = {damping}, m = {mass}");
        // Only the weakly damped oscillation has enough maxima.
        if place == 0 {
            outcome.check(format!("{name}: period (s)"), TAU / frequency, period(&samples), 2e-4);
            outcome.check(format!("{name}: decay rate (1/s)"), rate, decay(&samples), 0.01);
        }
        outcome.check(format!("{name}: largest departure / amplitude"), 0.0, worst / AMPLITUDE, 2e-3);
        let thin = |points: Vec<(f64, f64)>, by| points.into_iter().step_by(by).collect();
        let theory = samples.iter().map(|(t, _)| (*t, exact(*t))).collect();
        chart = chart.add(place, Mark::Line, format!("{name}, theory"), thin(theory, 2));
        chart = chart.add(place, Mark::Points, name, thin(samples, 12));
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Overlaps of a resting column of `count` spheres of mass 1 on a floor, from the floor up.
fn column(count: u32) -> Result<Vec<f64>> {
    const RADIUS: f32 = 0.125;
    let mut scene = with(|settings| settings.gravity = 1.0);
    scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0]))?;
    for level in 0..count {
        scene.add_sphere(Sphere::new([0.0, RADIUS * (2 * level + 1) as f32, 0.0], RADIUS))?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    // The slowest mode of ten spheres decays at about 0.08 /s.
    simulation.run(12_000, 1.0 / 64.0)?;
    let heights: Vec<f64> = simulation.spheres()?.iter().map(|sphere| f64::from(sphere.position.y)).collect();
    let mut overlaps = vec![f64::from(RADIUS) - heights[0]];
    overlaps.extend(heights.windows(2).map(|pair| 2.0 * f64::from(RADIUS) - (pair[1] - pair[0])));
    Ok(overlaps)
}

fn columns(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("level (0: floor)"), Axis::linear("overlap (units)"));
    let mut chart = Chart::new("contact-column", "Overlaps in a resting column of n spheres", axes.0, axes.1);
    for (place, count) in [1, 3, 10].into_iter().enumerate() {
        let overlaps = column(count)?;
        // The spheres above press on the contact. The reduced mass is m on the floor and m/2 between two spheres.
        let theory = |level: u32| f64::from(count - level) / STIFFNESS * if level == 0 { 1.0 } else { 2.0 };
        let mut worst: f64 = 0.0;
        for (level, overlap) in (0..count).zip(&overlaps) {
            worst = worst.max((overlap / theory(level) - 1.0).abs());
        }
        outcome.check(format!("column of {count}: relative error of the worst level"), 0.0, worst, 1e-3);
        let points = |of: &dyn Fn(u32) -> f64| (0..count).map(|level| (f64::from(level), of(level))).collect();
        chart = chart.add(place, Mark::Line, format!("n = {count}, theory"), points(&theory));
        chart = chart.add(place, Mark::Points, format!("n = {count}"), points(&|level| overlaps[level as usize]));
    }
    outcome.charts.push(chart);
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        oscillations(&mut outcome)?;
        columns(&mut outcome)?;
        Ok(outcome)
    })
}
