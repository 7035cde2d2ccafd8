//! Haff's law: a gas of inelastic spheres cools as (1 + t/tau)^-2. Also the temperature of a shaken gas.

mod hits;
mod shaken;

use std::f64::consts::{PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{DVec3, Vec3};
use rockfall::{Checkpoint, Cuboid, Integrator, Scene, Simulation, Sphere};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, line_fit, on_cpu, power_fit, with};
use crate::{Effort, Outcome, Result};

const RADIUS: f64 = 0.5;
/// Fraction of the volume that the spheres fill.
const FILLED: f64 = 0.1;
const STEP: f32 = 0.01;

/// Creates spheres on a lattice in a cube of side `side` with walls of boxes. Each component of their random velocities has
/// variance 1.
fn gas(per_side: u32, side: f64) -> Result<Scene> {
    // Every approach is a collision, without friction.
    let mut scene = with(|settings| {
        (settings.gravity, settings.friction) = (0.0, 0.0);
        settings.activation_threshold = 0.0;
        settings.restitution = 1.0;
    });
    let (half, thick) = (0.5 * side as f32, 2.0);
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for sign in [-1.0, 1.0] {
            let middle = sign * (half + 0.5 * thick) * axis;
            let reach = Vec3::splat(half + thick) * (Vec3::ONE - axis) + 0.5 * thick * axis;
            scene.add_box(Cuboid::between(middle - reach, middle + reach))?;
        }
    }
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let mut velocities: Vec<Vec3> = (0..per_side.pow(3)).map(|_| normal(&mut random)).collect();
    let mean = velocities.iter().sum::<Vec3>() / velocities.len() as f32;
    velocities.iter_mut().for_each(|velocity| *velocity -= mean);
    let cell = side as f32 / per_side as f32;
    for (index, velocity) in (0..).zip(velocities) {
        let place = [index % per_side, index / per_side % per_side, index / per_side / per_side].map(|k| k as f32);
        let position = Vec3::splat(-half) + cell * (Vec3::from_array(place) + 0.5);
        scene.add_sphere(Sphere::new(position, RADIUS as f32).velocity(velocity))?;
    }
    Ok(scene)
}

/// Three normally distributed numbers, by the Box-Muller transform.
fn normal(random: &mut Pcg64Mcg) -> Vec3 {
    let mut one = || {
        let (radius, angle): (f64, f64) = (random.random_range(f64::MIN_POSITIVE..1.0), random.random_range(0.0..TAU));
        ((-2.0 * radius.ln()).sqrt() * angle.cos()) as f32
    };
    Vec3::new(one(), one(), one())
}

/// Granular temperature over mass: a third of the mean square velocity.
fn temperature(simulation: &mut Simulation) -> Result<f64> {
    let spheres = simulation.spheres()?;
    let sum: f64 = spheres.iter().map(|sphere| sphere.velocity.as_dvec3().length_squared()).sum();
    Ok(sum / (3.0 * spheres.len() as f64))
}

/// Rates of kinetic theory for hard spheres in a cube.
struct Theory {
    /// Mean number of collisions of a sphere with others per second, over the square root of the temperature.
    frequency: f64,
    /// The same for collisions with the walls, per sphere.
    walls: f64,
}

impl Theory {
    fn new(count: f64, side: f64) -> Self {
        let diameter = 2.0 * RADIUS;
        // The volume available to the centres, and how the spheres crowd at its walls (first order in the density).
        let free = side - diameter;
        let mean = count / free.powi(3);
        let crowding = 1.0 + 6.0 / free * PI / 4.0 * mean * diameter.powi(4);
        let filled = mean / crowding * PI / 6.0 * diameter.powi(3);
        // By Carnahan and Starling. The pressure is divided by the mean density and the temperature.
        let compressibility = (1.0 + filled + filled.powi(2) - filled.powi(3)) / (1.0 - filled).powi(3);
        let pressure = compressibility / crowding;
        Self { frequency: 6.0 / (PI.sqrt() * diameter) * (pressure - 1.0), walls: 6.0 / free * pressure / TAU.sqrt() }
    }

