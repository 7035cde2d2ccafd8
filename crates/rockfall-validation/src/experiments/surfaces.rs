//! A ball over tiles, over a ridge, in a groove and on rails: several shapes that form one surface.

use rockfall::glam::DVec3;
use rockfall::{ContactAction, Cuboid, Integrator, Polygon, Rod, Scene, Simulation, Sphere, SphereId};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f32 = 9.81;
/// Overlap at rest, G / Cc.
const AT_REST: f32 = GRAVITY / 1000.0;

fn smooth(gravity: f32) -> Scene {
    with(|settings| (settings.gravity, settings.friction) = (gravity, 0.0))
}

/// Times, places and velocities of a ball after each of `samples` parts of a run.
fn path(simulation: &mut Simulation, ball: SphereId, samples: u32, steps: u64, step: f32) -> Result<Vec<(f64, DVec3, DVec3)>> {
    let mut found = Vec::new();
    for sample in 1..=samples {
        simulation.run(steps, step)?;
        let state = simulation.sphere(ball)?;
        let time = f64::from(sample) * steps as f64 * f64::from(step);
        found.push((time, state.position.as_dvec3(), state.velocity.as_dvec3()));
    }
    Ok(found)
}

fn tiles() -> Result<Vec<(f64, DVec3, DVec3)>> {
    let mut scene = smooth(GRAVITY);
    for tile in 0..40 {
        let left = 0.5 * tile as f32 - 0.5;
        scene.add_box(Cuboid::between([left, -1.0, -5.0], [left + 0.5, 0.0, 5.0]))?;
    }
    let ball = scene.add_sphere(Sphere::new([0.3, 0.1 - AT_REST, 0.0], 0.1).velocity([3.0, 0.0, 0.0]))?;
    path(&mut on_cpu(scene, Integrator::Rk4)?, ball, 60, 20, 0.005)
}

fn rails() -> Result<Vec<(f64, DVec3, DVec3)>> {
    let mut scene = smooth(GRAVITY);
    for z in [-0.5, 0.5] {
        let mut last: Option<SphereId> = None;
        for place in 0..=12_u8 {
            let end = scene.add_sphere(Sphere::new([f32::from(place), 0.0, z], 0.3).fixed())?;
            if let Some(last) = last {
                scene.add_rod(Rod::new(last, end, 0.3).length(1.0))?;
            }
            last = Some(end);
        }
    }
    // Both rails together bear the ball: 2 Cc o cos = G, where cos is the height over the distance 0.8 - o of the axes.
    let of = |height: f64| ((0.8 - f64::from(AT_REST) / 2.0 * height.hypot(0.5) / height).powi(2) - 0.25).sqrt();
    let height = (0..20).fold(0.6, |height, _| of(height)) as f32;
    let ball = scene.add_sphere(Sphere::new([0.5, height, 0.0], 0.5).velocity([3.0, 0.0, 0.0]))?;
    path(&mut on_cpu(scene, Integrator::Rk4)?, ball, 36, 20, 0.005)
}

