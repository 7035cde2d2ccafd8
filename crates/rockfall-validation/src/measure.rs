//! Functions that the experiments share: creating simulations, measuring loads and friction, fits, frequencies.

use std::collections::HashMap;

use rockfall::{Backend, Body, ContactAction, Integrator, Options, Scene, Settings, Simulation, SphereState};

use crate::Result;

/// Runs an experiment on one thread. With few bodies, waking other threads takes longer than a step.
pub(crate) fn on_one_thread<T: Send>(run: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(run)
}

/// Creates an empty scene with changed settings.
pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> Scene {
    let mut scene = Scene::new();
    change(&mut scene.settings);
    scene
}

/// Creates a simulation on the CPU.
pub(crate) fn on_cpu(scene: Scene, integrator: Integrator) -> Result<Simulation> {
    let options = Options::new().backend(Backend::Cpu).integrator(integrator);
    Ok(Simulation::with_options(scene, options)?)
}

/// Forces that support bodies at rest. They are computed from the overlaps as Cc m* o, independently of the forces that the
/// engine reports.
pub(crate) struct Support {
    /// Upward force of all fixed bodies.
    pub(crate) up: f64,
    /// Sum over the contacts of the upward force times the difference in height of the two bodies, where the height of a fixed
    /// body is 0. At rest it is equal to the sum of weight times height (the virial theorem).
    pub(crate) virial: f64,
}

/// Computes the support in a scene whose moving bodies are spheres. Friction is ignored.
pub(crate) fn support(simulation: &mut Simulation, contact_force: f64) -> Result<Support> {
    let spheres = simulation.spheres()?;
    let index: HashMap<_, usize> = simulation.scene().sphere_ids().zip(0..).collect();
    let sphere = |body: Body| if let Body::Sphere(id) = body { index.get(&id).map(|at| &spheres[*at]) } else { None };
    let moving = |body: Body| sphere(body).filter(|sphere| !sphere.fixed);
    let inverse_mass = |sphere: Option<&SphereState>| sphere.map_or(0.0, |sphere| 1.0 / f64::from(sphere.mass));
    let height = |sphere: Option<&SphereState>| sphere.map_or(0.0, |sphere| f64::from(sphere.position.y));
    let mut support = Support { up: 0.0, virial: 0.0 };
    for contact in simulation.contacts()? {
        let (a, b) = (moving(contact.a), moving(contact.b));
        let reduced_mass = 1.0 / (inverse_mass(a) + inverse_mass(b));
        // Force on body B; body A gets the opposite one.
        let up = contact_force * reduced_mass * f64::from(contact.overlap) * f64::from(contact.normal.y);
        match (a, b) {
            (Some(_), None) => support.up -= up,
            (None, Some(_)) => support.up += up,
            _ => {}
        }
        support.virial += up * (height(b) - height(a));
    }
    Ok(support)
}

/// Effect of the friction impulses of one step.
pub(crate) struct Friction {
    /// Largest ratio of the friction on a moving sphere to the sum of its contact pressures. It is at most mu_c, and equal to
    /// mu_c for a sphere with a single contact that slides.
    pub(crate) ratio: f64,
    /// Total upward friction force on the moving bodies, which comes from the fixed ones.
    pub(crate) up: f64,
}

/// Activation threshold that no collision reaches. [`friction`] needs it, because phase 3 by itself handles collisions even if
/// the setting `collisions` is off. With this threshold, it applies only the friction impulses.
pub(crate) const NO_COLLISIONS: f32 = 1e9;

