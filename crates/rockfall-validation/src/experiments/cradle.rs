//! Newton's cradle and struck chains, with and without gaps.

use rockfall::{Integrator, Rod, Scene, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const RADIUS: f32 = 0.5;
const LENGTH: f64 = 3.0;
const LIFT: f64 = 0.3;

/// Empty scene for elastic bodies without friction and damping. Every approach is a collision.
fn elastic(gravity: f32) -> Scene {
    with(|settings| {
        (settings.gravity, settings.restitution) = (gravity, 1.0);
        (settings.friction, settings.contact_damping, settings.activation_threshold) = (0.0, 0.0, 0.0);
    })
}

/// Five balls on rods, of which the first `lifted` are lifted by 0.3 rad.
fn cradle(lifted: usize, gap: f32) -> Result<Simulation> {
    let mut scene = elastic(10.0);
    for place in 0..5 {
        let x = f64::from(place as f32 * (2.0 * RADIUS + gap));
        let angle = if place < lifted { LIFT } else { 0.0 };
        let pivot = scene.add_sphere(Sphere::new([x as f32, LENGTH as f32, 0.0], 0.1).fixed())?;
        let ball = [(x - LENGTH * angle.sin()) as f32, (LENGTH - LENGTH * angle.cos()) as f32, 0.0];
        let ball = scene.add_sphere(Sphere::new(ball, RADIUS))?;
        scene.add_rod(Rod::new(pivot, ball, 0.02).length(LENGTH as f32))?;
    }
    on_cpu(scene, Integrator::Rk4)
}

/// Largest angle of each ball in the half swing after the impact, over the angle of the lift, and the relative error of the
/// energy.
fn swing(lifted: usize, gap: f32) -> Result<([f64; 5], f64)> {
    const STEP: f32 = 1.0 / 1024.0;
    let mut simulation = cradle(lifted, gap)?;
    let before = simulation.energy()?.total();
    let quarter = 0.25 * std::f64::consts::TAU * (LENGTH / 10.0).sqrt() * (1.0 + LIFT * LIFT / 16.0);
    let mut angles = [0.0_f64; 5];
    // Ends shortly before the balls come back.
    for step in 0..(1.9 * quarter / f64::from(STEP)) as u32 {
        simulation.step(STEP)?;
        if f64::from(step) * f64::from(STEP) < 1.1 * quarter {
            continue;
        }
        for (place, angle) in angles.iter_mut().enumerate() {
            let spheres = simulation.spheres()?;
            let aside = spheres[2 * place + 1].position.x - spheres[2 * place].position.x;
            let now = (f64::from(aside) / LENGTH).asin() / LIFT;
            if now.abs() > angle.abs() {
                *angle = now;
            }
        }
    }
    Ok((angles, (simulation.energy()?.total() - before).abs() / (10.0 * LENGTH * (1.0 - LIFT.cos()) * lifted as f64)))
}

fn cradles(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("ball"), Axis::linear("angle of its swing / angle of the lift"));
    let mut chart = Chart::new("cradle", "Newton's cradle with gaps of 0.01: swings after the impact", axes.0, axes.1);
    for lifted in 1..=4 {
        let (angles, energy) = swing(lifted, 0.01)?;
        let expected = |place: usize| if place >= 5 - lifted { 1.0 } else { 0.0 };
        let worst = (0..5).map(|place| (angles[place] - expected(place)).abs()).fold(0.0, f64::max);
        outcome.check(format!("{lifted} lifted, gaps: swing / lift, largest departure"), 0.0, worst, 0.08);
        outcome.check(format!("{lifted} lifted, gaps: energy, relative error"), 0.0, energy, 0.01);
        let points = (0..5).map(|place| (place as f64 + 1.0, angles[place])).collect();
        chart = chart.add(lifted - 1, Mark::Points, format!("{lifted} lifted"), points);
        let (touching, energy) = swing(lifted, 0.0)?;
        let names = ["one", "two", "three", "four"];
        let text = touching.map(crate::number::digits).join(", ");
        outcome.facts.push((names[lifted - 1], text));
        outcome.check(format!("{lifted} lifted, touching: energy, relative error"), 0.0, energy, 0.02);
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Final velocities of a row of spheres `gap` apart, of which the first arrives at a speed of 1.
fn row(count: usize, gap: f32, seconds: f32) -> Result<Vec<f64>> {
    let mut scene = elastic(0.0);
    scene.settings.contact_force = if gap < 0.0 { 0.0 } else { 1000.0 };
    for place in 0..count {
        let speed = if place == 0 { 1.0 } else { 0.0 };
        scene.add_sphere(Sphere::new([place as f32 * (2.0 * RADIUS + gap), 0.0, 0.0], RADIUS).velocity([speed, 0.0, 0.0]))?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run((seconds * 1024.0) as u64, 1.0 / 1024.0)?;
    Ok(simulation.spheres()?.iter().map(|sphere| f64::from(sphere.velocity.x)).collect())
}

fn rows(outcome: &mut Outcome) -> Result<()> {
    let struck = row(20, 0.01, 0.5)?;
    outcome.check("chain of 20, gaps: speed of the last", 1.0, struck[19], 1e-4);
    let left: f64 = struck[..19].iter().map(|speed| speed.abs()).fold(0.0, f64::max);
    outcome.check("chain of 20, gaps: fastest of the others", 0.0, left, 1e-4);
    // The row has overlaps of 0.001 before the impact, and no contact force that would push it apart.
    let pressed = row(5, -1e-3, 0.1)?;
    outcome.check("row of five, pressed: speed of the last", 1.0, pressed[4], 5e-3);
    outcome.check("row of five, pressed: momentum", 1.0, pressed.iter().sum(), 1e-5);
    let energy: f64 = pressed.iter().map(|speed| speed * speed).sum();
    outcome.check("row of five, pressed: energy / energy before", 1.0, energy, 5e-3);
    let touching = row(20, 0.0, 0.5)?;
    outcome.fact("touching", touching[19]);
    outcome.check("chain of 20, touching: momentum", 1.0, touching.iter().sum(), 1e-5);
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        cradles(&mut outcome)?;
        rows(&mut outcome)?;
        Ok(outcome)
    })
}
