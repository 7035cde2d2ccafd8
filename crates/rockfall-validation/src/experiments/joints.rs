//! Joints of hard contacts: a pendulum at every amplitude, a free chain over many frames, a motor, and a rope that breaks.

use std::f64::consts::{FRAC_PI_2, PI};

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{
    Anchor, ContactLaw, Cuboid, Integrator, Joint, Placement, RigidBody, RigidBodyId, Scene, Shape, Simulation, Sphere,
};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f64 = 9.81;
/// Time of a frame, s.
const FRAME: f32 = 1.0 / 60.0;

fn empty(gravity: f64, substeps: u32) -> Scene {
    let mut scene = with(|settings| (settings.contact_law, settings.gravity) = (ContactLaw::Rigid, gravity as f32));
    scene.run.substeps = Some(substeps);
    scene
}

/// A thin rod of mass 1 and length 1 along x with its centre at a place, turned by an angle about z.
fn add_rod(scene: &mut Scene, centre: DVec3, angle: f64) -> Result<RigidBodyId> {
    let (across, half) = (1.0 / 12.0, Vec3::new(0.5, 0.01, 0.01));
    // Rods of different groups pass through each other.
    let shape = Shape::new().group(scene.bodies().len() as u16).cuboid(Cuboid::between(-half, half));
    let shape = scene.add_shape(shape.mass_properties(1.0, Vec3::ZERO, [1e-4, across, across, 0.0, 0.0, 0.0]))?;
    Ok(scene.add_body(Placement::new(shape).centred_at(centre).turned(Quat::from_rotation_z(angle as f32)))?)
}

/// The arithmetic-geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

/// The period of a rod that hangs from a hinge and swings with an amplitude in rad, over that of small swings.
fn period(amplitude: f64, substeps: u32) -> Result<f64> {
    let mut scene = empty(GRAVITY, substeps);
    let angle = amplitude - FRAC_PI_2;
    let rod = add_rod(&mut scene, 0.5 * DVec3::new(angle.cos(), angle.sin(), 0.0), angle)?;
    scene.add_joint(Joint::hinge(Anchor::World, rod, [0.0; 3], [0.0, 0.0, 1.0]))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    // The rod is below the hinge where its centre passes x = 0. An angle of more than half a turn would wrap.
    let (mut before, mut crossings) = (0.5 * amplitude.sin(), Vec::new());
    for frame in 1..4_000_u32 {
        simulation.run(1, FRAME)?;
        let now = simulation.sync()?.bodies()[0].centre()[0];
        if before * now <= 0.0 {
            crossings.push(f64::from(FRAME) * (f64::from(frame) - 1.0 + before / (before - now)));
        }
        before = now;
        if crossings.len() == 7 {
            break;
        }
    }
    let [first, .., last] = crossings[..] else { return Err("the pendulum does not swing".into()) };
    // Small swings of a rod: the reduced length is 2/3.
    let small = 2.0 * PI * (2.0 / 3.0 / GRAVITY).sqrt();
    Ok((last - first) / 3.0 / small)
}

fn pendulum(outcome: &mut Outcome) -> Result<()> {
    let exact = |degrees: f64| 1.0 / agm(1.0, (0.5 * degrees.to_radians()).cos());
    let [across, up] = ["amplitude, degrees", "period / that of small swings"].map(Axis::linear);
    let mut chart = Chart::new("joints-pendulum", "A rod on a hinge", across, up)
        .add(0, Mark::Line, "theory", curve(5.0, 172.0, 200, exact));
    for (colour, substeps, bound) in [(1, 4, 0.06), (2, 16, 0.004)] {
        let mut measured = Vec::new();
        for degrees in [10.0_f64, 45.0, 90.0, 120.0, 150.0, 170.0] {
            let found = period(degrees.to_radians(), substeps)?;
            measured.push((degrees, found));
            let what = format!("rod, {degrees}°, {substeps} substeps: relative period");
            outcome.check(what, exact(degrees), found, bound * exact(degrees));
        }
        chart = chart.add(colour, Mark::Points, format!("{substeps} substeps"), measured);
    }
    outcome.charts.push(chart);
    Ok(())
}

/// Mass times velocity, and the angular momentum about the origin.
fn momenta(simulation: &mut Simulation) -> Result<[DVec3; 2]> {
    let mut sums = [DVec3::ZERO; 2];
    for body in simulation.sync()?.bodies() {
        let velocity = body.velocity.as_dvec3();
        sums[0] += velocity;
        sums[1] += DVec3::from_array(body.centre()).cross(velocity) + body.angular_momentum.as_dvec3();
    }
    Ok(sums)
}

