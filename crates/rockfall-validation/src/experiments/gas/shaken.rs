//! A shaken gas: random kicks replace the energy that is lost in collisions.

use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rockfall::glam::Vec3;
use rockfall::{Checkpoint, SphereId};

use super::{STEP, Theory, inelastic, normal, temperature};
use crate::chart::{Axis, Chart, Mark};
use crate::measure::{curve, mean, power_fit};
use crate::{Outcome, Result};

/// Number of steps between two kicks. A kick changes the velocity of each sphere by a normally distributed vector.
const EVERY: u64 = 10;
/// Variance of one component of all kicks in a second. It keeps the gas at T = 1 if 1/tau at T = 1 is half of it.
const HEAT: f64 = 0.25;

/// Temperature at which heating and cooling are equal: dT/dt = HEAT - 2 T / tau = 0, where 1/tau is proportional to sqrt(T).
fn balance(theory: &Theory, e: f64) -> f64 {
    (0.5 * HEAT / theory.rates(e, 1.0).1).powf(2.0 / 3.0)
}

/// Mean temperature over a time tau. It begins half a time tau after the temperature was set to that of theory.
fn shaken(state: &Checkpoint, theory: &Theory, e: f64) -> Result<f64> {
    let mut simulation = inelastic(state, e)?;
    let ids: Vec<SphereId> = simulation.scene().sphere_ids().collect();
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let warm = (balance(theory, e) / temperature(&mut simulation)?).sqrt() as f32;
    let strength = (HEAT * EVERY as f64 * f64::from(STEP)).sqrt() as f32;
    let tau = 1.0 / theory.rates(e, balance(theory, e)).1;
    let rounds = (tau / (EVERY as f64 * f64::from(STEP))) as u64;
    let mut temperatures = Vec::new();
    for round in 0..rounds + rounds / 2 {
        let kicks: Vec<Vec3> = ids.iter().map(|_| strength * normal(&mut random)).collect();
        let drift = kicks.iter().sum::<Vec3>() / kicks.len() as f32;
        let scale = if round == 0 { warm } else { 1.0 };
        let velocities: Vec<Vec3> = simulation.spheres()?.iter().map(|sphere| scale * sphere.velocity).collect();
        for ((id, velocity), kick) in ids.iter().zip(velocities).zip(kicks) {
            simulation.set_velocity(*id, velocity + kick - drift)?;
        }
        simulation.run(EVERY, STEP)?;
        if round >= rounds / 2 {
            // The gas cools between two kicks. The mean is half a kick above the value at the end.
            temperatures.push(temperature(&mut simulation)? + 0.5 * HEAT * EVERY as f64 * f64::from(STEP));
        }
    }
    Ok(mean(&temperatures))
}

/// Checks the temperature for several restitutions.
pub(super) fn check(outcome: &mut Outcome, theory: &Theory, state: &Checkpoint, restitutions: &[f64]) -> Result<Chart> {
    let mut points = Vec::new();
    for e in restitutions.iter().copied() {
        let measured = shaken(state, theory, e)?;
        let expected = balance(theory, e);
        outcome.check(format!("shaken, e = {e:.2}: temperature"), expected, measured, 0.05 * expected);
        points.push((1.0 - e * e, measured));
    }
    if points.len() > 1 {
        outcome.check("shaken: exponent of 1 - e² in T", -2.0 / 3.0, power_fit(&points), 0.05);
    }
    let axes = (Axis::logarithmic("1 - e²"), Axis::logarithmic("granular temperature T"));
    let line = curve(0.15, 0.6, 20, |x| balance(theory, (1.0 - x).sqrt()));
    let chart = Chart::new("gas-shaken", "A shaken gas of inelastic spheres", axes.0, axes.1)
        .add(0, Mark::Line, "heat = cooling", line)
        .add(0, Mark::Points, "measured", points);
    Ok(chart)
}
