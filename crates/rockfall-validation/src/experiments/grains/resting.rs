//! Balls on a plane under gravity: stacked, rolling on a slope and to rest, spinning, and hanging by cohesion.

use std::f64::consts::PI;

use rockfall::glam::Vec3;
use rockfall::{Pair, RollingModel, Simulation};

use super::{Grains, Solid, hertz_overlap};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::period;
use crate::{Outcome, Result};

const SOFT: Solid = Solid(1e7, 0.25, 2500.0);
const RADIUS: f64 = 0.01;
const GRAVITY: f64 = 9.81;
/// A tenth of the Rayleigh time.
const STEP: f64 = 8e-5;

fn properties() -> Pair {
    Pair::default().restitution(0.3).friction(0.9)
}

/// A ball that lies on a plane of a slope, with a velocity along x and a spin.
fn lying(pair: Pair, slope: f64, velocity: f64, spin: [f64; 3]) -> Result<Simulation> {
    let mut grains = Grains::new(SOFT, pair)?;
    grains.scene.settings.gravity = GRAVITY as f32;
    grains.scene.settings.gravity_direction = Vec3::new(slope as f32, -1.0, 0.0).normalize();
    grains.plane(2.0)?;
    let weight = SOFT.mass(RADIUS) * GRAVITY / (1.0 + slope * slope).sqrt();
    let ball = grains.ball([0.0, RADIUS - hertz_overlap(SOFT, RADIUS, weight), 0.0], RADIUS);
    let momentum = spin.map(|part| part as f32 * ball.inertia());
    grains.scene.add_sphere(ball.velocity([velocity as f32, 0.0, 0.0]).angular_momentum(momentum))?;
    grains.simulation()
}

/// Runs for some seconds. Returns position and velocity along x, and the spin about the normal.
fn after(simulation: &mut Simulation, seconds: f64) -> Result<[f64; 3]> {
    simulation.run((seconds / STEP).round() as u64, STEP as f32)?;
    let sphere = simulation.sync()?.spheres()[0];
    Ok([sphere.position.x.into(), sphere.velocity.x.into(), sphere.spin().y.into()])
}

fn stacked(outcome: &mut Outcome) -> Result<()> {
    let mut grains = Grains::new(SOFT, properties())?;
    grains.scene.settings.gravity = GRAVITY as f32;
    grains.plane(0.1)?;
    for level in [1.0, 3.0] {
        let ball = grains.ball([0.0, level * RADIUS, 0.0], RADIUS);
        grains.scene.add_sphere(ball)?;
    }
    let mut simulation = grains.simulation()?;
    simulation.run(20_000, STEP as f32)?;
    let heights: Vec<f64> = simulation.spheres()?.iter().map(|sphere| sphere.position.y.into()).collect();
    let weight = SOFT.mass(RADIUS) * GRAVITY;
    let lower = hertz_overlap(SOFT, RADIUS, 2.0 * weight);
    let upper = hertz_overlap(SOFT, 0.5 * RADIUS, weight);
    outcome.check("two stacked balls: overlap with the plane (µm)", 1e6 * lower, 1e6 * (RADIUS - heights[0]), 1e4 * lower);
    let found = 2.0 * RADIUS - (heights[1] - heights[0]);
    outcome.check("two stacked balls: overlap of the balls (µm)", 1e6 * upper, 1e6 * found, 1e4 * upper);
    Ok(())
}

/// Period of the slip of a ball that lies on a plane and is pushed along it without losses. The contact does not slide, so the slip is
/// that of an oscillator with Mindlin's stiffness k = 8 G* sqrt(R o) and the inverse mass 1/m + (R - o)²/I, which is about 7/(2 m).
fn rocking(outcome: &mut Outcome) -> Result<()> {
    /// A 500th of a period, in s.
    const FINE: f64 = 1e-5;
    let Solid(young, poisson, _) = SOFT;
    let weight = SOFT.mass(RADIUS) * GRAVITY;
    let overlap = hertz_overlap(SOFT, RADIUS, weight);
    let shear = young / (2.0 * (1.0 + poisson)) / (2.0 * (2.0 - poisson));
    let stiffness = 8.0 * shear * (RADIUS * overlap).sqrt();
    let inverse_mass = (1.0 + 2.5 * (1.0 - overlap / RADIUS).powi(2)) / SOFT.mass(RADIUS);
    let theory = 2.0 * PI / (stiffness * inverse_mass).sqrt();
    // The greatest force is a fifth of Coulomb's limit.
    let mut simulation = lying(properties().restitution(1.0), 0.0, 0.005, [0.0; 3])?;
    let mut slips = Vec::new();
    for step in 1..=(20.5 * theory / FINE) as u32 {
        simulation.run(1, FINE as f32)?;
        let sphere = simulation.sync()?.spheres()[0];
        let slip = f64::from(sphere.velocity.x) + (RADIUS - overlap) * f64::from(sphere.spin().z);
        slips.push((f64::from(step) * FINE, slip));
    }
    outcome.check("a ball that rocks on a plane: period (ms)", 1e3 * theory, 1e3 * period(&slips), 5.0 * theory);
    Ok(())
}