/// A chain of 8 rods with ball joints that turns and folds freely.
fn chain(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    const RODS: u32 = 8;
    let mut scene = empty(0.0, 8);
    let mut last: Option<RigidBodyId> = None;
    for number in 0..RODS {
        let x = f64::from(number) - 0.5 * f64::from(RODS - 1);
        let rod = add_rod(&mut scene, DVec3::new(x, 0.0, 0.0), 0.0)?;
        let speed = Vec3::new(0.0, (1.1 * x) as f32, (0.4 * (1.3 * x).sin()) as f32);
        let change = |body: &mut RigidBody| {
            (body.velocity, body.angular_momentum) = (speed, Vec3::new(0.0, 0.0, 1.1 / 12.0));
        };
        scene.update_body(rod, change)?;
        if let Some(before) = last.replace(rod) {
            scene.add_joint(Joint::ball(before, rod, [x - 0.5, 0.0, 0.0]))?;
        }
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(1, FRAME)?;
    let (start, [momentum, turning]) = (simulation.energy()?.kinetic, momenta(&mut simulation)?);
    let frames = effort.pick(5_000_u64, 100_000);
    let (mut energies, mut most) = (Vec::new(), 0.0_f64);
    for part in 1..=100 {
        simulation.run(frames / 100, FRAME)?;
        let share = simulation.energy()?.kinetic / start;
        most = most.max(share);
        energies.push((f64::from(FRAME) * (part * frames / 100) as f64, share));
    }
    let [last_momentum, last_turning] = momenta(&mut simulation)?;
    let minutes = f64::from(FRAME) * frames as f64 / 60.0;
    outcome.fact("minutes", minutes.round());
    outcome.check("free chain of 8 rods: greatest energy / that after a frame", 1.0, most.max(1.0), effort.pick(1e-3, 1e-2));
    outcome.check("free chain of 8 rods: momentum change, kg m/s", 0.0, (last_momentum - momentum).length(), 1e-3);
    let change = (last_turning - turning).length() / turning.length();
    outcome.check("free chain of 8 rods: relative angular momentum change", 0.0, change, effort.pick(1e-3, 1e-2));
    let error = simulation.joints()?.iter().map(|joint| f64::from(joint.error)).fold(0.0, f64::max);
    outcome.check("free chain of 8 rods: greatest gap of a joint at the end, m", 0.0, error, 5e-3);
    outcome.charts.push(
        Chart::new("joints-chain", "Energy of a free chain", Axis::linear("time, s"), Axis::linear("energy / that at the start"))
            .add(0, Mark::Line, "8 rods", energies),
    );
    Ok(())
}

/// A wheel of the moment of inertia 1 that a motor of 2 N m turns up to 5 rad/s.
fn motor(outcome: &mut Outcome) -> Result<()> {
    let mut scene = empty(0.0, 8);
    let shape = Shape::new().sphere([0.0; 3], 0.5).mass_properties(1.0, Vec3::ZERO, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let shape = scene.add_shape(shape)?;
    let wheel = scene.add_body(Placement::new(shape))?;
    scene.add_joint(Joint::hinge(Anchor::World, wheel, [0.0; 3], [0.0, 0.0, 1.0]).motor(5.0).max_force(2.0))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(60, FRAME)?;
    let reading = &simulation.joints()?[0];
    outcome.check("motor of 2 N m on a wheel of 1 kg m²: speed after 1 s, rad/s", 2.0, reading.speed.into(), 1e-3);
    outcome.check("motor of 2 N m on a wheel of 1 kg m²: angle after 1 s, rad", 1.0, reading.position.into(), 5e-3);
    simulation.run(120, FRAME)?;
    outcome.check("motor of 2 N m for 5 rad/s: speed after 3 s, rad/s", 5.0, simulation.joints()?[0].speed.into(), 1e-3);
    Ok(())
}

/// Whether a joint that bears 100 N lets go of a ball of this weight, N, that hangs from it for 2 s.
fn breaks(weight: f64) -> Result<bool> {
    let mut scene = empty(GRAVITY, 8);
    let mass = (weight / GRAVITY) as f32;
    let ball = scene.add_sphere(Sphere::new([0.0; 3], 0.1).mass(mass))?;
    scene.add_joint(Joint::ball(Anchor::World, ball, [0.0, 1.0, 0.0]).breaks_at(100.0, f32::INFINITY))?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    simulation.run(120, FRAME)?;
    Ok(simulation.joints()?[0].broken)
}

fn strength(outcome: &mut Outcome) -> Result<()> {
    for (weight, expected) in [(99.5, 0.0), (100.5, 1.0)] {
        let found = f64::from(u8::from(breaks(weight)?));
        outcome.check(format!("joint that bears 100 N under {weight} N: breaks"), expected, found, 0.0);
    }
    Ok(())
}

/// Runs the experiment.
pub(super) fn run(effort: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        pendulum(&mut outcome)?;
        chain(&mut outcome, effort)?;
        motor(&mut outcome)?;
        strength(&mut outcome)?;
        Ok(outcome)
    })
}
