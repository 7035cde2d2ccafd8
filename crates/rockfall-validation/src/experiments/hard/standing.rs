//! What stands: stacks, walls, pyramids, overhangs, dominoes, a plate on many balls.

use rockfall::glam::Vec3;
use rockfall::{Cuboid, Integrator, RigidBody, Scene, Shape, Simulation, Sphere};

use super::{FRAME, GRAVITY, add, add_box, bodies, frames, frequency_squared, ground};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, on_cpu, power_fit};
use crate::{Effort, Outcome, Result};

/// g / w² of contacts between bodies.
fn unit_sink(dt: f64, substeps: u32) -> f64 {
    GRAVITY / frequency_squared(dt / f64::from(substeps))
}

/// A stack of unit cubes.
fn stack(count: u32, substeps: u32) -> Result<Scene> {
    let mut scene = ground(0.0, 0.5, 0.0)?;
    scene.run.substeps = Some(substeps);
    for level in 0..count {
        add_box(&mut scene, Vec3::ONE, 1.0, f64::from(level) + 0.5)?;
    }
    Ok(scene)
}

/// The sink of the top cube of a stack: N (N - 1) / 2 · 2 g / w² between cubes, and N / 4 · g / w² on the floor.
fn stack_sink(count: u32, unit: f64) -> f64 {
    let count = f64::from(count);
    (count * (count - 1.0) + 0.25 * count) * unit
}

fn top(simulation: &mut Simulation) -> Result<RigidBody> {
    Ok(bodies(simulation)?.last().ok_or("no body")?.clone())
}

/// Sinks of a stack at several numbers of substeps.
pub(super) fn overlaps(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    const CUBES: u32 = 15;
    let wanted = |substeps: u32| stack_sink(CUBES, unit_sink(FRAME.into(), substeps));
    let mut found = Vec::new();
    for substeps in effort.pick(vec![4, 8], vec![4, 5, 6, 8, 11, 16, 23, 32]) {
        let mut simulation = on_cpu(stack(CUBES, substeps)?, Integrator::Rk4)?;
        frames(&mut simulation, 6.0)?;
        let sink = f64::from(CUBES) - 0.5 - f64::from(top(&mut simulation)?.position.y);
        let exact = wanted(substeps);
        if [4, 8, 16].contains(&substeps) {
            outcome.check(format!("20: stack of 15 cubes, {substeps} substeps: sink of the top one, m"), exact, sink, 0.03 * exact);
        }
        found.push((f64::from(substeps), sink));
    }
    outcome.check("20: power of the substeps by which it sinks", -2.0, power_fit(&found), 0.05);
    outcome.charts.push(
        Chart::new("hard-substeps", "Sink of a stack of 15 cubes", Axis::logarithmic("substeps"), Axis::logarithmic("sink, m"))
            .add(0, Mark::Line, "springs", curve(4.0, 32.0, 60, |s| wanted(1) / (s * s)))
            .add(0, Mark::Points, "measured", found),
    );
    Ok(())
}

/// The way that the body takes that moves most, and the kinetic energy at the end.
fn settle(scene: Scene, seconds: f32) -> Result<(f64, f64)> {
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let before = bodies(&mut simulation)?;
    frames(&mut simulation, seconds)?;
    let after = bodies(&mut simulation)?;
    let ways = before.iter().zip(&after).map(|(a, b)| f64::from(a.position.distance(b.position)));
    Ok((ways.fold(0.0, f64::max), simulation.energy()?.kinetic))
}

fn check_settled(outcome: &mut Outcome, name: &str, scene: Scene, seconds: f32, most: f64) -> Result<()> {
    let (way, kinetic) = settle(scene, seconds)?;
    outcome.check(format!("{name}: greatest displacement in {seconds} s, m"), 0.0, way, most);
    outcome.check(format!("{name}: kinetic energy at the end, J"), 0.0, kinetic, 1e-3);
    Ok(())
}

fn cube(edges: Vec3) -> Shape {
    Shape::new().mass(1.0).cuboid(Cuboid::between(-0.5 * edges, 0.5 * edges))
}

/// A pyramid of 20 rows.
pub(super) fn pyramid(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    for (substeps, most) in effort.pick(vec![(4, 0.02)], vec![(4, 0.02), (8, 0.005)]) {
        let mut scene = ground(0.0, 0.5, 0.0)?;
        scene.run.substeps = Some(substeps);
        for row in 0..20_u8 {
            for k in 0..20 - row {
                let x = 1.05 * (f64::from(k) - 0.5 * f64::from(20 - row));
                add(&mut scene, cube(Vec3::ONE), |place| place.at([x, f64::from(row) + 0.5, 0.0]))?;
            }
        }
        check_settled(outcome, &format!("21: pyramid of 20 rows, {substeps} substeps"), scene, effort.pick(3.0, 6.0), most)?;
    }
    Ok(())
}

