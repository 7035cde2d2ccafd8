//! Warnings at the end of a run: bodies that sink into each other, and energy that grew without cause.

use rockfall::placement::DEEP;
use rockfall::{Energy, Scene, Simulation, short_number};

use crate::failure::Failure;
use crate::output;

/// Largest growth of the energy that causes no warning, as a share of the energy that took part in the motion.
const GROWTH: f64 = 0.05;
/// Largest error of the potential energy by the rounding of positions, as a share of the energy.
const ROUNDING: f64 = 1e-4;

/// Warns of overlaps and of growing energy. `before` is the energy at the start, unless it cannot be compared with that at the
/// end.
pub(crate) fn warn(name: &str, simulation: &mut Simulation, before: Option<&Energy>) -> Result<(), Failure> {
    let (deepest, integrator) = (simulation.resting_overlap()?, simulation.integrator());
    if let Some(bodies) = deepest.bodies.filter(|_| deepest.radii > DEEP) {
        let scene = simulation.scene();
        let [a, b] = bodies.map(|body| scene.name_of(body));
        let radii = short_number(deepest.radii.into(), 3);
        let remedy = scene.remedy(integrator).map_or_else(String::new, |remedy| format!(": {remedy}"));
        output::note(&format!("warning: {name}: at the end {a} and {b} overlap by {radii} radii of the smaller one{remedy}"));
    }
    let Some(before) = before else { return Ok(()) };
    let after = simulation.energy()?;
    if let Some(growth) = growth(simulation.scene(), before, &after) {
        let [growth, start, end] = [growth, before.total(), after.total()].map(|energy| short_number(energy, 5));
        output::note(&format!(
            "warning: {name}: the energy grew by {growth} (mass units x units²/s²), from {start} to {end}, without a cause in the \
             scene: the time step is too long, see `rockfall check`"
        ));
    }
    Ok(())
}

/// How much the energy grew, if that is too much and nothing in the scene explains it.
///
/// Moving surfaces (fixed spheres with a velocity or a spin), external forces, muscles and a restitution of more than 1 do work.
/// Without them the energy can only fall. Integrators and late contacts make errors, which are measured by the energy that took part in
/// the motion: the kinetic, spring and contact energy at the start, what bodies fell, and 1 % of the weights times the radii.
fn growth(scene: &Scene, before: &Energy, after: &Energy) -> Option<f64> {
    let settings = &scene.settings;
    let surfaces = scene.spheres().iter().any(|sphere| {
        sphere.fixed && (sphere.velocity.length_squared() > 0.0 || sphere.angular_momentum.length_squared() > 0.0)
    });
    let forces = scene.spheres().iter().any(|sphere| sphere.force.length_squared() > 0.0);
    let muscles = scene.springs().iter().any(|spring| spring.muscle.is_some());
    if surfaces || forces || muscles || settings.restitution > 1.0 {
        return None;
    }
    let movers = scene.spheres().iter().filter(|sphere| !sphere.fixed);
    let weights: f64 = movers.map(|sphere| f64::from(sphere.mass) * f64::from(sphere.radius)).sum();
    let fallen = (before.potential - after.potential).max(0.0);
    let moved = before.kinetic + before.spring + before.contact + fallen + 0.2 * weights * f64::from(settings.gravity.abs());
    let allowed = GROWTH * moved + ROUNDING * before.potential.abs().max(after.potential.abs());
    let growth = after.total() - before.total();
    // An energy that is not finite has grown, too.
    (growth > allowed || growth.is_nan()).then_some(growth)
}
