//! A ball on moving surfaces, and in a loop.

use rockfall::glam::DVec3;
use rockfall::{Cuboid, Integrator, Scene, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, period, with};
use crate::{Effort, Outcome, Result};

/// Radius of the ground, a fixed sphere whose top is at the origin.
const GROUND: f64 = 100.0;
const STEP: f64 = 1.0 / 512.0;

/// Velocity over time of a ball of radius 1/2 that is put on a surface that moves at 1.
fn belt(coulomb: f32) -> Result<Vec<(f64, f64)>> {
    let mut scene = with(|settings| (settings.coulomb_friction, settings.friction) = (coulomb, 1000.0));
    scene.add_sphere(Sphere::new([0.0, -GROUND as f32, 0.0], GROUND as f32).velocity([1.0, 0.0, 0.0]).fixed())?;
    let ball = scene.add_sphere(Sphere::new([0.0, 0.499, 0.0], 0.5))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let mut samples = vec![(0.0, 0.0)];
    for sample in 1..=60_u32 {
        simulation.run(32, STEP as f32)?;
        samples.push((f64::from(sample) * 32.0 * STEP, simulation.sphere(ball)?.velocity.x.into()));
    }
    Ok(samples)
}

/// Final velocity, minus the effect of the acceleration on the slope of the ground.
fn carried(samples: &[(f64, f64)]) -> f64 {
    let (mut x, mut slope, mut last) = (0.0, 0.0, (0.0, 0.0));
    for (t, v) in samples {
        x += 0.5 * (v + last.1) * (t - last.0);
        // A ball that rolls accelerates at 5/7 of gravity along the slope.
        slope += 5.0 / 7.0 * x / (GROUND + 0.5) * (t - last.0);
        last = (*t, *v);
    }
    last.1 - slope
}

fn belts(outcome: &mut Outcome) -> Result<()> {
    let coulomb = belt(0.3)?;
    let root = belt(0.0)?;
    outcome.check("belt, Coulomb, mu_c = 0.3: velocity / that of the belt", 2.0 / 7.0, carried(&coulomb), 3e-3);
    outcome.check("belt, square root: velocity / that of the belt", 2.0 / 7.0, carried(&root), 3e-3);
    let axes = (Axis::linear("time (s)"), Axis::linear("velocity of the ball / that of the belt"));
    outcome.charts.push(
        Chart::new("moving-belt", "A ball that is put on a belt", axes.0, axes.1)
            .add(0, Mark::Line, "Coulomb: mu_c G t, at most 2/7", curve(0.0, 1.9, 191, |t| (0.3 * t).min(2.0 / 7.0)))
            .add(0, Mark::Points, "Coulomb, mu_c = 0.3", coulomb)
            .add(1, Mark::Points, "square root, mu = Cc", root),
    );
    Ok(())
}

/// Angular frequency of a ball that rolls on a circle about the pole of the ground, which spins at `rate`.
fn orbit(rate: f64) -> Result<f64> {
    const GRAVITY: f64 = 10.0;
    let mut scene = with(|settings| {
        settings.gravity = GRAVITY as f32;
        settings.coulomb_friction = 0.8;
    });
    let mut ground = Sphere::new([0.0, -GROUND as f32, 0.0], GROUND as f32).fixed();
    ground.angular_momentum.y = (0.4 * GROUND * GROUND * rate) as f32;
    scene.add_sphere(ground)?;
    let (place, velocity) = (DVec3::new(0.3, 0.0, 0.0), DVec3::new(0.0, 0.0, 0.3));
    // At the contact, the surface of the ball moves with that of the ground.
    let slip = rate * DVec3::Y.cross(place) - velocity;
    let spin = -DVec3::Y.cross(slip) / 0.5;
    // The initial overlap is that at rest, G / Cc.
    let height = ((GROUND + 0.5 - 0.01).powi(2) - place.x * place.x).sqrt() - GROUND;
    let mut ball = Sphere::new([0.3, height as f32, 0.0], 0.5).velocity(velocity.as_vec3());
    ball.angular_momentum = (0.1 * spin).as_vec3();
    let ball = scene.add_sphere(ball)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let mut samples = Vec::new();
    for sample in 0..(3.6 * std::f64::consts::TAU / (2.0 / 7.0 * rate) / (8.0 * STEP)) as u32 {
        samples.push((f64::from(sample) * 8.0 * STEP, f64::from(simulation.sphere(ball)?.velocity.x)));
        simulation.run(8, STEP as f32)?;
    }
    Ok(std::f64::consts::TAU / period(&samples))
}