/// A wall of 16 rows in bond, with half bricks at the ends of every second row.
pub(super) fn wall(outcome: &mut Outcome, effort: Effort) -> Result<()> {
    for (substeps, most) in effort.pick(vec![(4, 0.025)], vec![(4, 0.025), (8, 0.006)]) {
        let mut scene = ground(0.0, 0.5, 0.0)?;
        scene.run.substeps = Some(substeps);
        for row in 0..16_u8 {
            let mut brick = |x: f64, length: f32| {
                let at = [x, 0.5 * f64::from(row) + 0.25, 0.0];
                add(&mut scene, cube(Vec3::new(length, 0.5, 0.5)), |place| place.at(at))
            };
            for k in row % 2..8 {
                brick(f64::from(k) - 0.5 * f64::from(row % 2), 1.0)?;
            }
            if row % 2 == 1 {
                brick(-0.25, 0.5)?;
                brick(7.25, 0.5)?;
            }
        }
        check_settled(outcome, &format!("22: wall of 16 rows, {substeps} substeps"), scene, effort.pick(3.0, 6.0), most)?;
    }
    Ok(())
}

/// A heavy cube on one of mass 1. With its mass M a point between them has K = 4 + 4 / M, and one on the floor 4.
pub(super) fn ratios(outcome: &mut Outcome) -> Result<()> {
    for (mass, substeps) in [(10.0, 8), (100.0, 4), (100.0, 8), (1000.0, 8), (1000.0, 13)] {
        let mut scene = stack(1, substeps)?;
        add_box(&mut scene, Vec3::ONE, mass, 1.5)?;
        let mut simulation = on_cpu(scene, Integrator::Rk4)?;
        frames(&mut simulation, 8.0)?;
        let exact = 1.25 * (mass + 1.0) * unit_sink(FRAME.into(), substeps);
        let sink = 1.5 - f64::from(top(&mut simulation)?.position.y);
        outcome.check(format!("23: mass {mass} on 1, {substeps} substeps: sink, m"), exact, sink, 0.02 * exact);
    }
    Ok(())
}

/// A stack of ten cubes falls with gaps of 2 cm and e = 0.5.
pub(super) fn dropped(outcome: &mut Outcome) -> Result<()> {
    let mut scene = ground(0.0, 0.5, 0.5)?;
    for level in 0..10_u8 {
        add_box(&mut scene, Vec3::ONE, 1.0, 0.52 + 1.02 * f64::from(level))?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 15.0)?;
    let exact = 9.5 - stack_sink(10, unit_sink(FRAME.into(), 4));
    let height = top(&mut simulation)?.position.y.into();
    outcome.check("24: stack of ten dropped with gaps: height of the top one after 15 s, m", exact, height, 1e-3);
    outcome.check("24: kinetic energy, J", 0.0, simulation.energy()?.kinetic, 1e-5);
    Ok(())
}

/// Four blocks reach beyond the edge of a fifth. They fall at a share of 1 of the harmonic overhang.
pub(super) fn overhangs(outcome: &mut Outcome) -> Result<()> {
    for (share, substeps, falls) in [(0.95, 4, 0.0), (0.98, 8, 0.0), (1.02, 4, 1.0), (1.02, 8, 1.0)] {
        let mut scene = ground(0.0, 0.5, 0.0)?;
        scene.run.substeps = Some(substeps);
        scene.add_box(Cuboid::between([-0.5, 0.0, -0.25], [0.5, 0.25, 0.25]))?;
        let mut x = 0.0;
        for k in (1..=4_u8).rev() {
            x += share * 0.5 / f64::from(k);
            let at = [x, 0.125 + 0.25 * f64::from(5 - k), 0.0];
            add(&mut scene, cube(Vec3::new(1.0, 0.25, 0.5)), |place| place.at(at))?;
        }
        let found = f64::from(u8::from(settle(scene, 6.0)?.0 > 0.05));
        let name = format!("27: overhang of {share} of the harmonic one, {substeps} substeps: falls");
        outcome.check(name, falls, found, 0.0);
    }
    Ok(())
}

const DOMINOES: u8 = 30;

