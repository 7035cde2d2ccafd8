//! Sliding and rolling: balls, boxes, a belt, a leaning card, a floor of tiles.

use rockfall::glam::{Quat, Vec3};
use rockfall::{Cuboid, Integrator, Material, Pair, Scene, Shape, Sphere};

use super::{FRAME, GRAVITY, add, add_box, bodies, empty, frames, ground};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu};
use crate::{Outcome, Result};

/// A ball slides over a floor until it rolls.
pub(super) fn ball(outcome: &mut Outcome) -> Result<()> {
    const FRICTION: f64 = 0.3;
    const SPEED: f64 = 5.0;
    let mut scene = ground(0.0, FRICTION as f32, 0.0)?;
    scene.add_sphere(Sphere::new([0.0, 0.5, 0.0], 0.5).velocity([SPEED as f32, 0.0, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let (mut speeds, mut surfaces, mut rolls) = (vec![(0.0, SPEED)], vec![(0.0, 0.0)], f64::NAN);
    for frame in 1..=60 {
        simulation.run(1, FRAME)?;
        let (ball, time) = (simulation.spheres()?[0], f64::from(frame) * f64::from(FRAME));
        let (speed, surface) = (f64::from(ball.velocity.x), f64::from(-ball.angular_momentum.z / (0.4 * 0.5)));
        speeds.push((time, speed));
        surfaces.push((time, surface));
        if rolls.is_nan() && (speed - surface).abs() < 1e-3 {
            rolls = time;
        }
    }
    let until = 2.0 / 7.0 * SPEED / (FRICTION * GRAVITY);
    outcome.check("14: sliding ball, μ = 0.3, 5 m/s: speed when it rolls, m/s", SPEED * 5.0 / 7.0, speeds[60].1, 1e-3);
    outcome.check("14: time until it rolls, s", until, rolls, 0.017);
    outcome.charts.push(
        Chart::new("hard-rolling", "A ball slides until it rolls", Axis::linear("time, s"), Axis::linear("speed, m/s"))
            .add(0, Mark::Line, "centre, theory", curve(0.0, 1.0, 200, |t| SPEED - FRICTION * GRAVITY * t.min(until)))
            .add(0, Mark::Points, "centre", speeds)
            .add(1, Mark::Line, "surface by the spin, theory", curve(0.0, 1.0, 200, |t| 2.5 * FRICTION * GRAVITY * t.min(until)))
            .add(1, Mark::Points, "surface by the spin", surfaces),
    );
    let before = simulation.spheres()?[0].velocity.x;
    frames(&mut simulation, 6.0)?;
    let after = simulation.spheres()?[0].velocity.x;
    outcome.check("15: rolling ball: speed after 6 s over that before", 1.0, (after / before).into(), 1e-4);
    Ok(())
}

/// A turned box is thrown over a floor.
pub(super) fn thrown(outcome: &mut Outcome) -> Result<()> {
    const FRICTION: f64 = 0.5;
    const SPEED: f64 = 4.0;
    let mut scene = ground(0.0, FRICTION as f32, 0.0)?;
    let along = Quat::from_rotation_y(0.7) * Vec3::X;
    let edges = Vec3::new(1.0, 0.5, 1.0);
    let shape = Shape::new().mass(1.0).cuboid(Cuboid::between(-0.5 * edges, 0.5 * edges));
    let turn = Quat::from_rotation_y(0.4);
    add(&mut scene, shape, |place| place.at([0.0, 0.25, 0.0]).turned(turn).velocity(SPEED as f32 * along))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 2.0)?;
    let h = f64::from(FRAME) / f64::from(simulation.substeps().unwrap_or(1));
    let body = &bodies(&mut simulation)?[0];
    let way = body.position * Vec3::new(1.0, 0.0, 1.0);
    let distance = SPEED * SPEED / (2.0 * FRICTION * GRAVITY) - 0.5 * SPEED * h;
    outcome.check("16: box thrown at 4 m/s, μ = 0.5: distance, v² / 2μg - v h / 2, m", distance, way.length().into(), 2e-3);
    outcome.check("16: angle between its way and its throw, rad", 0.0, way.normalize().cross(along).y.into(), 1e-3);
    let yaw = 2.0 * (body.orientation * turn.inverse()).y;
    outcome.check("16: yaw, rad", 0.0, yaw.into(), 1e-3);
    Ok(())
}

/// A cube spins on a floor. The mean lever of the friction is that of four corners, a / √2.
pub(super) fn spun(outcome: &mut Outcome) -> Result<()> {
    const FRICTION: f64 = 0.3;
    const SPIN: f64 = 5.0;
    let mut scene = ground(0.0, FRICTION as f32, 0.0)?;
    let shape = Shape::new().mass(1.0).cuboid(Cuboid::between(Vec3::splat(-0.5), Vec3::splat(0.5)));
    add(&mut scene, shape, |place| place.at([0.0, 0.5, 0.0]).spin([0.0, SPIN as f32, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let mut stops = f64::NAN;
    for frame in 1..=60 {
        simulation.run(1, FRAME)?;
        if stops.is_nan() && bodies(&mut simulation)?[0].angular_momentum.length() < 1e-3 / 6.0 {
            stops = f64::from(frame) * f64::from(FRAME);
        }
    }
    let exact = SPIN / 6.0 / (FRICTION * GRAVITY * 0.5_f64.sqrt());
    outcome.check("17: cube of 5 rad/s, μ = 0.3: time until it stops, s", exact, stops, 0.02);
    let at = bodies(&mut simulation)?[0].position;
    outcome.check("17: way of its centre, m", 0.0, at.x.hypot(at.z).into(), 1e-3);
    Ok(())
}

/// A belt takes a box along.
pub(super) fn belt(outcome: &mut Outcome) -> Result<()> {
    const FRICTION: f64 = 0.4;
    let mut scene = empty(0.0, FRICTION as f32, 0.0);
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]).surface_velocity([2.0, 0.0, 0.0]))?;
    add_box(&mut scene, Vec3::ONE, 1.0, 0.5)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let (mut speeds, mut reached) = (vec![(0.0, 0.0)], f64::NAN);
    for frame in 1..=60 {
        simulation.run(1, FRAME)?;
        let (time, speed) = (f64::from(frame) * f64::from(FRAME), f64::from(bodies(&mut simulation)?[0].velocity.x));
        speeds.push((time, speed));
        if reached.is_nan() && speed > 2.0 - 1e-3 {
            reached = time;
        }
    }
    let until = 2.0 / (FRICTION * GRAVITY);
    outcome.check("18: box on a belt of 2 m/s, μ = 0.4: speed, m/s", 2.0, speeds[60].1, 1e-3);
    outcome.check("18: time until it has this speed, s", until, reached, 0.017);
    Ok(())
}

/// A card leans at 25° on a smooth wall. Whether it falls.
fn card_falls(friction: f32) -> Result<bool> {
    let mut scene = empty(0.0, friction, 0.0);
    let [rough, smooth] = ["rough", "smooth"].map(Material::new);
    let (rough, smooth) = (scene.add_material(rough)?, scene.add_material(smooth)?);
    let of = |friction| Pair::default().restitution(0.0).friction(friction);
    scene.set_pair(rough, rough, of(friction))?;
    scene.set_pair(rough, smooth, of(0.0))?;
    scene.add_box(Cuboid::between([-1.0, 0.0, -5.0], [0.0, 5.0, 5.0]).material(smooth))?;
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]).material(rough))?;
    let half = Vec3::new(0.01, 1.0, 0.5);
    let turn = Quat::from_rotation_z(25_f32.to_radians());
    // Its lowest and its leftmost corner touch the floor and the wall.
    let reach = |axis: Vec3| (turn.inverse() * axis).abs().dot(half);
    let at = Vec3::new(reach(Vec3::X), reach(Vec3::Y), 0.0);
    let shape = Shape::new().mass(1.0).material(rough).cuboid(Cuboid::between(-half, half));
    add(&mut scene, shape, |place| place.at(at.as_dvec3()).turned(turn))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 4.0)?;
    Ok(bodies(&mut simulation)?[0].position.distance(at) > 1e-3)
}

