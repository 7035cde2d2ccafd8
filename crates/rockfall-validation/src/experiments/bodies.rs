//! Rigid bodies: free rotation, an impact of a rod, rolling, a tripod that slides or tips, a block that rocks, and a gas of dimers.

use std::f64::consts::{FRAC_PI_4, PI};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{
    ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Placement, RigidBody, Scene, Shape, Simulation,
};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{on_cpu, on_one_thread, with};
use crate::{Effort, Outcome, Result};

const GRAVITY: f32 = 9.81;

fn body(simulation: &mut Simulation) -> Result<RigidBody> {
    Ok(simulation.sync()?.bodies()[0].clone())
}

/// A free body with these moments about the axes of its shape.
fn free(moments: [f32; 3], momentum: Vec3, turn: Quat) -> Result<Simulation> {
    let (mut scene, stuff) = on_floor(ContactLaw::Linear, Vec3::ZERO, Pair::default())?;
    let [x, y, z] = moments;
    let shape = Shape::new().material(stuff).sphere([0.3, 0.0, 0.0], 0.1).mass_properties(1.0, [0.0; 3], [x, y, z, 0.0, 0.0, 0.0]);
    let shape = scene.add_shape(shape)?;
    scene.add_body(Placement::new(shape).at([0.0, 2.0, 0.0]).turned(turn).angular_momentum(momentum))?;
    on_cpu(scene, Integrator::VelocityVerlet)
}

/// The complete elliptic integral of the first kind, by the arithmetic-geometric mean.
fn elliptic(m: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - m).sqrt());
    while (a - b).abs() > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (2.0 * a)
}

/// Times at which the angular momentum along the axis 2 of a body with the moments 1, 2 and 3 changes its sign.
fn crossings(momentum: Vec3, step: f32, time: f64) -> Result<Vec<f64>> {
    let mut simulation = free([1.0, 2.0, 3.0], momentum, Quat::IDENTITY)?;
    let along = |body: &RigidBody| f64::from((body.orientation * Vec3::Y).dot(body.angular_momentum));
    let (mut found, mut before) = (Vec::new(), along(&body(&mut simulation)?));
    for number in 1..=(time / f64::from(step)) as u32 {
        simulation.run(1, step)?;
        let now = along(&body(&mut simulation)?);
        if now * before < 0.0 {
            found.push(f64::from(step) * (f64::from(number) - now / (now - before)));
        }
        before = now;
    }
    Ok(found)
}