/// Runs one step phase by phase and compares the velocities before and after phase 3. All moving bodies must be spheres.
pub(crate) fn friction(simulation: &mut Simulation, step: f32) -> Result<Friction> {
    simulation.set_time_step(step)?;
    simulation.update_aabbs()?;
    simulation.broad_phase()?;
    let before = simulation.spheres()?;
    let index: HashMap<_, usize> = simulation.scene().sphere_ids().zip(0..).collect();
    let mut pressures = vec![0.0; before.len()];
    for contact in simulation.contacts()? {
        let ContactAction::Force(force) = contact.action else { continue };
        let pressure = force.as_dvec3().dot(contact.normal.as_dvec3());
        for body in [contact.a, contact.b] {
            if let Body::Sphere(id) = body {
                pressures[index[&id]] += pressure;
            }
        }
    }
    simulation.handle_collisions()?;
    let after = simulation.spheres()?;
    simulation.update_positions(step)?;
    let mut friction = Friction { ratio: 0.0, up: 0.0 };
    for ((old, new), pressure) in before.iter().zip(&after).zip(pressures).filter(|((old, _), _)| !old.fixed) {
        let force = f64::from(old.mass) * (new.velocity - old.velocity).as_dvec3() / f64::from(step);
        friction.up += force.y;
        // With a weak pressure, the ratio is dominated by rounding.
        if pressure > 0.05 {
            friction.ratio = friction.ratio.max(force.length() / pressure);
        }
    }
    Ok(friction)
}

/// Slope and intercept of the least-squares line.
pub(crate) fn line_fit(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / n, y + point.1 / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(xy, xx), point| {
        let dx = point.0 - x;
        (xy + dx * (point.1 - y), xx + dx * dx)
    });
    (xy / xx, y - xy / xx * x)
}

/// Exponent p of y = a x^p, from a line through the logarithms.
pub(crate) fn power_fit(points: &[(f64, f64)]) -> f64 {
    line_fit(&points.iter().map(|(x, y)| (x.ln(), y.ln())).collect::<Vec<_>>()).0
}

/// Times at which a sampled signal rises through 0, by linear interpolation.
pub(crate) fn rises(samples: &[(f64, f64)]) -> Vec<f64> {
    let pairs = samples.windows(2).filter(|pair| pair[0].1 < 0.0 && pair[1].1 >= 0.0);
    pairs.map(|pair| pair[0].0 + (pair[1].0 - pair[0].0) * pair[0].1 / (pair[0].1 - pair[1].1)).collect()
}

/// Mean period of a sampled signal, from its first to its last rise through 0; NaN with fewer than two rises.
pub(crate) fn period(samples: &[(f64, f64)]) -> f64 {
    let rises = rises(samples);
    match rises[..] {
        [first, .., last] => (last - first) / (rises.len() - 1) as f64,
        _ => f64::NAN,
    }
}

/// Load on the floor by Janssen's law for a weight above it; at most `most`.
pub(crate) fn janssen(weight: f64, most: f64) -> f64 {
    most * (1.0 - (-weight / most).exp())
}

/// Least-squares fit of the largest load in Janssen's law.
pub(crate) fn janssen_fit(points: &[(f64, f64)]) -> f64 {
    let error = |most: f64| points.iter().map(|(weight, load)| (janssen(*weight, most) - load).powi(2)).sum::<f64>();
    let heaviest = points.iter().map(|point| point.0).fold(0.0, f64::max);
    let (mut low, mut high) = (1e-3 * heaviest, 10.0 * heaviest);
    for _ in 0..200 {
        let (one, two) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if error(one) < error(two) {
            high = two;
        } else {
            low = one;
        }
    }
    0.5 * (low + high)
}

/// Mean of some values.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns `count` points of a curve, with x from `from` to `to`.
pub(crate) fn curve(from: f64, to: f64, count: u32, of: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let place = |k: u32| from + (to - from) * f64::from(k) / f64::from(count - 1);
    (0..count).map(place).map(|x| (x, of(x))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_fit_finds_the_exponent() {
        let points: Vec<_> = [1.0, 2.0, 4.0].map(|x: f64| (x, 3.0 * x.powi(4))).to_vec();
        assert!((power_fit(&points) - 4.0).abs() < 1e-12);
        assert_eq!(line_fit(&[(0.0, 1.0), (2.0, 5.0)]), (2.0, 1.0));
    }

    #[test]
    fn period_finds_the_period_of_a_sine() {
        let samples = curve(0.0, 10.0, 1001, |t| (2.0 * t + 0.3).sin());
        assert!((period(&samples) - std::f64::consts::PI).abs() < 1e-4);
        assert!(period(&samples[..10]).is_nan());
    }
}
