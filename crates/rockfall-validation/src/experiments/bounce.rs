//! Restitution: a bouncing sphere, a row of spheres, and the contact force alone.

use rockfall::{Cuboid, Integrator, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f64 = 10.0;
const RADIUS: f32 = 0.1;
const STEP: f32 = 1.0 / 2048.0;

/// Rebound speeds of a sphere that is dropped from 1 unit above its position on the floor, as fractions of the speed of the
/// first impact.
fn rebounds(restitution: f32, bounces: usize) -> Result<Vec<f64>> {
    let mut scene = with(|settings| {
        settings.gravity = GRAVITY as f32;
        settings.restitution = restitution;
    });
    scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0]))?;
    let ball = scene.add_sphere(Sphere::new([0.0, 1.0 + RADIUS, 0.0], RADIUS))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let (mut last, mut speeds) = (0.0, Vec::new());
    // No bounce takes longer than twice the first fall.
    for _ in 0..bounces * 2048 {
        simulation.step(STEP)?;
        let state = simulation.sphere(ball)?;
        let (height, speed) = (f64::from(state.position.y - RADIUS), f64::from(state.velocity.y));
        if last < 0.0 && speed > 0.0 {
            // Computed from the energy, so that the time of the rebound within the step does not matter.
            speeds.push((speed * speed + 2.0 * GRAVITY * height).sqrt() / (2.0 * GRAVITY).sqrt());
            if speeds.len() == bounces {
                break;
            }
        }
        last = speed;
    }
    Ok(speeds)
}

fn bouncing(outcome: &mut Outcome) -> Result<()> {
    const BOUNCES: usize = 6;
    let axes = (Axis::linear("bounce n"), Axis::logarithmic("rebound speed / first impact speed"));
    let mut chart = Chart::new("bounce-series", "A dropped sphere", axes.0, axes.1);
    for (place, restitution) in [0.5_f32, 0.75, 0.9].into_iter().enumerate() {
        let e = f64::from(restitution);
        let speeds = rebounds(restitution, BOUNCES)?;
        let worst = (1..).zip(&speeds).map(|(n, speed)| (speed / e.powi(n) - 1.0).abs()).fold(0.0, f64::max);
        outcome.check(format!("e = {e:.2}: number of bounces"), BOUNCES as f64, speeds.len() as f64, 0.0);
        outcome.check(format!("e = {e:.2}: rebound speed / e^n - 1, worst of {BOUNCES}"), 0.0, worst, 1e-3);
        let numbered = (1..).map(f64::from).zip(speeds).collect();
        chart = chart.add(place, Mark::Line, format!("e = {e:.2}: e^n"), curve(1.0, BOUNCES as f64, 20, |n| e.powf(n))).add(
            place,
            Mark::Points,
            format!("e = {e:.2}"),
            numbered,
        );
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Final velocities of five spheres in a row, `gap` apart, of which the first arrives at a speed of 1, and the sum of their
/// squares.
fn row(restitution: f32, gap: f32) -> Result<(Vec<f64>, f64)> {
    let mut scene = with(|settings| {
        (settings.gravity, settings.restitution) = (0.0, restitution);
        settings.activation_threshold = 0.0;
    });
    for place in 0..5_u8 {
        let x = f32::from(place) * (2.0 * RADIUS + gap) - if place == 0 { 0.1 } else { 0.0 };
        let speed = if place == 0 { 1.0 } else { 0.0 };
        scene.add_sphere(Sphere::new([x, 0.0, 0.0], RADIUS).velocity([speed, 0.0, 0.0]))?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(600, 1.0 / 1024.0)?;
    let speeds: Vec<f64> = simulation.spheres()?.iter().map(|sphere| f64::from(sphere.velocity.x)).collect();
    let energy = speeds.iter().map(|speed| speed * speed).sum();
    Ok((speeds, energy))
}

fn cradle(outcome: &mut Outcome) -> Result<()> {
    for e in [1.0_f64, 0.9] {
        let (speeds, _) = row(e as f32, 0.01)?;
        let last = (0.5 * (1.0 + e)).powi(4);
        outcome.check(format!("row of five, gaps, e = {e}: speed of the last"), last, speeds[4], 1e-4);
        outcome.check(format!("row of five, gaps, e = {e}: momentum"), 1.0, speeds.iter().sum(), 1e-5);
    }
    let (speeds, energy) = row(1.0, 0.0)?;
    outcome.check("row of five, touching, e = 1: speed of the last", 1.0, speeds[4], 3e-3);
    outcome.check("row of five, touching, e = 1: energy / energy before", 1.0, energy, 6e-3);
    Ok(())
}

/// Restitution of two spheres that meet by the contact force alone.
fn soft(damping: f32) -> Result<f64> {
    let mut scene = with(|settings| {
        (settings.gravity, settings.collisions) = (0.0, false);
        settings.contact_damping = damping;
    });
    scene.add_sphere(Sphere::new([-0.51, 0.0, 0.0], 0.5).velocity([1.0, 0.0, 0.0]))?;
    scene.add_sphere(Sphere::new([0.51, 0.0, 0.0], 0.5).mass(3.0).velocity([-1.0, 0.0, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(4096, 1.0 / 8192.0)?;
    let spheres = simulation.spheres()?;
    Ok(0.5 * f64::from(spheres[1].velocity.x - spheres[0].velocity.x))
}

/// Restitution by Schwager and Pöschel (2007): the contact ends where the force would pull.
fn soft_theory(damping: f64) -> f64 {
    let rate = 0.5 * damping;
    let frequency = (1000.0 - rate * rate).sqrt();
    let angle = std::f64::consts::PI - (2.0 * rate * frequency).atan2(frequency * frequency - rate * rate);
    (-rate / frequency * angle).exp()
}

fn soft_contacts(outcome: &mut Outcome) -> Result<()> {
    let mut measured = Vec::new();
    for damping in [2.0_f32, 5.0, 12.5, 25.0, 40.0, 55.0] {
        let e = soft(damping)?;
        let name = format!("force alone, Cd = {damping}: restitution");
        outcome.check(name, soft_theory(damping.into()), e, 5e-3);
        measured.push((f64::from(damping), e));
    }
    outcome.fact("soft", soft_theory(12.5));
    let axes = (Axis::linear("contact damping Cd (1/s)"), Axis::linear("restitution"));
    outcome.charts.push(
        Chart::new("bounce-soft", "Restitution of the contact force alone, Cc = 1000", axes.0, axes.1)
            .add(0, Mark::Line, "Schwager and Pöschel 2007", curve(0.5, 60.0, 60, soft_theory))
            .add(0, Mark::Points, "measured", measured),
    );
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        bouncing(&mut outcome)?;
        cradle(&mut outcome)?;
        soft_contacts(&mut outcome)?;
        Ok(outcome)
    })
}