pub(super) fn card(outcome: &mut Outcome) -> Result<()> {
    for (friction, falls) in [(0.3_f32, 0.0), (0.2, 1.0)] {
        let found = f64::from(u8::from(card_falls(friction)?));
        outcome.check(format!("26: card at 25° on a smooth wall, μ = {friction}: falls (limit 0.2332)"), falls, found, 0.0);
    }
    Ok(())
}

/// A smooth floor of tiles from x = -1 to 32, in two rows.
fn tiles() -> Result<Scene> {
    let mut scene = empty(0.0, 0.0, 0.0);
    for k in 0..32_u8 {
        for row in 0..2_u8 {
            let (x, z) = (f32::from(k) - 0.5, f32::from(row) - 0.9);
            scene.add_box(Cuboid::between([x, -0.5, z], [x + 1.0, 0.0, z + 1.0]))?;
        }
    }
    Ok(scene)
}

/// A box and a ball glide over seams.
pub(super) fn seams(outcome: &mut Outcome) -> Result<()> {
    for (name, is_ball) in [("box", false), ("ball", true)] {
        let mut scene = tiles()?;
        let shape = Shape::new().mass(1.0);
        let shape = if is_ball {
            shape.sphere([0.0; 3], 0.4)
        } else {
            shape.cuboid(Cuboid::between(Vec3::splat(-0.4), Vec3::splat(0.4)))
        };
        add(&mut scene, shape, |place| place.at([0.0, 0.4, 0.0]).velocity([4.0, 0.0, 0.0]))?;
        let mut simulation = on_cpu(scene, Integrator::Rk4)?;
        let (mut slowest, mut off) = (f64::INFINITY, 0.0_f64);
        for _ in 0..420 {
            simulation.run(1, FRAME)?;
            let body = &bodies(&mut simulation)?[0];
            slowest = slowest.min(body.velocity.x.into());
            off = off.max(f64::from(body.position.y - 0.4).abs());
        }
        outcome.check(format!("34: {name} of 4 m/s over 28 smooth tiles: least speed, m/s"), 4.0, slowest, 1e-3);
        outcome.check(format!("34: {name} over tiles: greatest change of its height, m"), 0.0, off, 1e-4);
    }
    Ok(())
}