fn turntable(outcome: &mut Outcome) -> Result<()> {
    // The larger root of w² - 2/7 W w + 5/7 G / R = 0; the last term is due to the curvature of the ground.
    let theory = |rate: f64| {
        let flat = rate / 7.0;
        flat + (flat * flat - 5.0 / 7.0 * 10.0 / (GROUND + 0.5)).sqrt()
    };
    let mut points = Vec::new();
    for rate in [4.0, 5.0, 7.0, 9.0] {
        let found = orbit(rate)?;
        outcome.check(format!("turntable at {rate} rad/s: orbit frequency (rad/s)"), theory(rate), found, 0.015 * theory(rate));
        points.push((rate, found));
    }
    let axes = (Axis::linear("spin of the ground (rad/s)"), Axis::linear("frequency of the orbit (rad/s)"));
    outcome.charts.push(
        Chart::new("moving-turntable", "A ball that rolls on a spinning ground", axes.0, axes.1)
            .add(2, Mark::Line, "flat disc: 2/7", curve(4.0, 9.0, 2, |rate| 2.0 / 7.0 * rate))
            .add(0, Mark::Line, "on the sphere", curve(4.0, 9.0, 51, theory))
            .add(1, Mark::Points, "measured", points),
    );
    Ok(())
}

/// Radius of the loop.
const LOOP: f64 = 1.0;
/// Radius of the ball.
const BALL: f64 = 0.1;
/// Radius of the path of its centre.
const PATH: f64 = LOOP - BALL;
/// Contact force of the track.
const TRACK: f32 = 20_000.0;
/// Gap at which the ball counts as having left the track, in units.
const OFF: f64 = 3e-3;

/// A loop of short boxes around the origin.
fn track(coulomb: f32) -> Result<Scene> {
    const PARTS: u32 = 360;
    let mut scene = with(|settings| {
        // Contact forces alone, because each corner would be a collision.
        settings.collisions = false;
        // The track is stiff, so that the ball touches only one or two boxes, and well damped, so that the corners cause no
        // trembling.
        (settings.contact_force, settings.contact_damping) = (TRACK, 30.0);
        (settings.friction, settings.coulomb_friction) = (0.0, coulomb);
    });
    let half = std::f64::consts::PI / f64::from(PARTS);
    for part in 0..PARTS {
        let angle = 2.0 * half * f64::from(part);
        let (out, along) = (DVec3::new(angle.sin(), -angle.cos(), 0.0), DVec3::new(angle.cos(), angle.sin(), 0.0));
        let width = 2.0 * LOOP * half.tan();
        let corner = LOOP * out - 0.5 * width * along - 0.3 * DVec3::Z;
        let [i, j, k] = [width * along, 0.2 * out, 0.6 * DVec3::Z].map(|edge| edge.as_vec3());
        scene.add_box(Cuboid::new(corner.as_vec3(), i, j, k))?;
    }
    Ok(scene)
}

