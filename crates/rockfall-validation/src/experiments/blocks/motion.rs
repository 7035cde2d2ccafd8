//! Boxes in motion: a rocking block, elastic impacts.

use rockfall::glam::{DQuat, DVec3, Quat, Vec3};
use rockfall::{Integrator, Pair, Placement, RigidBody, Simulation};

use super::{DENSITY, GRAVITY, block, bodies, floor, stage, step};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::on_cpu;
use crate::{Outcome, Result};

const G: f64 = GRAVITY as f64;

/// Half the edges of the block that rocks, and the rounding radius of its edges, m.
const HALF: [f64; 2] = [0.5, 2.0];
const EDGE: f64 = 1e-3;

/// The angle of the block that rocks over 2.2 s, at first `start`. It stands on the edge at +x.
fn rock(start: f64) -> Result<Vec<(f64, f64)>> {
    const STIFFNESS: f32 = 2e8;
    let edges = Vec3::new(2.0 * HALF[0] as f32, 2.0 * HALF[1] as f32, 1.0);
    let mass = DENSITY * edges.element_product();
    let pair = Pair::default().restitution(0.05).friction(0.8).stiffness(STIFFNESS);
    let (mut scene, stuff) = stage(GRAVITY * Vec3::NEG_Y, pair)?;
    floor(&mut scene, stuff)?;
    let shape = scene.add_shape(block(stuff, edges, EDGE as f32))?;
    let arm = DQuat::from_rotation_z(-start) * DVec3::new(EDGE - HALF[0], HALF[1] - EDGE, 0.0);
    let sunk = f64::from(mass * GRAVITY / (2.0 * STIFFNESS));
    let turn = Quat::from_rotation_z(-start as f32);
    scene.add_body(Placement::new(shape).at([arm.x, EDGE - sunk + arm.y, 0.0]).turned(turn))?;
    let mut simulation = on_cpu(scene, Integrator::VelocityVerlet)?;
    let step = step(mass, STIFFNESS, 16.0);
    let angle = |body: &RigidBody| {
        let across = (body.orientation * Vec3::X).as_dvec3();
        -across.y.atan2(across.x)
    };
    let mut measured = vec![(0.0, start)];
    for number in 1..=(0.55 / step) as u32 {
        simulation.run(4, step)?;
        measured.push((f64::from(number) * 4.0 * f64::from(step), angle(&bodies(&mut simulation)?[0])));
    }
    Ok(measured)
}

/// The time from rest at the angle `start` until the block is upright: it rolls on the rounded edge, and keeps its energy.
fn upright(start: f64) -> f64 {
    const PARTS: u32 = 10_000;
    let [b, h] = HALF.map(|half| half - EDGE);
    let height = |angle: f64| b * angle.sin() + h * angle.cos();
    // θ = θ0 (1 - s²), so that the integrand is finite at the start.
    let part = |s: f64| {
        let angle = start * (1.0 - s * s);
        let forward = EDGE + height(angle);
        let upward = b * angle.cos() - h * angle.sin();
        let inertia = forward * forward + upward * upward + (HALF[0].powi(2) + HALF[1].powi(2)) / 3.0;
        2.0 * start * s / (2.0 * G * (height(start) - height(angle)) / inertia).sqrt()
    };
    (0..PARTS).map(|index| part((f64::from(index) + 0.5) / f64::from(PARTS)) / f64::from(PARTS)).sum()
}

/// A block of 1 m by 4 m is let go at half of the angle at which it would tip over.
pub(super) fn rocking(outcome: &mut Outcome) -> Result<()> {
    let alpha = (HALF[0] / HALF[1]).atan();
    let start = 0.5 * alpha;
    let measured = rock(start)?;
    let after = measured.iter().position(|(_, angle)| *angle < 0.0).ok_or("the block does not become upright")?;
    let (one, two) = (measured[after - 1], measured[after]);
    let time = one.0 + (two.0 - one.0) * one.1 / (one.1 - two.1);
    let rate = (0.75 * G / HALF[0].hypot(HALF[1])).sqrt();
    let quarter = (1.0 / (1.0 - start / alpha)).acosh() / rate;
    outcome.check("rocking: time until upright, by Housner's formula for small angles, s", quarter, time, 0.005 * quarter);
    let exact = upright(start);
    outcome.check("rocking: the same, by the integral for finite angles and a rounded edge, s", exact, time, 0.002 * exact);
    // The energy above that of the block at rest is M g R (cos (α - θ) - cos α) at the highest point.
    let energy = |angle: f64| (alpha - angle).cos() - alpha.cos();
    let peak = measured.iter().map(|(_, angle)| -angle).fold(0.0, f64::max);
    let loss = 1.0 - 1.5 * alpha.sin().powi(2);
    outcome.check("rocking: spin after the impact over that before", loss, (energy(peak) / energy(start)).sqrt(), 0.003);
    // θ'' = -p² (α - θ) until the first impact.
    let theory = |t: f64| (t, alpha - (alpha - start) * (rate * t).cosh());
    let curve = (0..=50).map(|k| theory(quarter * f64::from(k) / 50.0)).collect();
    outcome.charts.push(
        Chart::new("blocks-rocking", "A block rocks", Axis::linear("time, s"), Axis::linear("angle, rad"))
            .add(0, Mark::Line, "Housner, until the first impact", curve)
            .add(1, Mark::Points, "measured", measured.into_iter().step_by(50).collect()),
    );
    Ok(())
}