fn tops(outcome: &mut Outcome) -> Result<()> {
    // Symmetric: the axis turns about L at the rate L / J_1.
    let momentum = Vec3::new(0.0, 2.0, 0.0);
    let turn = Quat::from_rotation_z(0.7);
    let mut simulation = free([2.0, 0.7, 2.0], momentum, turn)?;
    simulation.run(4_000, 0.01)?;
    let axis = (body(&mut simulation)?.orientation * Vec3::Y).as_dvec3();
    let start = (turn * Vec3::Y).as_dvec3();
    let around = |v: DVec3| v.z.atan2(v.x);
    let turned = -(around(axis) - around(start));
    let off = (turned - 40.0 * 2.0 / 2.0).rem_euclid(2.0 * PI);
    outcome.check("symmetric top: error of its precession after 40 rad, rad", 0.0, off.min(2.0 * PI - off), 2e-3);
    outcome.check("symmetric top: inclination of its axis, rad", 0.7, axis.y.acos(), 1e-4);

    // Asymmetric: half a period between two changes of sign.
    let momentum = Vec3::new(0.5, 1.0, 2.5);
    let [squared, energy] = [
        f64::from(momentum.length_squared()),
        0.5 * (0.25 + 1.0 / 2.0 + 2.5 * 2.5 / 3.0),
    ];
    let rate = ((squared - 2.0 * energy) / 6.0).sqrt();
    let m = (6.0 * energy - squared) / (squared - 2.0 * energy);
    let half = 2.0 * elliptic(m) / rate;
    let of = |step: f32| -> Result<f64> {
        let found = crossings(momentum, step, 60.0)?;
        Ok((found[found.len() - 1] - found[0]) / (found.len() - 1) as f64)
    };
    let measured = of(0.02)?;
    outcome.check("asymmetric top: half a period, s", half, measured, 1e-3 * half);
    let errors = [0.2_f32, 0.1].map(|step| of(step).map(|measured| (measured - half).abs()));
    let [coarse, fine] = errors;
    outcome.check("asymmetric top: error of the period, h = 0.2 / h = 0.1", 4.0, coarse? / fine?, 0.4);

    let flips = crossings(Vec3::new(0.01, 2.0, 0.0), 0.02, 12.0)?;
    outcome.check("flip: first, ω = (0.01, 1, 0), s", 10.3773, flips[0], 0.02);
    // The axes 1 and 3 change places in the formula, because L² < 2 E J_2.
    let [squared, energy] = [4.01, 1.005];
    let (rate, m) = (((6.0 * energy - squared) / 6.0_f64).sqrt(), (squared - 2.0 * energy) / (6.0 * energy - squared));
    let half = 2.0 * elliptic(m) / rate;
    let flips = crossings(Vec3::new(0.1, 2.0, 0.0), 0.02, 120.0)?;
    let measured = (flips[flips.len() - 1] - flips[0]) / (flips.len() - 1) as f64;
    outcome.check("flip: time to the next, ω = (0.1, 1, 0), s", half, measured, 2e-3 * half);
    let mut simulation = free([1.0, 2.0, 3.0], Vec3::new(0.01, 2.0, 0.0), Quat::IDENTITY)?;
    let first = simulation.energy()?.kinetic;
    let (mut along, mut worst) = (Vec::new(), 0.0_f64);
    for sample in 0..1_200_u32 {
        simulation.run(20, 0.05)?;
        worst = worst.max((simulation.energy()?.kinetic / first - 1.0).abs());
        if sample < 120 {
            let body = body(&mut simulation)?;
            let time = f64::from(sample + 1);
            along.push((time, f64::from((body.orientation * Vec3::Y).dot(body.angular_momentum)) / 2.0));
        }
    }
    outcome.check("flip: greatest change of the energy in 24,000 steps, part", 0.0, worst, 1e-4);
    outcome.charts.push(
        Chart::new("bodies-flip", "A body that turns about its middle axis flips", Axis::linear("time, s"), Axis::linear("spin about the axis"))
            .add(1, Mark::Line, "J = 1, 2, 3", along),
    );
    Ok(())
}

/// A scene with a floor of one material.
fn on_floor(law: ContactLaw, gravity: Vec3, pair: Pair) -> Result<(Scene, MaterialId)> {
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions) = (law, false);
        (settings.gravity, settings.gravity_direction) = (gravity.length(), gravity.normalize_or(Vec3::NEG_Y));
    });
    let stuff = scene.add_material(Material::new("stuff").density(1_000.0).young(1e8).poisson(0.3))?;
    scene.set_pair(stuff, stuff, pair.characteristic_velocity(1.0))?;
    scene.add_box(Cuboid::between([-20.0, -1.0, -20.0], [20.0, 0.0, 20.0]).material(stuff))?;
    Ok((scene, stuff))
}