/// The times at which dominoes of 0.1 by 1 by 0.5 m lean by 0.1 rad, in frames a part as long.
fn wave(substeps: u32, parts: u16) -> Result<Vec<f64>> {
    let mut scene = ground(0.0, 0.3, 0.0)?;
    scene.run.substeps = Some(substeps);
    for k in 0..DOMINOES {
        let (velocity, spin) = if k == 0 { ([0.5, 0.0, 0.0], [0.0, 0.0, -1.0]) } else { ([0.0; 3], [0.0; 3]) };
        let at = [0.5 * f64::from(k), 0.5, 0.0];
        add(&mut scene, cube(Vec3::new(0.1, 1.0, 0.5)), |place| place.at(at).velocity(velocity).spin(spin))?;
    }
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    let dt = FRAME / f32::from(parts);
    let (mut times, mut before) = (vec![f64::NAN; DOMINOES.into()], vec![0.0; DOMINOES.into()]);
    for frame in 1..=300 * u32::from(parts) {
        simulation.run(1, dt)?;
        for (k, body) in bodies(&mut simulation)?.iter().enumerate() {
            let lean = f64::from((body.orientation * Vec3::Y).x).asin();
            if times[k].is_nan() && lean > 0.1 {
                times[k] = f64::from(dt) * (f64::from(frame) - (lean - 0.1) / (lean - before[k]));
            }
            before[k] = lean;
        }
    }
    Ok(times)
}

/// A wave in a row of dominoes.
pub(super) fn dominoes(outcome: &mut Outcome) -> Result<()> {
    let mut chart = Chart::new("hard-dominoes", "A wave in a row of dominoes", Axis::linear("time, s"), Axis::linear("place, m"));
    let places = |times: &[f64]| times.iter().enumerate().map(|(k, time)| (*time, 0.5 * k as f64)).collect::<Vec<_>>();
    let fine = wave(8, 4)?;
    chart = chart.add(0, Mark::Line, "frames of 1/240 s, 8 substeps", places(&fine));
    for (colour, substeps) in [4, 8, 16].into_iter().enumerate() {
        let times = wave(substeps, 1)?;
        let speed = 15.0 * 0.5 / (times[25] - times[10]);
        outcome.check(format!("28: dominoes, {substeps} substeps: speed of the wave, m/s"), 4.0, speed, 0.08);
        chart = chart.add(colour + 1, Mark::Points, format!("{substeps} substeps"), places(&times));
    }
    outcome.charts.push(chart);
    Ok(())
}

/// A plate of mass 200 on 400 balls.
pub(super) fn hub(outcome: &mut Outcome) -> Result<()> {
    let mut scene = ground(0.0, 0.5, 0.0)?;
    for k in 0..400_u16 {
        let [x, z] = [k % 20, k / 20].map(|k| 0.6 * f32::from(k) - 5.7);
        scene.add_sphere(Sphere::new([x, 0.25, z], 0.25))?;
    }
    scene.run.substeps = Some(4);
    add_box(&mut scene, Vec3::new(13.0, 0.5, 13.0), 200.0, 0.75)?;
    let mut simulation = on_cpu(scene, Integrator::Rk4)?;
    frames(&mut simulation, 2.0)?;
    let plate = top(&mut simulation)?;
    outcome.check("47: plate of 200 on 400 balls of 1: sink, m", 0.0, f64::from(0.75 - plate.position.y), 1e-3);
    let tilt = 2.0 * plate.orientation.x.hypot(plate.orientation.z);
    outcome.check("47: tilt of the plate, rad", 0.0, tilt.into(), 1e-4);
    outcome.check("47: kinetic energy, J", 0.0, simulation.energy()?.kinetic, 1e-6);
    Ok(())
}

/// The frame becomes shorter or longer under a stack.
pub(super) fn frames_of_other_lengths(outcome: &mut Outcome) -> Result<()> {
    for factor in [0.5_f32, 2.0] {
        let mut simulation = on_cpu(stack(10, 4)?, Integrator::Rk4)?;
        frames(&mut simulation, 5.0)?;
        let before = top(&mut simulation)?.position.y;
        simulation.run((5.0 / (factor * FRAME)) as u64, factor * FRAME)?;
        let sink = |dt: f32| stack_sink(10, unit_sink(dt.into(), 4));
        let exact = sink(FRAME) - sink(factor * FRAME);
        let found = f64::from(top(&mut simulation)?.position.y - before);
        let name = format!("53: stack of ten, frames {factor} times as long: the top one moves by, m");
        outcome.check(name, exact, found, 0.02 * exact.abs());
    }
    Ok(())
}