    /// 1/tau at this temperature: from collisions between spheres only, and including the walls.
    fn rates(&self, e: f64, temperature: f64) -> (f64, f64) {
        let spheres = (1.0 - e * e) * self.frequency * temperature.sqrt() / 6.0;
        (spheres, spheres + (1.0 - e * e) * self.walls * temperature.sqrt() / 3.0)
    }
}

/// An elastic gas after the initial lattice has dissolved.
struct Elastic {
    state: Checkpoint,
    /// Total number of collisions per second, of spheres with each other and with the walls.
    collisions: f64,
    /// Mean energy while collisions were counted, and energy at the end, both over the initial energy: 1 except for errors.
    energies: [f64; 2],
}

/// Runs the gas for 2 s, about three collisions per sphere, and then for another 2 s in which collisions are counted.
fn elastic(per_side: u32, side: f64, step: f32) -> Result<Elastic> {
    let mut simulation = on_cpu(gas(per_side, side)?, Integrator::SymplecticEuler)?;
    let steps = (2.0 / step) as u64;
    let first = temperature(&mut simulation)?;
    let before = simulation.run(steps, step)?;
    let middle = temperature(&mut simulation)? / first;
    let after = simulation.run(steps, step)?;
    let last = temperature(&mut simulation)? / first;
    let collisions = (after.total_collisions - before.total_collisions) as f64 / (after.time - before.time);
    Ok(Elastic { state: simulation.checkpoint()?, collisions, energies: [0.5 * (middle + last), last] })
}

/// Continues the gas with restitution `e`, also at the walls.
fn inelastic(state: &Checkpoint, e: f64) -> Result<Simulation> {
    let mut simulation = Simulation::resume(state.clone())?;
    let mut settings = *simulation.settings();
    settings.restitution = e as f32;
    simulation.set_settings(settings)?;
    Ok(simulation)
}

/// Samples of time and temperature.
fn cooled(mut simulation: Simulation, seconds: f64) -> Result<Vec<(f64, f64)>> {
    const SAMPLES: u64 = 40;
    let mut temperatures = vec![(0.0, temperature(&mut simulation)?)];
    let steps = (seconds / f64::from(STEP)) as u64 / SAMPLES;
    for sample in 1..=SAMPLES {
        simulation.run(steps, STEP)?;
        let time = (sample * steps) as f64 * f64::from(STEP);
        temperatures.push((time, temperature(&mut simulation)?));
    }
    Ok(temperatures)
}

/// 1/tau from the slope of T^(-1/2), which is a straight line by Haff's law.
fn fitted_rate(temperatures: &[(f64, f64)]) -> f64 {
    let first = temperatures[0].1;
    let roots: Vec<_> = temperatures.iter().map(|(t, temperature)| (*t, (first / temperature).sqrt())).collect();
    line_fit(&roots).0
}

/// Change of the momentum of a free cloud of colliding spheres, over the sum of the magnitudes of their momenta.
fn momentum_error() -> Result<f64> {
    let mut scene = gas(8, 12.0)?;
    for id in scene.box_ids().collect::<Vec<_>>() {
        scene.remove_box(id)?;
    }
    scene.settings.restitution = 0.8;
    let mut simulation = on_cpu(scene, Integrator::SymplecticEuler)?;
    let momentum = |simulation: &mut Simulation| -> Result<(DVec3, f64)> {
        let spheres = simulation.spheres()?;
        let velocities = spheres.iter().map(|sphere| sphere.velocity.as_dvec3());
        Ok((velocities.clone().sum(), velocities.map(DVec3::length).sum()))
    };
    let (before, size) = momentum(&mut simulation)?;
    let collisions = simulation.run(200, STEP)?.total_collisions;
    if collisions < 200 {
        return Err(format!("gas: only {collisions} collisions, expected at least 200").into());
    }
    Ok((momentum(&mut simulation)?.0 - before).length() / size)
}