fn straight(outcome: &mut Outcome) -> Result<()> {
    let axes = (Axis::linear("time (s)"), Axis::linear("velocity along the surface (units/s)"));
    let mut chart = Chart::new("surfaces-straight", "A ball that slides over tiles and on rails of rods", axes.0, axes.1)
        .add(2, Mark::Line, "theory", curve(0.0, 6.0, 2, |_| 3.0));
    for (colour, (name, path)) in [("tiles", tiles()?), ("rails", rails()?)].into_iter().enumerate() {
        let (slowest, first) = (path.iter().map(|(_, _, v)| v.x).fold(f64::INFINITY, f64::min), path[0].1.y);
        let hop = path.iter().map(|(_, place, _)| (place.y - first).abs()).fold(0.0, f64::max);
        outcome.check(format!("{name}: least velocity (units/s)"), 3.0, slowest, 3e-4);
        outcome.check(format!("{name}: greatest change of height (units)"), 0.0, hop, 1e-4);
        chart = chart.add(colour, Mark::Points, name, path.iter().map(|(time, _, v)| (*time, v.x)).collect());
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Height of the centre of a ball of radius r over a roof whose ridge is at the origin, if the ball does not leave it.
fn over_ridge(x: f64, radius: f64, slope: f64) -> f64 {
    let (sin, cos) = slope.sin_cos();
    if x.abs() < radius * sin { (radius * radius - x * x).sqrt() } else { radius / cos - x.abs() * sin / cos }
}

fn ridge(outcome: &mut Outcome) -> Result<()> {
    const RADIUS: f64 = 0.5;
    let slope = 25_f64.to_radians();
    let (sin, cos) = (slope.sin() as f32, slope.cos() as f32);
    let mut scene = smooth(1.0);
    (scene.settings.contact_force, scene.settings.contact_damping) = (50_000.0, 0.0);
    scene.settings.collisions = false;
    let (down, along) = (4.0, [0.0, 0.0, 10.0]);
    scene.add_polygon(Polygon::new([-down * cos, -down * sin, -5.0], along, [down * cos, down * sin, 0.0]))?;
    scene.add_polygon(Polygon::new([0.0, 0.0, -5.0], along, [down * cos, -down * sin, 0.0]))?;
    // The ball climbs the left side, and its velocity at the top is 0.3: v² = 0.09 + 2 G h.
    let x = -0.6;
    let height = over_ridge(x, RADIUS, slope);
    let speed = (0.09 + 2.0 * (RADIUS - height)).sqrt() as f32;
    let ball = Sphere::new([x as f32, height as f32, 0.0], RADIUS as f32).velocity([speed * cos, speed * sin, 0.0]);
    let ball = scene.add_sphere(ball)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let total = |simulation: &mut Simulation| simulation.energy().map(|energy| energy.kinetic + energy.potential + energy.contact);
    let before = total(&mut simulation)?;
    let (mut places, mut off, mut change) = (Vec::new(), 0.0_f64, 0.0_f64);
    for _ in 0..150 {
        simulation.run(20, 0.001)?;
        let place = simulation.sphere(ball)?.position.as_dvec3();
        off = off.max((place.y - over_ridge(place.x, RADIUS, slope)).abs());
        change = change.max((total(&mut simulation)? / before - 1.0).abs());
        places.push((place.x, place.y));
    }
    let reached = places.last().map_or(0.0, |(x, _)| *x);
    outcome.check("ridge: 1 if the ball has passed the arc", 1.0, f64::from(u8::from(reached > RADIUS * f64::from(sin))), 0.0);
    outcome.check("ridge: greatest distance of the centre from its path (units)", 0.0, off, 2e-4);
    outcome.check("ridge: greatest change of the energy, relative", 0.0, change, 1e-4);
    let axes = (Axis::linear("x (units)"), Axis::linear("height of the centre (units)"));
    outcome.charts.push(
        Chart::new("surfaces-ridge", "A ball that slides over a ridge", axes.0, axes.1)
            .add(0, Mark::Line, "arc about the ridge, and lines", curve(x, reached, 200, |x| over_ridge(x, RADIUS, slope)))
            .add(1, Mark::Points, "measured", places),
    );
    Ok(())
}

fn groove(outcome: &mut Outcome) -> Result<()> {
    let slope = 30_f32.to_radians();
    let (sin, cos) = slope.sin_cos();
    let mut scene = smooth(GRAVITY);
    for side in [-1.0, 1.0] {
        let (up, out) = ([side * 4.0 * cos, 4.0 * sin, 0.0], [side * sin, -cos, 0.0]);
        scene.add_box(Cuboid::new([0.0, 0.0, -5.0], up, out, [0.0, 0.0, 10.0]))?;
    }
    scene.add_sphere(Sphere::new([1.0, 1.0 * sin / cos + 0.5 / cos, 0.0], 0.5))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(4_000, 0.005)?;
    let contacts = simulation.contacts()?;
    outcome.check("groove: contacts", 2.0, contacts.len() as f64, 0.0);
    let theory = f64::from(GRAVITY) / (2.0 * f64::from(cos));
    for (side, contact) in ["one", "other"].into_iter().zip(&contacts) {
        let ContactAction::Force(force) = contact.action else { return Err("surfaces: the ball in the groove still collides".into()) };
        outcome.check(format!("groove: force on the {side} wall (mass units/s²)"), theory, f64::from(force.length()), 1e-3 * theory);
    }
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        straight(&mut outcome)?;
        ridge(&mut outcome)?;
        groove(&mut outcome)?;
        Ok(outcome)
    })
}
