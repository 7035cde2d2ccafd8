//! Impacts: bounces, a rod, a gas, cradles, billiards, fast bodies.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{Cuboid, Integrator, Scene, Shape, Simulation, Sphere};

use super::{FRAME, GRAVITY, add, bodies, frames, ground};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu};
use crate::{Effort, Outcome, Result};

/// A scene without a field; its floor lies far below.
fn weightless(friction: f32, restitution: f32) -> Result<Scene> {
    let mut scene = ground(0.0, friction, restitution)?;
    scene.settings.gravity = 0.0;
    Ok(scene)
}

/// Angular momentum about the origin, in f64.
fn angular_momentum(simulation: &mut Simulation) -> Result<DVec3> {
    let moment = |body: &rockfall::RigidBody, mass: f64| {
        body.position.as_dvec3().cross(mass * body.velocity.as_dvec3()) + body.angular_momentum.as_dvec3()
    };
    Ok(bodies(simulation)?.iter().map(|body| moment(body, 1.0)).sum())
}

/// A ball with e = 1 bounces for half a minute.
pub(super) fn bounces(outcome: &mut Outcome) -> Result<()> {
    let mut scene = ground(0.0, 0.5, 1.0)?;
    scene.add_sphere(Sphere::new([0.0, 1.1, 0.0], 0.1))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let (mut tops, mut before) = (Vec::new(), -1.0);
    for frame in 1..=1800 {
        simulation.run(1, FRAME)?;
        let ball = simulation.spheres()?[0];
        let v = f64::from(ball.velocity.y);
        if before > 0.0 && v <= 0.0 {
            // The top of the present parabola.
            let height = f64::from(ball.position.y) - 0.1 + 0.5 * v * v / GRAVITY;
            tops.push((f64::from(frame) * f64::from(FRAME) + v / GRAVITY, height));
        }
        before = v;
    }
    let farther = |one: f64, other: f64| if (other - 1.0).abs() > (one - 1.0).abs() { other } else { one };
    let worst = tops.iter().map(|top| top.1).fold(1.0, farther);
    let last = tops[tops.len() - 1].0;
    outcome.check("3: ball with e = 1 from 1 m, 30 s: height of the worst bounce, m", 1.0, worst, 1e-3);
    let period = 2.0 * (2.0 / GRAVITY).sqrt();
    outcome.check("3: its period, s", period, (last - tops[0].0) / (tops.len() - 1) as f64, 1e-3 * period);
    Ok(())
}