/// Checks the collision rate of the elastic gas and its loss of energy by steps of finite length.
fn check_elastic(outcome: &mut Outcome, theory: &Theory, gas: &Elastic, per_side: u32, side: f64) -> Result<()> {
    let count = f64::from(per_side.pow(3));
    let rate = count * (0.5 * theory.frequency + theory.walls) * gas.energies[0].sqrt();
    outcome.check("e = 1: collisions per second / theory", 1.0, gas.collisions / rate, 0.05);
    let half = elastic(per_side, side, 0.5 * STEP)?;
    for (step, energies) in [(STEP, gas.energies), (0.5 * STEP, half.energies)] {
        outcome.check(format!("e = 1: energy lost in 4 s, h = {step}"), 0.0, 1.0 - energies[1], 1e-3);
    }
    let losses = hits::losses(8, 12.0, 200)?;
    outcome.fact("alone", losses.counts[0] as f64);
    outcome.fact("crowded", losses.counts[1] as f64);
    outcome.fact("lost", -100.0 * losses.crowded);
    outcome.check("e = 1: energy gained in collisions of isolated pairs", 0.0, losses.alone, 1e-5);
    outcome.check("e = 1: energy gained in the rest of the step", 0.0, losses.forces, 0.003);
    Ok(())
}

/// Cooling of the gas at one restitution.
struct Cooling {
    e: f64,
    /// 1/tau by theory at the initial temperature.
    theory: f64,
    /// Measured 1/tau.
    rate: f64,
    temperatures: Vec<(f64, f64)>,
}

fn check_cooling(outcome: &mut Outcome, cooling: &Cooling, bound: f64) {
    let Cooling { e, theory, rate, temperatures } = cooling;
    let (name, start) = (format!("e = {e:.1}"), temperatures[0].1);
    outcome.check(format!("{name}: cooling rate 1/tau (1/s)"), *theory, *rate, bound * theory);
    let now = |(t, now): &(f64, f64)| (1.0 + t * theory, now / start);
    let power = power_fit(&temperatures.iter().map(now).collect::<Vec<_>>());
    outcome.check(format!("{name}: exponent of 1 + t/tau in T"), -2.0, power, 0.15);
    let departures = temperatures.iter().map(now).map(|(time, now)| (now * time * time).ln().abs());
    outcome.check(format!("{name}: ln(T / Haff), worst case"), 0.0, departures.fold(0.0, f64::max), 0.12);
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    let per_side: u32 = effort.pick(12, 22);
    let count = f64::from(per_side.pow(3));
    let side = (count * PI / 6.0 * (2.0 * RADIUS).powi(3) / FILLED).cbrt();
    let theory = Theory::new(count, side);
    let mut outcome = Outcome::default();
    outcome.fact("count", count);
    outcome.fact("side", side);
    outcome.check("momentum of 512 free spheres, relative error", 0.0, momentum_error()?, 1e-6);
    let gas = elastic(per_side, side, STEP)?;
    check_elastic(&mut outcome, &theory, &gas, per_side, side)?;
    let axes = (Axis::linear("time / tau"), Axis::logarithmic("granular temperature T / T0"));
    let mut chart = Chart::new("gas", "Cooling of a gas of inelastic spheres", axes.0, axes.1).add(
        0,
        Mark::Line,
        "Haff: (1 + t/tau)^-2",
        curve(0.0, 3.0, 60, |t| (1.0 + t).powi(-2)),
    );
    let mut powers = Vec::new();
    let restitutions = effort.pick(&[0.7, 0.9][..], &[0.7, 0.8, 0.9]);
    for (place, e) in restitutions.iter().copied().enumerate() {
        let (spheres, rate) = theory.rates(e, gas.energies[1]);
        let temperatures = cooled(inelastic(&gas.state, e)?, effort.pick(1.0, 3.0) / rate)?;
        let cooling = Cooling { e, theory: rate, rate: fitted_rate(&temperatures), temperatures };
        check_cooling(&mut outcome, &cooling, effort.pick(0.1, 0.05));
        outcome.fact("walls", 100.0 * (1.0 - spheres / rate));
        powers.push((1.0 - e * e, cooling.rate));
        let points = cooling.temperatures.iter().map(|(t, now)| (t * rate, now / gas.energies[1])).collect();
        chart = chart.add(place + 1, Mark::Points, format!("e = {e:.1}"), points);
    }
    outcome.check("exponent of 1 - e² in 1/tau", 1.0, power_fit(&powers), 0.1);
    outcome.charts.push(chart);
    let chart = shaken::check(&mut outcome, &theory, &gas.state, effort.pick(&[0.7][..], restitutions))?;
    outcome.charts.push(chart);
    Ok(outcome)
}
