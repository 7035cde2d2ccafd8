//! Discharge through a hole in the floor: Beverloo's law.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::{BoxId, Cuboid, Integrator, Scene, Sphere, SphereState};

use crate::chart::{Axis, Chart, Mark};
use crate::measure::{NO_COLLISIONS, curve, friction, line_fit, mean, on_cpu, with};
use crate::{Effort, Outcome, Result};

const STEP: f32 = 0.01;
/// Half the width of the silo. The mean diameter of the spheres is 1.
const HALF: f32 = 4.5;

/// A square silo with a square hole of this width. Returns the scene and the box that closes the hole.
fn silo(count: u32, hole: f32) -> Result<(Scene, BoxId)> {
    let mut scene = with(|settings| {
        settings.coulomb_friction = 0.5;
        (settings.collisions, settings.activation_threshold) = (false, NO_COLLISIONS);
    });
    let (half, top) = (0.5 * hole, 2.0 * count as f32 / (4.0 * HALF * HALF) + 5.0);
    let out = HALF + 1.0;
    scene.add_box(Cuboid::between([-out, -1.0, -out], [-half, 0.0, out]))?;
    scene.add_box(Cuboid::between([half, -1.0, -out], [out, 0.0, out]))?;
    scene.add_box(Cuboid::between([-half, -1.0, -out], [half, 0.0, -half]))?;
    scene.add_box(Cuboid::between([-half, -1.0, half], [half, 0.0, out]))?;
    scene.add_box(Cuboid::between([-out, 0.0, -out], [-HALF, top, out]))?;
    scene.add_box(Cuboid::between([HALF, 0.0, -out], [out, top, out]))?;
    scene.add_box(Cuboid::between([-HALF, 0.0, -out], [HALF, top, -HALF]))?;
    scene.add_box(Cuboid::between([-HALF, 0.0, HALF], [HALF, top, out]))?;
    let plug = scene.add_box(Cuboid::between([-half, -1.0, -half], [half, 0.0, half]))?;
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let across = (2.0 * HALF / 1.12) as u32;
    for index in 0..count {
        let cell = [index % across, index / across / across, index / across % across].map(|k| k as f32);
        let jitter = [0; 3].map(|_| random.random_range(-0.005_f32..0.005));
        let place = [0, 1, 2].map(|k| {
            let from = if k == 1 { 0.56 } else { 0.56 - 0.56 * across as f32 };
            from + 1.12 * cell[k] + jitter[k]
        });
        let radius = random.random_range(0.45_f32..0.55);
        scene.add_sphere(Sphere::new(place, radius).mass((2.0 * radius).powi(3)))?;
    }
    Ok((scene, plug))
}

/// Measurements of a discharge.
struct Discharge {
    /// Spheres per second.
    rate: f64,
    /// Rate in the second half of the time over the rate in the first.
    later: f64,
    /// Mean downward acceleration of the spheres below the hole.
    fall: f64,
    /// Largest ratio of the friction on a sphere to the sum of its pressures, over all samples.
    friction: f64,
}

/// Measures the discharge through a hole of this width.
fn discharge(count: u32, hole: f32, seconds: u32) -> Result<Discharge> {
    let (scene, plug) = silo(count, hole)?;
    let mut simulation = on_cpu(scene, Integrator::SymplecticEuler)?;
    simulation.run(800, STEP)?;
    simulation.remove_box(plug)?;
    // The flow becomes steady.
    simulation.run(300, STEP)?;
    let (mut samples, mut falls, mut frictions) = (Vec::new(), Vec::new(), Vec::new());
    let is_out = |sphere: &SphereState| sphere.position.y < -1.0;
    let mut spheres = simulation.spheres()?;
    for sample in 0..=4 * seconds {
        let gone = spheres.iter().filter(|sphere| is_out(sphere)).count();
        samples.push((0.25 * f64::from(sample), gone as f64));
        if gone > count as usize / 2 {
            break;
        }
        frictions.push(friction(&mut simulation, STEP)?.ratio);
        simulation.run(24, STEP)?;
        let before = std::mem::replace(&mut spheres, simulation.spheres()?);
        let fall = |(then, now): (&SphereState, &SphereState)| f64::from(then.velocity.y - now.velocity.y) / 0.25;
        falls.extend(before.iter().zip(&spheres).filter(|(then, _)| is_out(then)).map(fall));
    }
    let (first, second) = samples.split_at(samples.len() / 2);
    let later = line_fit(second).0 / line_fit(first).0;
    Ok(Discharge { rate: line_fit(&samples).0, later, fall: mean(&falls), friction: frictions.into_iter().fold(0.0, f64::max) })
}

/// Discharge by Beverloo's law through a square hole: the constants are C = 0.58, times 4/pi, and k = 1.4. `LOOSE` is the
/// number of spheres per volume of the loose flow.
fn beverloo(hole: f64) -> f64 {
    const LOOSE: f64 = 0.58 / (std::f64::consts::PI / 6.0);
    0.58 * 4.0 / std::f64::consts::PI * LOOSE * (hole - 1.4).max(0.0).powf(2.5)
}

pub(crate) fn run(effort: Effort) -> Result<Outcome> {
    let count = effort.pick(600, 1500);
    let (mut rates, mut out) = (Vec::new(), Vec::new());
    for hole in effort.pick(&[3.5_f32, 4.25, 5.0][..], &[3.0, 3.5, 4.0, 4.5, 5.0, 5.5]) {
        let discharge = discharge(count, *hole, effort.pick(8, 30))?;
        rates.push((f64::from(*hole), discharge.rate));
        out.push(discharge);
    }
    let mut outcome = Outcome::default();
    outcome.fact("count", f64::from(count));
    // W^(2/5) is a straight line that is 0 at k.
    let roots: Vec<_> = rates.iter().map(|(hole, rate)| (*hole, rate.powf(0.4))).collect();
    let (slope, intercept) = line_fit(&roots);
    outcome.check("k: where W^(2/5) vanishes (diameters)", 1.4, -intercept / slope, 0.5);
    let theory = curve(2.0, 3.0, 2, |hole| beverloo(hole).powf(0.4));
    let expected = line_fit(&theory).0;
    outcome.check("slope of W^(2/5) over the width of the hole", expected, slope, 0.2 * expected);
    let departures = roots.iter().map(|(hole, root)| (root / (intercept + slope * hole) - 1.0).abs());
    outcome.check(
        "W^(2/5): largest relative departure from its line",
        0.0,
        departures.fold(0.0, f64::max),
        effort.pick(0.15, 0.05),
    );
    let all = |of: fn(&Discharge) -> f64| mean(&out.iter().map(of).collect::<Vec<_>>());
    outcome.check("discharge, second half / first half", 1.0, all(|out| out.later), effort.pick(0.5, 0.15));
    outcome.check("acceleration of spheres below the hole (units/s²)", 1.0, all(|out| out.fall), 0.01);
    outcome.check("largest friction on a sphere / pressure", 0.5, out.iter().map(|out| out.friction).fold(0.0, f64::max), 0.01);
    let axes = (Axis::linear("width of the hole (diameters)"), Axis::linear("discharge (spheres/s)"));
    outcome.charts.push(
        Chart::new("hopper", "Discharge of a silo", axes.0, axes.1)
            .add(0, Mark::Line, "Beverloo, C = 0.58, k = 1.4", curve(1.4, 5.7, 60, beverloo))
            .add(2, Mark::Line, "power 5/2, fitted", curve(1.8, 5.7, 60, |hole| (intercept + slope * hole).max(0.0).powf(2.5)))
            .add(1, Mark::Points, "measured", rates),
    );
    Ok(outcome)
}
