//! Hard contacts: boxes on slopes, balls that bounce, stacks, and heavy boxes on light ones. The modules have the problems of section
//! 11.11 that these leave open.

mod flight;
mod impacts;
mod sliding;
mod standing;

use std::f64::consts::{PI, TAU};

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{ContactLaw, Cuboid, Integrator, Placement, RigidBody, Scene, Shape, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f64 = 9.81;
/// Time of a frame, s.
const FRAME: f32 = 1.0 / 60.0;

/// A scene with hard contacts. The field is turned as on a slope along x.
fn empty(slope: f64, friction: f32, restitution: f32) -> Scene {
    let down = DVec3::new(slope, -1.0, 0.0).normalize();
    with(|settings| {
        settings.contact_law = ContactLaw::Rigid;
        (settings.coulomb_friction, settings.restitution) = (friction, restitution);
        (settings.gravity, settings.gravity_direction) = (GRAVITY as f32, down.as_vec3());
    })
}

/// The same with a floor, whose surface is the plane y = 0.
fn ground(slope: f64, friction: f32, restitution: f32) -> Result<Scene> {
    let mut scene = empty(slope, friction, restitution);
    scene.add_box(Cuboid::between([-50.0, -1.0, -50.0], [50.0, 0.0, 50.0]))?;
    Ok(scene)
}

/// Adds a box with these edges and this mass at a height of its centre.
fn add_box(scene: &mut Scene, edges: Vec3, mass: f64, height: f64) -> Result<()> {
    let shape = Shape::new().mass(mass as f32).cuboid(Cuboid::between(-0.5 * edges, 0.5 * edges));
    add(scene, shape, |place| place.at([0.0, height, 0.0]))
}

/// Adds a body of a shape.
fn add(scene: &mut Scene, shape: Shape, place: impl FnOnce(Placement) -> Placement) -> Result<()> {
    let shape = scene.add_shape(shape)?;
    scene.add_body(place(Placement::new(shape)))?;
    Ok(())
}

fn frames(simulation: &mut Simulation, seconds: f32) -> Result<()> {
    simulation.run((seconds / FRAME).round() as u64, FRAME)?;
    Ok(())
}

fn bodies(simulation: &mut Simulation) -> Result<Vec<RigidBody>> {
    Ok(simulation.sync()?.bodies().to_vec())
}

/// The acceleration of a cube on a slope from 1 s to 3 s, m/s².
fn acceleration(slope: f64, friction: f32) -> Result<f64> {
    let mut scene = ground(slope, friction, 0.0)?;
    add_box(&mut scene, Vec3::ONE, 1.0, 0.5)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 1.0)?;
    let before = bodies(&mut simulation)?[0].velocity.x;
    frames(&mut simulation, 2.0)?;
    Ok(f64::from(bodies(&mut simulation)?[0].velocity.x - before) / 2.0)
}

/// Coulomb's law on slopes.
fn slopes(outcome: &mut Outcome) -> Result<()> {
    const FRICTION: f64 = 0.5;
    let exact = |slope: f64| (GRAVITY * (slope - FRICTION) / slope.hypot(1.0)).max(0.0);
    let mut measured = Vec::new();
    for k in 0..=12 {
        let slope = 0.2 + 0.05 * f64::from(k) + 0.01;
        let found = acceleration(slope, FRICTION as f32)?;
        measured.push((slope, found));
        let bound = (1e-3 * exact(slope)).max(1e-5);
        outcome.check(format!("slope {slope:.2}: acceleration, m/s²"), exact(slope), found, bound);
    }
    outcome.charts.push(
        Chart::new("hard-slopes", "A cube on slopes", Axis::linear("tan of the slope"), Axis::linear("acceleration, m/s²"))
            .add(0, Mark::Line, "Coulomb", curve(0.2, 0.85, 130, exact))
            .add(0, Mark::Points, "measured", measured),
    );
    Ok(())
}

