//! What the experiments share: opening simulations, fits, frequencies.

use std::collections::HashMap;

use rockfall::{Backend, Body, ContactAction, Integrator, Options, Scene, Settings, Simulation, SphereState};

use crate::Result;

/// Runs an experiment of few bodies on this thread alone: waking others for them takes longer than their steps.
pub(crate) fn alone<T: Send>(run: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(run)
}

/// An empty scene with changed settings.
pub(crate) fn with(change: impl FnOnce(&mut Settings)) -> Scene {
    let mut scene = Scene::new();
    change(&mut scene.settings);
    scene
}

/// A simulation on the CPU.
pub(crate) fn on_cpu(scene: Scene, integrator: Integrator) -> Result<Simulation> {
    let options = Options::new().backend(Backend::Cpu).integrator(integrator);
    Ok(Simulation::with_options(scene, options)?)
}

/// What bears the weight of bodies at rest, by the depths of the overlaps: a contact presses with Cc m* o, whatever the engine says.
pub(crate) struct Borne {
    /// Upward force of all that does not move.
    pub(crate) up: f64,
    /// The sum over the contacts of upward force times the difference in height that it holds up, that of a floor being 0: at
    /// rest that of weight times height (the virial theorem).
    pub(crate) virial: f64,
}

/// With friction left out, and spheres alone.
pub(crate) fn borne(simulation: &mut Simulation, contact_force: f64) -> Result<Borne> {
    let spheres = simulation.spheres()?;
    let index: HashMap<_, usize> = simulation.scene().sphere_ids().zip(0..).collect();
    let sphere = |body: Body| if let Body::Sphere(id) = body { index.get(&id).map(|at| &spheres[*at]) } else { None };
    let moving = |body: Body| sphere(body).filter(|sphere| !sphere.fixed);
    let inverse_mass = |sphere: Option<&SphereState>| sphere.map_or(0.0, |sphere| 1.0 / f64::from(sphere.mass));
    let height = |sphere: Option<&SphereState>| sphere.map_or(0.0, |sphere| f64::from(sphere.position.y));
    let mut borne = Borne { up: 0.0, virial: 0.0 };
    for contact in simulation.contacts()? {
        let (a, b) = (moving(contact.a), moving(contact.b));
        let reduced_mass = 1.0 / (inverse_mass(a) + inverse_mass(b));
        // On B; A gets the opposite.
        let up = contact_force * reduced_mass * f64::from(contact.overlap) * f64::from(contact.normal.y);
        match (a, b) {
            (Some(_), None) => borne.up -= up,
            (None, Some(_)) => borne.up += up,
            _ => {}
        }
        borne.virial += up * (height(b) - height(a));
    }
    Ok(borne)
}

/// What the friction impulses of one step do.
pub(crate) struct Rubbed {
    /// The largest friction on a moving sphere over the pressure of all its contacts: at most mu_c, and mu_c where one contact
    /// slides alone.
    pub(crate) ratio: f64,
    /// Upward force of friction on all that moves, by what does not move.
    pub(crate) up: f64,
}

/// An activation threshold above which nothing collides, for scenes with collisions off: then phase 3 alone, which collides
/// whether or not collisions are on, gives the friction impulses and nothing else.
pub(crate) const NOTHING_COLLIDES: f32 = 1e9;

/// Does a step phase by phase, and compares the state before and after phase 3. Spheres alone.
pub(crate) fn rubbed(simulation: &mut Simulation, step: f32) -> Result<Rubbed> {
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
    let mut rubbed = Rubbed { ratio: 0.0, up: 0.0 };
    for ((old, new), pressure) in before.iter().zip(&after).zip(pressures).filter(|((old, _), _)| !old.fixed) {
        let force = f64::from(old.mass) * (new.velocity - old.velocity).as_dvec3() / f64::from(step);
        rubbed.up += force.y;
        // Of a weak one rounding makes anything.
        if pressure > 0.05 {
            rubbed.ratio = rubbed.ratio.max(force.length() / pressure);
        }
    }
    Ok(rubbed)
}

/// Slope and intercept of the line of least squares.
pub(crate) fn line_fit(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / n, y + point.1 / n));
    let (xy, xx) = points.iter().fold((0.0, 0.0), |(xy, xx), point| {
        let dx = point.0 - x;
        (xy + dx * (point.1 - y), xx + dx * dx)
    });
    (xy / xx, y - xy / xx * x)
}

/// The power p of y = a x^p, by a line through the logarithms.
pub(crate) fn power_fit(points: &[(f64, f64)]) -> f64 {
    line_fit(&points.iter().map(|(x, y)| (x.ln(), y.ln())).collect::<Vec<_>>()).0
}

/// Times at which a sampled signal rises through 0, interpolated by a line.
pub(crate) fn rises(samples: &[(f64, f64)]) -> Vec<f64> {
    let pairs = samples.windows(2).filter(|pair| pair[0].1 < 0.0 && pair[1].1 >= 0.0);
    pairs.map(|pair| pair[0].0 + (pair[1].0 - pair[0].0) * pair[0].1 / (pair[0].1 - pair[1].1)).collect()
}

/// The mean period of a sampled signal, from its first to its last rise through 0.
pub(crate) fn period(samples: &[(f64, f64)]) -> f64 {
    let rises = rises(samples);
    match rises[..] {
        [first, .., last] => (last - first) / (rises.len() - 1) as f64,
        _ => f64::NAN,
    }
}

/// Mean of what is given.
pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// `count` points of a curve from `from` to `to`.
pub(crate) fn curve(from: f64, to: f64, count: u32, of: impl Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let place = |k: u32| from + (to - from) * f64::from(k) / f64::from(count - 1);
    (0..count).map(place).map(|x| (x, of(x))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found() {
        let points: Vec<_> = [1.0, 2.0, 4.0].map(|x: f64| (x, 3.0 * x.powi(4))).to_vec();
        assert!((power_fit(&points) - 4.0).abs() < 1e-12);
        assert_eq!(line_fit(&[(0.0, 1.0), (2.0, 5.0)]), (2.0, 1.0));
    }

    #[test]
    fn a_period_is_found() {
        let samples = curve(0.0, 10.0, 1001, |t| (2.0 * t + 0.3).sin());
        assert!((period(&samples) - std::f64::consts::PI).abs() < 1e-4);
        assert!(period(&samples[..10]).is_nan());
    }
}
