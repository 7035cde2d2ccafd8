//! JKR cohesion: force over overlap, pull-off force, sticking speed, and the work that a contact takes.

use std::f64::consts::PI;

use rockfall::{CohesionModel, Pair, Simulation, SphereId};

use super::{Grains, Solid};
use crate::chart::{Axis, Chart, Mark};
use crate::{Outcome, Result};

const SOFT: Solid = Solid(1e7, 0.25, 2500.0);
const RADIUS: f64 = 0.01;
/// A tenth of the Rayleigh time, and a time step that resolves an impact at the sticking speed.
const STEP: f64 = 8e-5;
const FINE: f64 = 1e-6;

/// A contact of bodies with the reduced radius `radius`, by the formulas of Johnson, Kendall and Roberts.
#[derive(Clone, Copy)]
struct Jkr {
    gamma: f64,
    radius: f64,
}

impl Jkr {
    fn overlap(&self, a: f64) -> f64 {
        a * a / self.radius - 2.0 * (PI * self.gamma * a / SOFT.reduced_modulus()).sqrt()
    }

    /// Contact radius at the tear.
    fn least(&self) -> f64 {
        (PI * self.gamma * self.radius.powi(2) / (4.0 * SOFT.reduced_modulus())).cbrt()
    }

    /// Distance at the tear.
    fn tear(&self) -> f64 {
        -self.overlap(self.least())
    }

    fn pull_off(&self) -> f64 {
        3.0 * PI * self.gamma * self.radius
    }

    /// Force at an overlap. The contact radius is found by bisection.
    fn force(&self, overlap: f64) -> f64 {
        let (mut low, mut high) = (self.least(), self.radius);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.overlap(middle) < overlap { low = middle } else { high = middle }
        }
        let young = SOFT.reduced_modulus();
        4.0 * young * low.powi(3) / (3.0 * self.radius) - 2.0 * PI * low * low * (4.0 * self.gamma * young / (PI * low)).sqrt()
    }

    /// The work of a contact by Thornton and Ning (1998).
    fn work(&self) -> f64 {
        7.09 * ((2.0 * self.gamma).powi(5) * self.radius.powi(4) / SOFT.reduced_modulus().powi(2)).cbrt()
    }
}

fn sticky(gamma: f64, restitution: f32) -> Result<Grains> {
    let pair = Pair::default().restitution(restitution).friction(0.5).surface_energy(gamma as f32);
    Grains::new(SOFT, pair.cohesion(CohesionModel::Jkr))
}

/// The greatest force that pulls a ball from a fixed one of half its size without separating them, found by bisection. The
/// balls touch before they are pulled.
fn pull_off(jkr: Jkr) -> Result<f64> {
    let (mut low, mut high) = (0.0, 2.0 * jkr.pull_off());
    for _ in 0..10 {
        let force = 0.5 * (low + high);
        let mut grains = sticky(jkr.gamma, 0.3)?;
        let upper = grains.ball([0.0; 3], 0.5 * RADIUS).fixed();
        grains.scene.add_sphere(upper)?;
        let lower = grains.ball([0.0, 0.1 * jkr.tear() - 1.5 * RADIUS, 0.0], RADIUS);
        let id = grains.scene.add_sphere(lower)?;
        let mut simulation = grains.simulation()?;
        for share in [0.0, 0.5, 0.8, 1.0] {
            simulation.set_force(id, [0.0, (-share * force) as f32, 0.0])?;
            simulation.run(2_000, STEP as f32)?;
        }
        simulation.run(2_000, STEP as f32)?;
        if simulation.contacts()?.is_empty() { high = force } else { low = force }
    }
    Ok(0.5 * (low + high))
}

/// Overlaps in units of the tearing distance and forces in units of the pull-off force, of a heavy ball that is pulled slowly
/// from a plane or from a ball of half its size until it is free.
fn curve(jkr: Jkr, on_plane: bool) -> Result<Vec<(f64, f64)>> {
    let (steps, dt) = (400_u32, 1e-5_f32);
    let mut grains = sticky(jkr.gamma, 1.0)?;
    if on_plane {
        grains.plane(0.1)?;
    } else {
        let ball = grains.ball([0.0, -0.5 * RADIUS, 0.0], 0.5 * RADIUS).fixed();
        grains.scene.add_sphere(ball)?;
    }
    let time = f64::from(steps) * f64::from(dt);
    // It loses about a twentieth of its speed.
    let speed = 2.2 * jkr.tear() / time;
    let mass = 20.0 * jkr.pull_off() * time / speed;
    let mut heavy = grains.ball([0.0, RADIUS - 0.9 * jkr.tear(), 0.0], RADIUS).velocity([0.0, speed as f32, 0.0]);
    heavy.mass = mass as f32;
    let id = grains.scene.add_sphere(heavy)?;
    let mut simulation = grains.simulation()?;
    let state = |simulation: &mut Simulation, id: SphereId| -> Result<(f64, f64)> {
        let sphere = simulation.sync()?.sphere(id)?;
        Ok((sphere.position.y.into(), sphere.velocity.y.into()))
    };
    let mut before = state(&mut simulation, id)?;
    let mut points = Vec::new();
    for _ in 0..steps {
        simulation.run(1, dt)?;
        let after = state(&mut simulation, id)?;
        let force = mass * (after.1 - before.1) / f64::from(dt);
        points.push(((f64::from(RADIUS as f32) - before.0) / jkr.tear(), force / jkr.pull_off()));
        before = after;
    }
    Ok(points)
}