/// Whether a box of 1 by 3 by 1 m falls over on a slope that grows for a second from 0.3.
fn tips(slope: f64) -> Result<bool> {
    let mut scene = ground(0.3, 1.0, 0.0)?;
    add_box(&mut scene, Vec3::new(1.0, 3.0, 1.0), 1.0, 1.5)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 1.0)?;
    for part in 1..=60 {
        let now = 0.3 + (slope - 0.3) * f64::from(part) / 60.0;
        let mut settings = simulation.scene().settings;
        settings.gravity_direction = DVec3::new(now, -1.0, 0.0).normalize().as_vec3();
        simulation.set_settings(settings)?;
        simulation.run(1, FRAME)?;
    }
    frames(&mut simulation, 10.0)?;
    Ok((bodies(&mut simulation)?[0].orientation * Vec3::Y).y < 0.9)
}

/// The speed of a ball after it has fallen on the floor, over that before.
fn rebound(restitution: f32) -> Result<f64> {
    let mut scene = ground(0.0, 0.5, restitution)?;
    scene.add_sphere(Sphere::new([0.0, 1.5, 0.0], 0.5).velocity([0.0, -4.0, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let mut ball = simulation.spheres()?[0];
    for _ in 0..30 {
        simulation.run(1, FRAME)?;
        ball = simulation.spheres()?[0];
        if ball.velocity.y > 0.0 {
            break;
        }
    }
    // Energy gives both speeds at the floor.
    let at_floor = |speed: f64, height: f64| (speed * speed + 2.0 * GRAVITY * (height - 0.5)).max(0.0).sqrt();
    Ok(at_floor(ball.velocity.y.into(), ball.position.y.into()) / at_floor(4.0, 1.5))
}

fn rebounds(outcome: &mut Outcome) -> Result<()> {
    let mut measured = Vec::new();
    for tenths in 0..=10_u8 {
        let e = f64::from(tenths) / 10.0;
        let found = rebound(e as f32)?;
        measured.push((e, found));
        outcome.check(format!("rebound, e = {e}: speed, after / before"), e, found, 2e-3);
    }
    outcome.charts.push(
        Chart::new("hard-rebound", "A ball bounces", Axis::linear("restitution"), Axis::linear("speed after / before"))
            .add(0, Mark::Line, "theory", vec![(0.0, 0.0), (1.0, 1.0)])
            .add(0, Mark::Points, "measured", measured),
    );
    Ok(())
}

/// The square of the frequency of contacts in a substep of h, 1/s²: f h = 0.18.
fn frequency_squared(h: f64) -> f64 {
    (TAU * 0.18 / h).powi(2)
}

/// A stack of ten cubes sinks as springs do, and stands.
fn stack(outcome: &mut Outcome) -> Result<()> {
    const CUBES: u32 = 10;
    let mut scene = ground(0.0, 0.5, 0.0)?;
    for level in 0..CUBES {
        add_box(&mut scene, Vec3::ONE, 1.0, f64::from(level) + 0.5)?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 5.0)?;
    let h = f64::from(FRAME) / f64::from(simulation.substeps().unwrap_or(1));
    let top = bodies(&mut simulation)?[CUBES as usize - 1].clone();
    // K = 8 / m at the corners of two equal cubes, with four points.
    let count = f64::from(CUBES);
    let sink = 0.5 * count * (count - 1.0) * GRAVITY / frequency_squared(h) * 8.0 / 4.0;
    outcome.check("stack of ten cubes: sink of the top one, m", sink, count - 0.5 - f64::from(top.position.y), 0.08 * sink);
    outcome.check("stack of ten cubes: sideways motion of the top one in 5 s, m", 0.0, top.position.x.hypot(top.position.z).into(), 5e-4);
    frames(&mut simulation, 5.0)?;
    let fastest = bodies(&mut simulation)?.iter().map(|body| f64::from(body.velocity.length())).fold(0.0, f64::max);
    outcome.check("stack of ten cubes: greatest speed after 10 s, m/s", 0.0, fastest, 1e-3);
    Ok(())
}

/// The greatest speed of a cube that rests on one of mass 1 from 5 s to 6 s, m/s.
fn sway(mass: f64) -> Result<f64> {
    let mut scene = ground(0.0, 0.5, 0.0)?;
    add_box(&mut scene, Vec3::ONE, 1.0, 0.5)?;
    add_box(&mut scene, Vec3::ONE, mass, 1.5)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 5.0)?;
    let mut fastest = 0.0_f64;
    for _ in 0..60 {
        simulation.run(1, FRAME)?;
        fastest = fastest.max(bodies(&mut simulation)?[1].velocity.length().into());
    }
    Ok(fastest)
}

fn heavy_on_light(outcome: &mut Outcome) -> Result<()> {
    for mass in [1.0, 3.0, 10.0, 30.0, 100.0] {
        let found = sway(mass)?;
        outcome.check(format!("mass {mass} on 1: greatest speed after 5 s, m/s"), 0.0, found, 2e-2);
    }
    Ok(())
}

/// The greatest change of the energy of an elastic box that tumbles between its impacts on a floor, over that at the start.
fn tumbling(outcome: &mut Outcome) -> Result<()> {
    let mut scene = ground(0.0, 0.0, 1.0)?;
    let edges = Vec3::new(1.0, 0.6, 0.4);
    let shape = Shape::new().mass(1.0).cuboid(Cuboid::between(-0.5 * edges, 0.5 * edges));
    let turn = Quat::from_scaled_axis(Vec3::new(0.3, 0.5, PI as f32 / 5.0));
    add(&mut scene, shape, |place| place.at([0.0, 2.0, 0.0]).turned(turn))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let start = simulation.energy()?;
    let total = |energy: &rockfall::Energy| energy.kinetic + energy.potential;
    let mut worst = 0.0_f64;
    for _ in 0..600 {
        simulation.run(1, FRAME)?;
        worst = worst.max((total(&simulation.energy()?) - total(&start)).abs());
    }
    let change = worst / (2.0 * GRAVITY);
    outcome.check("elastic box that tumbles for 10 s: greatest change of the energy / that of the fall", 0.0, change, 1e-3);
    Ok(())
}

/// Problems of section 11.11, in the order of their numbers as far as possible.
fn problems(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    flight::fall(outcome)?;
    impacts::bounces(outcome)?;
    impacts::rod(outcome)?;
    impacts::gas(outcome, effort)?;
    impacts::cradles(outcome)?;
    impacts::eccentric(outcome)?;
    sliding::ball(outcome)?;
    sliding::thrown(outcome)?;
    sliding::spun(outcome)?;
    sliding::belt(outcome)?;
    standing::overlaps(outcome, effort)?;
    standing::pyramid(outcome, effort)?;
    standing::wall(outcome, effort)?;
    standing::ratios(outcome)?;
    standing::dropped(outcome)?;
    sliding::card(outcome)?;
    standing::overhangs(outcome)?;
    standing::dominoes(outcome)?;
    flight::flips(outcome, effort)?;
    sliding::seams(outcome)?;
    impacts::fast(outcome)?;
    impacts::oblique(outcome, effort)?;
    impacts::billiards(outcome)?;
    standing::hub(outcome)?;
    standing::frames_of_other_lengths(outcome)
}

/// Runs the experiment.
pub(super) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        slopes(&mut outcome)?;
        for (slope, falls) in [(0.331, 0.0), (0.336, 1.0)] {
            let found = f64::from(u8::from(tips(slope)?));
            outcome.check(format!("box of 1 by 3 by 1 on a slope of {slope}: falls"), falls, found, 0.0);
        }
        rebounds(&mut outcome)?;
        stack(&mut outcome)?;
        heavy_on_light(&mut outcome)?;
        tumbling(&mut outcome)?;
        problems(&mut outcome, effort)?;
        Ok(outcome)
    })
}