/// Sine of the angle above the horizontal at which a ball is `OFF` from the track. It starts with the speed of a descent from
/// `heights` times the radius of its path. `None` if it completes the loop.
fn leaves(heights: f64, rolls: bool) -> Result<Option<f64>> {
    let mut scene = track(if rolls { 2.0 } else { 0.0 })?;
    let part = if rolls { 10.0 / 7.0 } else { 2.0 };
    let speed = (part * heights * PATH).sqrt();
    // The overlap that balances gravity and the centripetal force at the bottom.
    let overlap = (speed * speed / PATH + 1.0) / f64::from(TRACK);
    let mut ball = Sphere::new([0.0, -(PATH + overlap) as f32, 0.0], BALL as f32).velocity([speed as f32, 0.0, 0.0]);
    if rolls {
        ball.angular_momentum.z = (-0.4 * BALL * speed) as f32;
    }
    let ball = scene.add_sphere(ball)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    for _ in 0..10_000 {
        simulation.run(2, 1.0 / 2048.0)?;
        let place = simulation.sphere(ball)?.position.as_dvec3();
        let distance = place.x.hypot(place.y);
        if distance < PATH - OFF && place.y > -0.5 * PATH {
            return Ok(Some(place.y / distance));
        }
        // The ball has passed the top and come down on the other side.
        if place.x < 0.0 && place.y < 0.0 {
            return Ok(None);
        }
    }
    Err("moving: the ball has neither left nor completed the loop after 20,000 steps".into())
}

fn looping(outcome: &mut Outcome) -> Result<()> {
    let axes = (
        Axis::linear("height of the start above the bottom (radii)"),
        Axis::linear("sine of the angle where it leaves the loop"),
    );
    let mut chart = Chart::new("moving-loop", "A ball in a loop", axes.0, axes.1);
    for (colour, (name, rolls, slope)) in
        [("sliding", false, 2.0 / 3.0), ("rolling", true, 10.0 / 17.0)].into_iter().enumerate()
    {
        let theory = |heights: f64| slope * (heights - 1.0);
        // After it has left, the ball moves on a parabola with v² = G R sin.
        let off = |heights: f64| {
            let (sin, start) = (theory(heights), theory(heights).asin());
            let (speed, cos) = ((PATH * sin).sqrt(), start.cos());
            let at = |t: f64| (PATH * cos - speed * sin * t, PATH * sin + speed * cos * t - 0.5 * t * t);
            let first = (0..20_000).map(|n| at(f64::from(n) * 1e-4)).find(|(x, y)| x.hypot(*y) < PATH - OFF);
            first.map_or(1.0, |(x, y)| y / x.hypot(y))
        };
        let least = 1.0 + 1.0 / slope;
        let (mut points, mut worst): (Vec<(f64, f64)>, f64) = (Vec::new(), 0.0);
        for heights in [1.4, 1.6, 1.8, 2.0, 2.2, 2.4] {
            if let Some(sine) = leaves(heights, rolls)? {
                worst = worst.max((sine - off(heights)).abs());
                points.push((heights, sine));
            }
        }
        outcome.check(format!("loop, {name}: sine of the angle where it leaves, largest departure"), 0.0, worst, 0.05);
        let goes = |heights: f64| Ok::<f64, crate::Error>(if leaves(heights, rolls)?.is_none() { 1.0 } else { 0.0 });
        outcome.check(
            format!("loop, {name}: completes it from {:.2} radii (1: yes)", 1.04 * least),
            1.0,
            goes(1.04 * least)?,
            0.0,
        );
        outcome.check(
            format!("loop, {name}: completes it from {:.2} radii (1: yes)", 0.96 * least),
            0.0,
            goes(0.96 * least)?,
            0.0,
        );
        chart = chart.add(colour, Mark::Line, format!("{name}, theory"), curve(1.3, 0.99 * least, 40, off)).add(
            colour,
            Mark::Points,
            name,
            points,
        );
    }
    outcome.charts.push(chart);
    Ok(())
}

pub(crate) fn run(_: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        belts(&mut outcome)?;
        turntable(&mut outcome)?;
        looping(&mut outcome)?;
        Ok(outcome)
    })
}