/// A box that falls from 0.05 m above a smooth floor.
struct Fall {
    edges: Vec3,
    turn: Quat,
    gravity: f32,
    velocity: f32,
    stiffness: f32,
}

impl Fall {
    const ROUNDING: f32 = 0.004;

    fn mass(&self) -> f32 {
        DENSITY * self.edges.element_product()
    }

    fn step(&self) -> f32 {
        step(self.mass(), self.stiffness, 32.0)
    }

    /// The lowest vertex of the core, from the centre.
    fn lowest(&self) -> Vec3 {
        let half = 0.5 * self.edges - Vec3::splat(Self::ROUNDING);
        let up = self.turn.inverse() * Vec3::Y;
        self.turn * -Vec3::from_array(std::array::from_fn(|axis| half[axis].copysign(up[axis])))
    }

    fn simulation(&self, gap: f32) -> Result<Simulation> {
        let pair = Pair::default().restitution(1.0).friction(0.0).stiffness(self.stiffness);
        let (mut scene, stuff) = stage(self.gravity * Vec3::NEG_Y, pair)?;
        floor(&mut scene, stuff)?;
        let shape = scene.add_shape(block(stuff, self.edges, Self::ROUNDING))?;
        let height = f64::from(gap + Self::ROUNDING - self.lowest().y);
        scene.add_body(Placement::new(shape).at([0.0, height, 0.0]).turned(self.turn).velocity([0.0, -self.velocity, 0.0]))?;
        on_cpu(scene, Integrator::VelocityVerlet)
    }

    /// The greatest change of the energy after any impact within 2 s, against that of the fall, and the number of impacts.
    fn change(&self) -> Result<(f64, u32)> {
        const GAP: f32 = 0.05;
        let mut simulation = self.simulation(GAP)?;
        let weight = f64::from(self.mass() * self.gravity);
        let start = f64::from(bodies(&mut simulation)?[0].position.y);
        let (mut worst, mut impacts, mut touched) = (0.0_f64, 0, false);
        for _ in 0..(0.4 / self.step()) as u32 {
            simulation.run(5, self.step())?;
            let energy = simulation.energy()?;
            let touches = energy.contact > 0.0;
            if touched && !touches {
                let fallen = start - f64::from(bodies(&mut simulation)?[0].position.y);
                worst = worst.max((energy.kinetic / weight - fallen).abs() / f64::from(GAP));
                impacts += 1;
            }
            touched = touches;
        }
        Ok((worst, impacts))
    }
}

/// Elastic boxes fall on a smooth floor.
pub(super) fn impacts(outcome: &mut Outcome) -> Result<()> {
    let corner = Quat::from_rotation_arc(Vec3::ONE.normalize(), Vec3::NEG_Y);
    let aside = Quat::from_rotation_z(0.3) * corner;
    let fall = |edges, turn| Fall { edges, turn, gravity: GRAVITY, velocity: 0.0, stiffness: 1e7 };
    let cube = Vec3::splat(0.2);
    let cases = [
        ("flat box", Vec3::new(0.4, 0.2, 0.3), Quat::IDENTITY, 2e-3),
        ("cube, corner below the centre", cube, corner, 1e-3),
        ("cube, corner aside", cube, aside, 2e-3),
    ];
    for (name, edges, turn, bound) in cases {
        let (worst, impacts) = fall(edges, turn).change()?;
        outcome.check(format!("{name}: greatest change of the energy in {impacts} impacts, part"), 0.0, worst, bound);
    }
    // Without weight and with a stiff contact, the cube hardly turns during the impact.
    let fall = Fall { gravity: 0.0, velocity: 1.0, stiffness: 1e9, ..fall(cube, aside) };
    let mut simulation = fall.simulation(1e-5)?;
    let mut has_met = false;
    for _ in 0..2_000 {
        simulation.run(5, fall.step())?;
        let touches = simulation.energy()?.contact > 0.0;
        if has_met && !touches {
            break;
        }
        has_met |= touches;
    }
    let arm = f64::from(fall.lowest().x).hypot(f64::from(fall.lowest().z));
    let part = 6.0 * arm * arm / 0.04;
    let [up, spin] = [1.0 - part, 12.0 * arm / 0.04].map(|value| value / (1.0 + part));
    let body = &bodies(&mut simulation)?[0];
    outcome.check("cube, corner aside: velocity after the impact over that before", up, f64::from(body.velocity.y), 0.01 * up);
    let measured = f64::from(body.angular_momentum.length() / fall.mass()) * 6.0 / 0.04;
    outcome.check("cube, corner aside: spin after the impact of 1 m/s, rad/s", spin, measured, 0.01 * spin);
    Ok(())
}