/// Acceleration on slopes, with mu_r = 0.3: none below it, and 5/7 g (sin - mu_r cos) above.
fn slopes(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("tan of the slope"), Axis::linear("acceleration (m/s²)"));
    let mut chart = Chart::new("grains-slope", "A ball with mu_r = 0.3 on a slope", axes.0, axes.1);
    let theory = |slope: f64| (5.0 / 7.0 * GRAVITY * (slope - 0.3) / (1.0 + slope * slope).sqrt()).max(0.0);
    for (place, model) in [RollingModel::SpringDashpot, RollingModel::ConstantTorque].into_iter().enumerate() {
        let (mut points, mut worst) = (Vec::new(), 0.0_f64);
        for slope in [0.1, 0.2, 0.28, 0.32, 0.4, 0.5, 0.6] {
            let mut simulation = lying(properties().rolling_friction(0.3).rolling_model(model), slope, 0.0, [0.0; 3])?;
            let early = after(&mut simulation, 0.2)?;
            let late = after(&mut simulation, 0.2)?;
            let found = (late[1] - early[1]) / 0.2;
            worst = worst.max((found - theory(slope)).abs());
            points.push((slope, found));
            if model == RollingModel::SpringDashpot && slope == 0.28 {
                outcome.check("slope 0.28, model c: creep in 0.2 s (µm)", 0.0, 1e6 * (late[0] - early[0]), 0.1);
            }
        }
        outcome.check(format!("slopes, model {model}: largest error of the acceleration (m/s²)"), 0.0, worst, 0.03);
        chart = chart.add(place, Mark::Points, format!("model {model}"), points);
    }
    let line = (0..=60).map(|part| 0.01 * f64::from(part)).map(|slope| (slope, theory(slope))).collect();
    outcome.charts.push(chart.add(2, Mark::Line, "theory", line));
    Ok(())
}

fn to_rest(outcome: &mut Outcome) -> Result<()> {
    let deceleration = 5.0 / 7.0 * 0.1 * GRAVITY;
    for model in [RollingModel::SpringDashpot, RollingModel::ConstantTorque] {
        let pair = properties().rolling_friction(0.1).rolling_model(model);
        let mut simulation = lying(pair, 0.0, 0.3, [0.0, 0.0, -0.3 / RADIUS])?;
        let rest = after(&mut simulation, 0.8)?;
        let distance = 0.5 * 0.3 * 0.3 / deceleration;
        outcome.check(format!("rolling to rest, model {model}: distance (m)"), distance, rest[0], 0.03 * distance);
        outcome.check(format!("rolling to rest, model {model}: velocity at rest (m/s)"), 0.0, rest[1], 1e-4);
    }
    let weight = SOFT.mass(RADIUS) * GRAVITY;
    let contact_radius = (RADIUS * hertz_overlap(SOFT, RADIUS, weight)).sqrt();
    let rate = 2.0 / 3.0 * contact_radius * 0.5 * weight / (0.4 * SOFT.mass(RADIUS) * RADIUS * RADIUS);
    let mut simulation = lying(properties().twisting_friction(0.5), 0.0, 0.0, [0.0, 40.0, 0.0])?;
    let early = after(&mut simulation, 0.1)?;
    let late = after(&mut simulation, 0.2)?;
    outcome.check("twisting: deceleration (1/s²)", rate, (early[2] - late[2]) / 0.2, 0.01 * rate);
    Ok(())
}

/// The greatest force that pulls a ball from a fixed one of half its size without separating them, found by bisection.
fn pull_off(gamma: f64) -> Result<f64> {
    let radius = RADIUS / 3.0;
    let expected = 4.0 * PI * gamma * radius;
    let (mut low, mut high) = (0.0, 2.0 * expected);
    for _ in 0..10 {
        let force = 0.5 * (low + high);
        let mut grains = Grains::new(SOFT, properties().surface_energy(gamma as f32))?;
        let overlap = hertz_overlap(SOFT, radius, (expected - force).max(0.01 * expected));
        let upper = grains.ball([0.0; 3], 0.5 * RADIUS).fixed();
        let lower = grains.ball([0.0, overlap - 1.5 * RADIUS, 0.0], RADIUS);
        grains.scene.add_sphere(upper)?;
        grains.scene.add_sphere(lower.force([0.0, -force as f32, 0.0]))?;
        let mut simulation = grains.simulation()?;
        simulation.run(5_000, STEP as f32)?;
        if simulation.contacts()?.is_empty() { high = force } else { low = force }
    }
    Ok(0.5 * (low + high))
}

fn cohesion(outcome: &mut Outcome) -> Result<()> {
    for gamma in [0.5, 5.0] {
        let expected = 4.0 * PI * gamma * RADIUS / 3.0;
        outcome.check(format!("cohesion, gamma = {gamma} J/m²: pull-off force (N)"), expected, pull_off(gamma)?, 0.01 * expected);
    }
    Ok(())
}

pub(super) fn run(outcome: &mut Outcome) -> Result<()> {
    stacked(outcome)?;
    rocking(outcome)?;
    slopes(outcome)?;
    to_rest(outcome)?;
    cohesion(outcome)
}