/// A slender rod of length and mass 1 hits a smooth floor at 45 degrees with the speed 1 and e = 0.8.
fn rod(outcome: &mut Outcome) -> Result<()> {
    const RADIUS: f32 = 0.01;
    let (mut scene, stuff) = on_floor(ContactLaw::Linear, Vec3::ZERO, Pair::default().restitution(0.8).friction(0.0))?;
    let across = 1.0 / 12.0;
    let shape = Shape::new().material(stuff).sphere([-0.5, 0.0, 0.0], RADIUS).sphere([0.5, 0.0, 0.0], RADIUS);
    let shape = scene.add_shape(shape.mass_properties(1.0, [0.0; 3], [1e-4, across, across, 0.0, 0.0, 0.0]))?;
    let height = 0.5 * FRAC_PI_4.sin() + f64::from(RADIUS) + 1e-5;
    let placed = Placement::new(shape).at([0.0, height, 0.0]).turned(Quat::from_rotation_z(-FRAC_PI_4 as f32));
    scene.add_body(placed.velocity([0.0, -1.0, 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let mut has_met = false;
    for _ in 0..2_000 {
        simulation.run(5, 2e-6)?;
        let touches = simulation.energy()?.contact > 0.0;
        if has_met && !touches {
            break;
        }
        has_met |= touches;
    }
    let after = body(&mut simulation)?;
    let impulse = 1.8 / (1.0 + 3.0 * 0.5);
    outcome.check("rod at 45°: velocity of its centre, after / before", 1.0 - impulse, -f64::from(after.velocity.y), 0.01);
    let spin = f64::from(after.angular_momentum.z) / f64::from(across);
    outcome.check("rod at 45°: spin after the impact, rad/s", 3.0547, spin.abs(), 0.02);
    Ok(())
}

/// Balls with the inertia of a sphere, a cylinder and a hoop roll down a slope of 20 degrees.
fn rolling(outcome: &mut Outcome) -> Result<()> {
    const RADIUS: f32 = 0.1;
    let angle = 20_f32.to_radians();
    for (name, part) in [("sphere", 0.4), ("cylinder", 0.5), ("hoop", 1.0)] {
        let gravity = GRAVITY * Vec3::new(angle.sin(), -angle.cos(), 0.0);
        let (mut scene, stuff) = on_floor(ContactLaw::HertzMindlin, gravity, Pair::default().restitution(0.2).friction(0.8))?;
        let inertia = part * RADIUS * RADIUS;
        let shape = Shape::new().material(stuff).sphere([0.0; 3], RADIUS);
        let shape = scene.add_shape(shape.mass_properties(1.0, [0.0; 3], [inertia, inertia, inertia, 0.0, 0.0, 0.0]))?;
        scene.add_body(Placement::new(shape).at([0.0, f64::from(RADIUS), 0.0]))?;
        let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
        simulation.run(4_000, 1e-4)?;
        let before = f64::from(body(&mut simulation)?.velocity.x);
        simulation.run(6_000, 1e-4)?;
        let measured = (f64::from(body(&mut simulation)?.velocity.x) - before) / 0.6 / (f64::from(GRAVITY) * f64::from(angle).sin());
        outcome.check(format!("rolling, {name}: acceleration over g sin a"), 1.0 / (1.0 + f64::from(part)), measured, 2e-3);
    }
    Ok(())
}

/// A body on three feet, whose centre is 0.3 above them, on a slope that rises by `angle`. Two feet are 0.1 below the centre along the
/// slope. Returns how far it slid, and the angle by which it tipped, in 0.4 s.
fn tripod(angle: f64, friction: f32) -> Result<[f64; 2]> {
    const FOOT: f32 = 0.01;
    let down = GRAVITY * Vec3::new(angle.sin() as f32, -angle.cos() as f32, 0.0);
    let (mut scene, stuff) = on_floor(ContactLaw::HertzMindlin, down, Pair::default().restitution(0.1).friction(friction))?;
    let shape = Shape::new().material(stuff).sphere([0.1, 0.0, 0.1], FOOT).sphere([0.1, 0.0, -0.1], FOOT).sphere([-0.1, 0.0, 0.0], FOOT);
    let height = 0.3 - FOOT;
    let shape = scene.add_shape(shape.mass_properties(1.0, [0.0, height, 0.0], [0.02, 0.02, 0.02, 0.0, 0.0, 0.0]))?;
    scene.add_body(Placement::new(shape).at([0.0, f64::from(FOOT), 0.0]))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    simulation.run(20_000, 2e-5)?;
    let body = body(&mut simulation)?;
    let tilt = f64::from((body.orientation * Vec3::Y).y).clamp(-1.0, 1.0).acos();
    let feet = body.position - body.orientation * Vec3::new(0.0, height, 0.0);
    Ok([f64::from(feet.x), tilt])
}

fn slopes(outcome: &mut Outcome) -> Result<()> {
    // It slides where tan a exceeds the friction, and tips where tan a exceeds 0.1 / 0.3.
    let slide = |factor: f64| tripod((0.2 * factor).atan(), 0.2);
    outcome.check("tripod at 0.97 of the friction: way, m", 0.0, slide(0.97)?[0], 2e-4);
    let above = (0.2_f64 * 1.2).atan();
    let way = 0.5 * f64::from(GRAVITY) * (above.sin() - 0.2 * above.cos()) * 0.16;
    outcome.check("tripod at 1.2 of the friction: way in 0.4 s, m", way, slide(1.2)?[0], 0.05 * way);
    let tip = |factor: f64| tripod((factor / 3.0).atan(), 1.0);
    outcome.check("tripod at 0.97 of the tipping slope: tilt, rad", 0.0, tip(0.97)?[1], 2e-3);
    let tilt = tip(1.05)?[1];
    outcome.check("tripod at 1.05 of it: tips", 1.0, f64::from(u8::from(tilt > 0.02)), 0.0);
    Ok(())
}

/// A block of 1 m by 4 m on four feet is let go at half of the angle at which it would tip over: the time until it is upright.
fn block(outcome: &mut Outcome) -> Result<()> {
    const FOOT: f32 = 0.02;
    let (mut scene, stuff) = on_floor(ContactLaw::HertzMindlin, GRAVITY * Vec3::NEG_Y, Pair::default().restitution(0.1).friction(1.0))?;
    let alpha = (0.25_f64).atan();
    let (half, mass) = ([0.5_f32, 2.0, 0.5], 100.0_f32);
    let inertia = |a: f32, b: f32| mass / 3.0 * (a * a + b * b);
    let moments = [inertia(half[1], half[2]), inertia(half[0], half[2]), inertia(half[0], half[1]), 0.0, 0.0, 0.0];
    let foot = |x: f32, z: f32| [x * half[0], FOOT - half[1], z * half[2]];
    let feet = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let shape = feet.into_iter().fold(Shape::new().material(stuff), |shape, (x, z)| shape.sphere(foot(x, z), FOOT));
    let shape = scene.add_shape(shape.mass_properties(mass, [0.0; 3], moments))?;
    let start = 0.5 * alpha;
    // It stands on the feet at +x. The centre of a foot is the axis about which it turns.
    let lever = DVec3::new(-0.5, f64::from(2.0 - FOOT), 0.0);
    let turned = rockfall::glam::DQuat::from_rotation_z(-start) * lever;
    scene.add_body(Placement::new(shape).at([0.5 + turned.x, f64::from(FOOT) + turned.y, 0.0]).turned(Quat::from_rotation_z(-start as f32)))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let tilt = |body: &RigidBody| -f64::from((body.orientation * Vec3::X).y).atan2(f64::from((body.orientation * Vec3::X).x));
    let (step, mut time) = (1e-4_f32, 0.0);
    let mut measured = Vec::new();
    while tilt(&body(&mut simulation)?) > 1e-3 && time < 3.0 {
        simulation.run(20, step)?;
        time += 20.0 * f64::from(step);
        measured.push((time, tilt(&body(&mut simulation)?)));
    }
    // θ'' = -p² sin(α - θ) about the centre of a foot, integrated with small steps.
    let radius = lever.length();
    let about = f64::from(moments[2]) + f64::from(mass) * radius * radius;
    let (alpha, p2) = ((-lever.x / lever.y).atan(), f64::from(mass) * f64::from(GRAVITY) * radius / about);
    let (mut angle, mut speed, mut theory) = (start, 0.0, 0.0);
    let mut curve = vec![(0.0, angle)];
    while angle > 1e-3 {
        speed -= 1e-5 * p2 * (alpha - angle).sin();
        angle += 1e-5 * speed;
        theory += 1e-5;
        curve.push((theory, angle));
    }
    outcome.check("rocking block: time until it is upright, s", theory, time, 0.01 * theory);
    let sparse = curve.into_iter().step_by(2_000).collect();
    outcome.charts.push(
        Chart::new("bodies-block", "A block rocks back", Axis::linear("time, s"), Axis::linear("angle, rad"))
            .add(0, Mark::Line, "theory", sparse)
            .add(1, Mark::Points, "measured", measured.into_iter().step_by(15).collect()),
    );
    Ok(())
}

/// A gas of smooth elastic dimers in a periodic box, all of whose energy is in the translation at first.
fn gas(outcome: &mut Outcome) -> Result<()> {
    const ALONG: usize = 5;
    const SPACING: f32 = 0.42;
    const STEP: f32 = 4e-4;
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let mut scene = with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (ContactLaw::HertzMindlin, false, 0.0);
    });
    let stuff = scene.add_material(Material::new("stuff").density(1_000.0).young(1e6).poisson(0.3))?;
    scene.set_pair(stuff, stuff, Pair::default().restitution(1.0).friction(0.0))?;
    (0..3).try_for_each(|axis| scene.set_periodic(axis, Some([0.0, SPACING * ALONG as f32])))?;
    let shape = Shape::new().material(stuff).density(1_000.0).sphere([-0.08, 0.0, 0.0], 0.12).sphere([0.08, 0.0, 0.0], 0.12);
    let shape = scene.add_shape(shape)?;
    for index in 0..ALONG.pow(3) {
        let place = [index % ALONG, index / ALONG % ALONG, index / (ALONG * ALONG)].map(|place| f64::from(SPACING) * (place as f64 + 0.5));
        let mut vector = || Vec3::from_array(std::array::from_fn(|_| random.random_range(-1.0..1.0_f32)));
        let (velocity, turn) = (vector().normalize_or(Vec3::X), Quat::from_scaled_axis(2.0 * vector()));
        scene.add_body(Placement::new(shape).at(place).turned(turn).velocity(velocity))?;
    }
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let first = simulation.energy()?;
    simulation.run(30_000, STEP)?;
    let (mut ratio, samples) = (0.0, 100_u32);
    for _ in 0..samples {
        simulation.run(1_000, STEP)?;
        let total = simulation.energy()?.kinetic;
        let scene = simulation.sync()?;
        let mass = scene.spheres().iter().map(|sphere| f64::from(sphere.mass)).sum::<f64>() / ALONG.pow(3) as f64;
        let moving: f64 = scene.bodies().iter().map(|body| 0.5 * mass * body.velocity.as_dvec3().length_squared()).sum();
        // Three degrees of freedom of the translation against two of the rotation: impacts do not turn a dimer about its axis.
        ratio += (total - moving) / 2.0 / (moving / 3.0) / f64::from(samples);
    }
    let last = simulation.energy()?;
    outcome.check("dimers: energy per degree of freedom, rotation / translation", 1.0, ratio, 0.06);
    outcome.check("dimers: energy, end / start", 1.0, last.total() / first.total(), 2e-3);
    Ok(())
}

/// Runs the experiment.
pub(super) fn run(_effort: Effort) -> Result<Outcome> {
    on_one_thread(|| {
        let mut outcome = Outcome::default();
        tops(&mut outcome)?;
        rod(&mut outcome)?;
        rolling(&mut outcome)?;
        slopes(&mut outcome)?;
        block(&mut outcome)?;
        gas(&mut outcome)?;
        Ok(outcome)
    })
}