fn curves(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("overlap / tearing distance"), Axis::linear("force / pull-off force"));
    let mut chart = Chart::new("grains-necks", "Balls that are pulled apart, with JKR cohesion", axes.0, axes.1);
    for (place, (name, on_plane)) in [("two balls", false), ("ball and plane", true)].into_iter().enumerate() {
        let jkr = Jkr { gamma: 5.0, radius: if on_plane { RADIUS } else { RADIUS / 3.0 } };
        let points = curve(jkr, on_plane)?;
        let theory = |overlap: f64| if overlap > -1.0 { jkr.force(overlap * jkr.tear()) / jkr.pull_off() } else { 0.0 };
        // The slope at the tear is infinite, and rounding decides when it comes.
        let counts = points.iter().filter(|(overlap, _)| (overlap + 1.0).abs() > 0.01);
        let worst = counts.map(|(overlap, force)| (force - theory(*overlap)).abs()).fold(0.0, f64::max);
        outcome.check(format!("JKR, {name}: largest error of the force (pull-off forces)"), 0.0, worst, 0.01);
        let end = points.iter().filter(|(_, force)| *force < -0.3).map(|(overlap, _)| *overlap).fold(f64::INFINITY, f64::min);
        outcome.check(format!("JKR, {name}: overlap at the tear (tearing distances)"), -1.0, end, 0.01);
        chart = chart.add(place, Mark::Points, name, points.into_iter().skip(6 * place).step_by(12).collect());
    }
    let jkr = Jkr { gamma: 5.0, radius: RADIUS };
    let line = (0..=190).map(|part| 0.01 * f64::from(part) - 0.9999).map(|at| (at, jkr.force(at * jkr.tear()) / jkr.pull_off()));
    outcome.charts.push(chart.add(2, Mark::Line, "theory", line.collect()));
    Ok(())
}

/// Speed of an elastic ball after its impact on a plane; `None` if it sticks.
fn rebound(jkr: Jkr, speed: f64) -> Result<Option<f64>> {
    let mut grains = sticky(jkr.gamma, 1.0)?;
    grains.plane(0.1)?;
    let ball = grains.ball([0.0, RADIUS + 1e-7, 0.0], RADIUS).velocity([0.0, -speed as f32, 0.0]);
    let id = grains.scene.add_sphere(ball)?;
    let mut simulation = grains.simulation()?;
    simulation.run((0.02 / FINE) as u64, FINE as f32)?;
    let after = f64::from(simulation.sync()?.sphere(id)?.velocity.y);
    Ok(simulation.contacts()?.is_empty().then_some(after))
}

fn sticking(outcome: &mut Outcome) -> Result<()> {
    let jkr = Jkr { gamma: 5.0, radius: RADIUS };
    let ratio = (2.0 * jkr.gamma / RADIUS).powi(5) / (SOFT.2.powi(3) * SOFT.reduced_modulus().powi(2));
    let expected = 1.84 * ratio.powf(1.0 / 6.0);
    let (mut low, mut high) = (0.5 * expected, 2.0 * expected);
    for _ in 0..8 {
        let speed = 0.5 * (low + high);
        if rebound(jkr, speed)?.is_none() { low = speed } else { high = speed }
    }
    outcome.check("JKR, ball on a plane: sticking speed (m/s)", expected, 0.5 * (low + high), 0.02 * expected);
    for factor in [1.2, 2.0] {
        let speed = factor * expected;
        let after = rebound(jkr, speed)?.unwrap_or(0.0);
        let lost = 0.5 * SOFT.mass(RADIUS) * (speed * speed - after * after);
        let label = format!("JKR, impact at {factor} sticking speeds: energy lost (µJ)");
        outcome.check(label, 1e6 * jkr.work(), 1e6 * lost, 0.02e6 * jkr.work());
    }
    Ok(())
}

pub(super) fn run(outcome: &mut Outcome) -> Result<()> {
    for gamma in [0.5, 5.0] {
        let jkr = Jkr { gamma, radius: RADIUS / 3.0 };
        let expected = jkr.pull_off();
        outcome.check(format!("JKR, gamma = {gamma} J/m²: pull-off force (N)"), expected, pull_off(jkr)?, 0.01 * expected);
    }
    curves(outcome)?;
    sticking(outcome)
}