/// A rod at 45° falls on a smooth floor.
pub(super) fn rod(outcome: &mut Outcome) -> Result<()> {
    const RESTITUTION: f64 = 0.8;
    const SPEED: f64 = 2.0;
    let mut scene = weightless(0.0, RESTITUTION as f32)?;
    let shape = Shape::new().capsule([-0.5, 0.0, 0.0], [0.5, 0.0, 0.0], 0.05).mass(1.0);
    let inertia = shape.mass_properties_of()?.inertia[2];
    let turn = Quat::from_rotation_z(FRAC_PI_4 as f32);
    add(&mut scene, shape, |place| place.at([0.0, 0.6, 0.0]).turned(turn).velocity([0.0, -SPEED as f32, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 0.2)?;
    let body = &bodies(&mut simulation)?[0];
    let lever = 0.5 * FRAC_1_SQRT_2;
    let impulse = (1.0 + RESTITUTION) * SPEED / (1.0 + lever * lever / inertia);
    outcome.check("5: rod at 45°, e = 0.8: speed after the impact, m/s", impulse - SPEED, body.velocity.y.into(), 2e-3);
    let spin = f64::from(body.angular_momentum.z.abs()) / inertia;
    outcome.check("5: its spin, rad/s", lever * impulse / inertia, spin, 5e-3);
    Ok(())
}

/// An elastic gas in a box.
pub(super) fn gas(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    let mut scene = weightless(0.0, 1.0)?;
    for axis in Vec3::AXES {
        for sign in [-1.0, 1.0] {
            let reach = 3.5 * (Vec3::ONE - axis) + 0.5 * axis;
            let middle = 10.0 * Vec3::Y + 3.0 * sign * axis;
            scene.add_box(Cuboid::between(middle - reach, middle + reach))?;
        }
    }
    let mut random = Pcg64Mcg::seed_from_u64(1);
    for k in 0..100_u8 {
        let at = Vec3::new(f32::from(k % 5) - 2.0, f32::from(k / 5 % 5) + 8.0, f32::from(k / 25) - 1.5);
        let velocity = Vec3::from_array(std::array::from_fn(|_| random.random_range(-3.0..3.0)));
        scene.add_sphere(Sphere::new(at, 0.2).velocity(velocity))?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let start = simulation.energy()?.kinetic;
    let seconds = effort.pick(4.0_f32, 20.0);
    frames(&mut simulation, seconds)?;
    let change = simulation.energy()?.kinetic / start - 1.0;
    outcome.check(format!("6: gas of 100 balls, e = 1: relative energy change in {seconds} s"), 0.0, change, 1e-4);
    let outside = |ball: &rockfall::SphereState| (ball.position - 10.0 * Vec3::Y).abs().max_element() > 2.31;
    let escaped = simulation.spheres()?.iter().filter(|ball| outside(ball)).count();
    outcome.check("6: balls that have left the box", 0.0, escaped as f64, 0.0);
    Ok(())
}

/// Balls that touch pass the impulse on.
pub(super) fn cradles(outcome: &mut Outcome) -> Result<()> {
    for (count, bound) in [(5_u8, 1e-3), (20, 1e-2)] {
        let mut scene = weightless(0.0, 1.0)?;
        for k in 0..count {
            let (x, v) = if k == 0 { (-0.5, 1.0) } else { (f32::from(k), 0.0) };
            scene.add_sphere(Sphere::new([x, 5.0, 0.0], 0.5).velocity([v, 0.0, 0.0]))?;
        }
        let mut simulation = on_cpu(scene, Integrator::Rk4)?;
        frames(&mut simulation, 2.0)?;
        let speeds: Vec<f64> = simulation.spheres()?.iter().map(|ball| ball.velocity.x.into()).collect();
        let [others @ .., last] = &speeds[..] else { continue };
        outcome.check(format!("7: cradle of {count} balls: speed of the last ball, m/s"), 1.0, *last, bound);
        let fastest = others.iter().map(|speed| speed.abs()).fold(0.0, f64::max);
        if count == 5 {
            outcome.check("7: cradle of 5 balls: greatest speed of the others, m/s", 0.0, fastest, bound);
        }
        let energy: f64 = speeds.iter().map(|v| v * v).sum();
        outcome.check(format!("7: cradle of {count} balls: energy, end / start"), 1.0, energy, 2e-3);
    }
    Ok(())
}

/// Two boxes with spin meet beside their centres.
pub(super) fn eccentric(outcome: &mut Outcome) -> Result<()> {
    for (e, friction) in [(0.0, 0.5), (0.5, 0.5), (1.0, 0.5), (1.0, 0.0)] {
        let mut scene = weightless(friction, e)?;
        let edges = Vec3::new(1.0, 0.8, 0.6);
        let shape = || Shape::new().mass(1.0).cuboid(Cuboid::between(-0.5 * edges, 0.5 * edges));
        let high = |at: Vec3| (at + 5.0 * Vec3::Y).as_dvec3();
        add(&mut scene, shape(), |place| place.at(high(Vec3::new(-1.5, 0.3, 0.2))).velocity([3.0, 0.0, 0.0]).spin([1.0, 2.0, -1.0]))?;
        add(&mut scene, shape(), |place| place.at(high(Vec3::new(1.5, -0.2, -0.1))).velocity([-2.0, 0.1, 0.0]).spin([-2.0, 1.0, 0.5]))?;
        let mut simulation = on_cpu(scene, Integrator::Rk4)?;
        let start = (simulation.energy()?.kinetic, angular_momentum(&mut simulation)?);
        frames(&mut simulation, 2.0)?;
        let momentum: DVec3 = bodies(&mut simulation)?.iter().map(|body| body.velocity.as_dvec3()).sum();
        let turned = angular_momentum(&mut simulation)?.distance(start.1);
        let name = format!("8: two boxes, e = {e}, μ = {friction}");
        outcome.check(format!("{name}: momentum change, kg m/s"), 0.0, momentum.distance(DVec3::new(1.0, 0.1, 0.0)), 2e-6);
        outcome.check(format!("{name}: angular momentum change, kg m²/s"), 0.0, turned, 3e-4);
        if (e, friction) == (1.0, 0.0) {
            outcome.check(format!("{name}: energy, end / start"), 1.0, simulation.energy()?.kinetic / start.0, 1e-4);
        }
    }
    Ok(())
}

/// The velocity along the floor after a bounce, and the speed of the surface of the ball by its spin.
fn bounce(v: [f64; 2], restitution: f32, friction: f32, height: f32) -> Result<[f64; 3]> {
    const RADIUS: f32 = 0.05;
    let mut scene = weightless(friction, restitution)?;
    scene.add_sphere(Sphere::new([0.0, height, 0.0], RADIUS).velocity([v[0] as f32, -v[1] as f32, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 0.1)?;
    let ball = simulation.spheres()?[0];
    let surface = -ball.angular_momentum.z / (0.4 * RADIUS);
    Ok([ball.velocity.x, ball.velocity.y, surface].map(f64::from))
}

/// A fast ball bounces off a floor at an angle.
pub(super) fn oblique(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    const DOWN: f64 = 10.0;
    let impulse = |v: f64, e: f64, friction: f64| (friction * (1.0 + e) * DOWN).min(2.0 / 7.0 * v);
    for (e, friction) in [(0.8_f32, 0.5_f32), (0.8, 0.1), (0.5, 0.5), (0.0, 0.5)] {
        let j = impulse(5.0, e.into(), friction.into());
        let wanted = [5.0 - j, 10.0 * f64::from(e), 2.5 * j];
        let mut worst = 0.0_f64;
        for step in 0..effort.pick(5, 20_u8) {
            let found = bounce([5.0, DOWN], e, friction, 0.3 + 0.004 * f32::from(step))?;
            worst = found.iter().zip(wanted).map(|(found, wanted)| (found - wanted).abs()).fold(worst, f64::max);
        }
        let what = "speed or surface speed, worst error, m/s";
        outcome.check(format!("40: e = {e}, μ = {friction}: {what}"), 0.0, worst, 1e-3);
    }
    let (before, after) = (Axis::linear("speed along / down before"), Axis::linear("speed along after / down before"));
    let mut chart = Chart::new("hard-oblique", "A ball bounces off at an angle, e = 0.8", before, after);
    for (colour, friction) in [0.1, 0.3, 0.5].into_iter().enumerate() {
        let exact = |ratio: f64| ratio - impulse(ratio * DOWN, 0.8, friction) / DOWN;
        let mut found = Vec::new();
        for k in 0..=effort.pick(8, 20_u8) {
            let ratio = 4.0 * f64::from(k) / f64::from(effort.pick(8, 20_u8));
            found.push((ratio, bounce([ratio * DOWN, DOWN], 0.8, friction as f32, 0.33)?[0] / DOWN));
        }
        let name = format!("μ = {friction}");
        chart = chart.add(colour, Mark::Line, format!("{name}, Coulomb"), curve(0.0, 4.0, 100, exact));
        chart = chart.add(colour, Mark::Points, name, found);
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Directions of two elastic balls after one has hit the other beside its centre.
pub(super) fn billiards(outcome: &mut Outcome) -> Result<()> {
    const RADIUS: f32 = 0.05;
    const SPEED: f64 = 20.0;
    let (mut found, mut worst) = ([Vec::new(), Vec::new()], [0.0_f64; 2]);
    for step in 0..19_u8 {
        let offset = 0.1 * f32::from(step) * RADIUS;
        let sine = f64::from(step) * 0.05;
        let exact = [-sine.asin(), sine.acos()];
        for gap in 0..5_u8 {
            let mut scene = weightless(0.0, 1.0)?;
            scene.add_sphere(Sphere::new([0.0, 5.0, 0.0], RADIUS))?;
            let from = -0.4 - 0.021 * f32::from(gap);
            scene.add_sphere(Sphere::new([from, 5.0 + offset, 0.0], RADIUS).velocity([SPEED as f32, 0.0, 0.0]))?;
            let mut simulation = on_cpu(scene, Integrator::Rk4)?;
            frames(&mut simulation, 0.1)?;
            let spheres = simulation.spheres()?;
            let sides = if step == 0 { 1 } else { 2 };
            for (side, ball) in spheres.iter().enumerate().take(sides) {
                let v = ball.velocity.as_dvec3();
                let angle = v.y.atan2(v.x);
                worst[side] = worst[side].max((angle - exact[side]).abs());
                if gap == 0 {
                    found[side].push((f64::from(offset / RADIUS), angle.to_degrees()));
                }
            }
        }
    }
    for (name, worst) in ["target", "shooter"].into_iter().zip(worst) {
        outcome.check(format!("41: ball of 20 m/s on one at rest, 19 offsets, 5 gaps: worst angle of the {name}, rad"), 0.0, worst, 5e-4);
    }
    let [target, shooter] = found;
    outcome.charts.push(
        Chart::new("hard-billiards", "Two elastic balls", Axis::linear("offset / radius"), Axis::linear("direction afterwards, °"))
            .add(0, Mark::Line, "target, theory", curve(0.0, 1.9, 100, |x| -(0.5 * x).asin().to_degrees()))
            .add(0, Mark::Points, "target", target)
            .add(1, Mark::Line, "shooter, theory", curve(0.0, 1.9, 100, |x| (0.5 * x).acos().to_degrees()))
            .add(1, Mark::Points, "shooter", shooter),
    );
    Ok(())
}

/// Fast balls: beside a box, at a thin wall, and at a ball that stands before one.
pub(super) fn fast(outcome: &mut Outcome) -> Result<()> {
    let wall = |scene: &mut Scene| scene.add_box(Cuboid::between([-0.01, 4.0, -1.0], [0.01, 6.0, 1.0]));
    let (mut deflected, mut behind) = (0.0_f64, 0.0_f64);
    for step in 0..20_u8 {
        let from = -1.0 - 0.017 * f32::from(step);
        let mut scene = weightless(0.5, 1.0)?;
        scene.add_box(Cuboid::between([-0.3, 4.0, -0.3], [0.3, 5.0, 0.3]))?;
        scene.add_sphere(Sphere::new([from, 5.051, 0.0], 0.05).velocity([20.0, 0.0, 0.0]))?;
        let mut simulation = on_cpu(scene, Integrator::Rk4)?;
        frames(&mut simulation, 0.2)?;
        deflected = deflected.max((simulation.spheres()?[0].velocity - Vec3::new(20.0, 0.0, 0.0)).length().into());
        let mut scene = weightless(0.5, 0.5)?;
        wall(&mut scene)?;
        scene.add_sphere(Sphere::new([5.0 * from, 5.03, 0.01], 0.05).velocity([200.0, 0.0, 0.0]))?;
        let mut simulation = on_cpu(scene, Integrator::Rk4)?;
        frames(&mut simulation, 0.2)?;
        behind += f64::from(u8::from(simulation.spheres()?[0].position.x > 0.0));
    }
    outcome.check("35: ball that passes a box at 1 mm and 20 m/s: greatest change of its velocity, m/s", 0.0, deflected, 1e-4);
    outcome.check("36: 20 balls of 200 m/s at a wall of 2 cm: balls behind it", 0.0, behind, 0.0);
    let mut scene = weightless(0.0, 1.0)?;
    wall(&mut scene)?;
    scene.add_sphere(Sphere::new([-0.21, 5.0, 0.0], 0.05))?;
    scene.add_sphere(Sphere::new([-1.0, 5.0, 0.0], 0.05).velocity([20.0, 0.0, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 0.2)?;
    let speed = simulation.spheres()?[1].velocity.x;
    outcome.check("42: ball that hits one before a wall, and is hit by it: speed, m/s", -20.0, speed.into(), 1e-2);
    Ok(())
}
