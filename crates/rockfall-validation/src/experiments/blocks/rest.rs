//! Boxes at rest and the limits of rest: an incline, a stack, an overhang, leaning cards.

use rockfall::glam::{DQuat, DVec3, Quat, Vec3};
use rockfall::{Body, ContactAction, Cuboid, Integrator, Pair, Placement, RigidBodyId, Scene, Simulation};

use super::{DENSITY, GRAVITY, bodies, block, floor, run_for, stage, step, tilt};
use crate::measure::on_cpu;
use crate::{Outcome, Result};

/// Thickness of the cards and rounding radius of their edges, m.
const THICKNESS: f64 = 0.02;
const ROUNDING: f64 = 0.005;

/// What a box did on an incline.
struct Descent {
    /// Way from 0.1 s to 0.5 s, m.
    way: f64,
    /// Mean acceleration in that time, m/s².
    acceleration: f64,
    /// Tilt against the incline at its end, rad.
    tilt: f64,
}

/// A box on an incline whose slope is `slope`.
fn incline(edges: Vec3, rounding: f32, slope: f64, friction: f32) -> Result<Descent> {
    const STIFFNESS: f32 = 1e6;
    let (cos, sin) = (1.0 / slope.hypot(1.0), slope / slope.hypot(1.0));
    let gravity = GRAVITY * DVec3::new(sin, -cos, 0.0).as_vec3();
    let (mut scene, stuff) = stage(gravity, Pair::default().restitution(0.2).friction(friction).stiffness(STIFFNESS))?;
    floor(&mut scene, stuff)?;
    let shape = scene.add_shape(block(stuff, edges, rounding))?;
    let mass = DENSITY * edges.element_product();
    let depth = f64::from(mass * GRAVITY / (4.0 * STIFFNESS)) * cos;
    scene.add_body(Placement::new(shape).at([0.0, 0.5 * f64::from(edges.y) - depth, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let step = step(mass, STIFFNESS, 8.0);
    run_for(&mut simulation, 0.1, step)?;
    let before = bodies(&mut simulation)?[0].clone();
    let time = run_for(&mut simulation, 0.4, step)?;
    let body = &bodies(&mut simulation)?[0];
    let acceleration = f64::from(body.velocity.x - before.velocity.x) / time;
    Ok(Descent { way: f64::from(body.position.x - before.position.x), acceleration, tilt: tilt(body) })
}

pub(super) fn inclines(outcome: &mut Outcome) -> Result<()> {
    let cube = Vec3::splat(0.2);
    let below = incline(cube, 0.004, 0.97 * 0.3, 0.3)?;
    outcome.check("incline, cube at 0.97 of the friction: way from 0.1 s to 0.5 s, m", 0.0, below.way, 1e-5);
    let slope: f64 = 1.03 * 0.3;
    let above = incline(cube, 0.004, slope, 0.3)?;
    let exact = f64::from(GRAVITY) * (slope - 0.3) / slope.hypot(1.0);
    outcome.check("incline, cube at 1.03 of the friction: acceleration, m/s²", exact, above.acceleration, 0.01 * exact);
    let slope: f64 = 0.6;
    let steep = incline(cube, 0.004, slope, 0.3)?;
    let exact = f64::from(GRAVITY) * (slope - 0.3) / slope.hypot(1.0);
    outcome.check("incline, cube at twice the friction: acceleration, m/s²", exact, steep.acceleration, 0.005 * exact);
    let tall = Vec3::new(0.1, 0.2, 0.2);
    let stands = incline(tall, 5e-4, 0.97 * 0.5, 0.9)?;
    outcome.check("incline, tall box at 0.97 of w / h: tilt after 0.5 s, rad", 0.0, stands.tilt, 2e-3);
    let tips = incline(tall, 5e-4, 1.03 * 0.5, 0.9)?;
    outcome.check("incline, tall box at 1.03 of w / h: it tips (1: yes)", 1.0, f64::from(u8::from(tips.tilt > 0.02)), 0.0);
    Ok(())
}

/// The body that a part belongs to.
fn owner(scene: &Scene, part: Body) -> Option<RigidBodyId> {
    match part {
        Body::Sphere(id) => scene.body_of_sphere(id),
        Body::Rod(id) => scene.body_of_rod(id),
        _ => None,
    }
}

/// The sum of the normal forces on `to` from `from`, or from what is static, N.
fn normal_force(simulation: &mut Simulation, from: Option<RigidBodyId>, to: RigidBodyId) -> Result<DVec3> {
    let contacts = simulation.contacts()?;
    let scene = simulation.sync()?;
    let mut sum = DVec3::ZERO;
    for contact in contacts {
        let ContactAction::Force(force) = contact.action else { continue };
        let normal = contact.normal.as_dvec3() * force.as_dvec3().dot(contact.normal.as_dvec3());
        // The action is that on B.
        match (owner(scene, contact.a), owner(scene, contact.b)) {
            (a, Some(b)) if a == from && b == to => sum += normal,
            (Some(a), b) if a == to && b == from => sum -= normal,
            _ => {}
        }
    }
    Ok(sum)
}

/// Five cubes on a floor: the force at each level carries what is above it.
pub(super) fn stack(outcome: &mut Outcome) -> Result<()> {
    const STIFFNESS: f32 = 1e6;
    const EDGE: f32 = 0.2;
    let (mut scene, stuff) = stage(GRAVITY * Vec3::NEG_Y, Pair::default().restitution(0.2).friction(0.5).stiffness(STIFFNESS))?;
    floor(&mut scene, stuff)?;
    let shape = scene.add_shape(block(stuff, Vec3::splat(EDGE), 0.004))?;
    let ids = (0..5_u8)
        .map(|level| scene.add_body(Placement::new(shape).at([0.0, f64::from(EDGE) * (f64::from(level) + 0.5), 0.0])))
        .collect::<rockfall::Result<Vec<_>>>()?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let mass = DENSITY * EDGE.powi(3);
    run_for(&mut simulation, 2.0, step(mass, STIFFNESS, 16.0))?;
    let weight = f64::from(mass * GRAVITY);
    for (level, id) in ids.iter().enumerate() {
        let below = level.checked_sub(1).map(|below| ids[below]);
        let force = normal_force(&mut simulation, below, *id)?.y;
        let theory = weight * (ids.len() - level) as f64;
        outcome.check(format!("stack: force below box {}, N", level + 1), theory, force, 0.001 * theory);
    }
    let most = simulation.sync()?.bodies().iter().map(|body| f64::from(body.velocity.length())).fold(0.0, f64::max);
    outcome.check("stack: greatest velocity after 2 s, m/s", 0.0, most, 1e-4);
    Ok(())
}

/// Three boxes on a table. From the top, box k is displaced by the k-th of the `parts` of L / (2 k) against what is below it. Returns the
/// greatest tilt after 1 s, in rad, and the descent of the top box, in m.
fn overhanging(parts: [f64; 3]) -> Result<[f64; 2]> {
    const STIFFNESS: f32 = 1e6;
    let edges = Vec3::new(0.4, 0.1, 0.2);
    let (mut scene, stuff) = stage(GRAVITY * Vec3::NEG_Y, Pair::default().restitution(0.2).friction(0.5).stiffness(STIFFNESS))?;
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [0.0, 0.0, 5.0]).material(stuff))?;
    let shape = scene.add_shape(block(stuff, edges, 5e-4))?;
    let [length, height] = [f64::from(edges.x), f64::from(edges.y)];
    let mut x = -0.5 * length;
    for (level, k) in [3_u8, 2, 1].into_iter().enumerate() {
        x += parts[usize::from(k) - 1] * length / (2.0 * f64::from(k));
        scene.add_body(Placement::new(shape).at([x, height * (level as f64 + 0.5), 0.0]))?;
    }
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    run_for(&mut simulation, 1.0, step(DENSITY * edges.element_product(), STIFFNESS, 16.0))?;
    let bodies = bodies(&mut simulation)?;
    let descent = 2.5 * height - f64::from(bodies[2].position.y);
    Ok([bodies.iter().map(tilt).fold(0.0, f64::max), descent])
}

pub(super) fn overhang(outcome: &mut Outcome) -> Result<()> {
    let [tilt, _] = overhanging([0.98; 3])?;
    outcome.check("overhang at 0.98 of L / (2 k): greatest tilt after 1 s, rad", 0.0, tilt, 2e-3);
    let cases =
        [("at 1.04 of L / (2 k)", [1.04; 3]), ("at 0.98, 1.06, 0.94", [0.98, 1.06, 0.94]), ("at 0.98, 0.98, 1.08", [0.98, 0.98, 1.08])];
    for (name, parts) in cases {
        let [_, descent] = overhanging(parts)?;
        outcome.check(format!("overhang {name}: it falls (1: yes)"), 1.0, f64::from(u8::from(descent > 0.1)), 0.0);
    }
    Ok(())
}

/// Two cards of length 1 m that lean against each other: the descent of their centres after 1 s, in m, and the force between them over
/// the weight of one.
fn leaning(angle: f64, friction: f32) -> Result<[f64; 2]> {
    const STIFFNESS: f32 = 1e6;
    let edges = Vec3::new(THICKNESS as f32, 1.0, 0.5);
    let mass = DENSITY * edges.element_product();
    let (mut scene, stuff) = stage(GRAVITY * Vec3::NEG_Y, Pair::default().restitution(0.1).friction(friction).stiffness(STIFFNESS))?;
    floor(&mut scene, stuff)?;
    let shape = scene.add_shape(block(stuff, edges, ROUNDING as f32))?;
    // Each stands on the lower edge of its inner face and touches the other one with the upper edge of that face. The overlaps carry it.
    let weight = f64::from(mass * GRAVITY);
    let sunk = weight / f64::from(2.0 * STIFFNESS);
    let pressed = 0.5 * weight * angle.tan() / f64::from(4.0 * STIFFNESS);
    let mut ids = Vec::new();
    for side in [-1.0, 1.0] {
        let turn = DQuat::from_rotation_z(side * angle);
        let edge = |y: f64| turn * DVec3::new(-side * (0.5 * THICKNESS - ROUNDING), y * (0.5 - ROUNDING), 0.0);
        let centre = DVec3::new(side * (ROUNDING - 0.5 * pressed) - edge(1.0).x, ROUNDING - sunk - edge(-1.0).y, 0.0);
        let turn = Quat::from_rotation_z((side * angle) as f32);
        ids.push(scene.add_body(Placement::new(shape).at(centre).turned(turn))?);
    }
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let start = bodies(&mut simulation)?;
    run_for(&mut simulation, 1.0, step(mass, STIFFNESS, 16.0))?;
    let end = bodies(&mut simulation)?;
    let descent = f64::from(start[0].position.y - end[0].position.y);
    Ok([descent, normal_force(&mut simulation, Some(ids[0]), ids[1])?.length() / weight])
}

pub(super) fn cards(outcome: &mut Outcome) -> Result<()> {
    let angle = 25_f64.to_radians();
    let limit = 0.5 * angle.tan();
    let [stands, force] = leaning(angle, 1.1 * limit as f32)?;
    outcome.check("cards at 1.1 of tan θ / 2: descent in 1 s, m", 0.0, stands, 1e-4);
    // Moments about the contact with the floor, with thick cards and rounded edges.
    let [between, aside] = [1.0 - 2.0 * ROUNDING, 0.5 * THICKNESS - ROUNDING];
    let exact = (0.5 * between * angle.sin() - aside * angle.cos()) / (between * angle.cos() + ROUNDING);
    outcome.check("cards that stand: force between them over the weight of one", exact, force, 0.005 * exact);
    let [stands, _] = leaning(angle, 1.03 * exact as f32)?;
    outcome.check("cards at 1.03 of this ratio: descent in 1 s, m", 0.0, stands, 1e-4);
    for (name, friction) in [("0.9 of tan θ / 2", 0.9 * limit), ("0.97 of this ratio", 0.97 * exact)] {
        let [descent, _] = leaning(angle, friction as f32)?;
        outcome.check(format!("cards at {name}: they slip (1: yes)"), 1.0, f64::from(u8::from(descent > 0.1)), 0.0);
    }
    Ok(())
}
