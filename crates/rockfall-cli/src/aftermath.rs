//! Warnings after a run: bodies that sink into each other, and energy that grew without cause.

use rockfall::placement::DEEP;
use rockfall::stability::Remedy;
use rockfall::{Body, Energy, Integrator, Passage, Precision, Scene, Simulation, short_number};

use crate::failure::Failure;
use crate::output;

/// Largest growth of the energy that causes no warning, as a share of the energy that took part in the motion.
const GROWTH: f64 = 0.05;
/// Largest error of the potential energy by the rounding of positions, as a share of the energy.
const ROUNDING: f64 = 1e-4;

/// Energy that grew without a cause in the scene.
pub(crate) struct Growth {
    /// By how much, in mass units x units²/s².
    pub(crate) size: f64,
    /// A message that names likely causes.
    pub(crate) message: String,
}

/// The growth of the energy, if it is too large and nothing in the scene explains it. `before` is the energy
/// at the start, unless it cannot be compared with that at the end.
pub(crate) fn grown(name: &str, simulation: &mut Simulation, before: Option<&Energy>) -> Result<Option<Growth>, Failure> {
    let Some(before) = before else { return Ok(None) };
    let after = simulation.energy()?;
    let Some(size) = growth(simulation.scene(), before, &after) else { return Ok(None) };
    let causes = causes(simulation, before);
    let message = format!(
        "{name}: the energy grew by {size:.4e} (mass units x units²/s²), from {:.4e} to {:.4e}, without a cause in the scene; {causes}",
        before.total(),
        after.total()
    );
    Ok(Some(Growth { size, message }))
}

/// Likely causes of a growing energy, with a remedy for each.
fn causes(simulation: &Simulation, before: &Energy) -> String {
    let (scene, dt, integrator) = (simulation.scene(), simulation.time_step(), simulation.integrator());
    let mut causes = Vec::new();
    if !scene.stability(dt, integrator).is_empty() || scene.law_times().iter().any(|time| time.is_exceeded_by(dt)) {
        causes.push("the time step is too long (see rockfall check)");
    }
    if scene.settings.precision == Precision::Single && needs_double(scene) {
        causes.push("positions are too coarse for the overlaps (set precision auto)");
    }
    if before.contact > 0.0 {
        causes.push("bodies overlap at the start (see rockfall check)");
    }
    if integrator == Integrator::SymplecticEuler && scene.settings.collisions && !scene.springs().is_empty() {
        causes.push("symplectic-euler keeps the energy of springs in collisions roughly (use rk4 or velocity-verlet)");
    }
    if scene.polygons().len() + scene.boxes().len() > 1 {
        causes.push("bodies rolled or slid over the seam of two boxes or polygons, which pushes them twice (use one of them)");
    }
    match causes.as_slice() {
        [] => "try a shorter time step".to_owned(),
        [one] => format!("likely cause: {one}"),
        several => format!("likely causes: {}", several.join("; ")),
    }
}

/// Warns of overlaps and of growing energy after `step` steps.
#[cfg(feature = "view")]
pub(crate) fn warn(name: &str, simulation: &mut Simulation, before: Option<&Energy>, step: u64) -> Result<(), Failure> {
    warn_of_overlaps(name, simulation, step)?;
    warn_of_passages(name, simulation, 1);
    if let Some(Growth { message, .. }) = grown(name, simulation, before)? {
        output::note(&format!("warning: {message}"));
    }
    Ok(())
}

/// Whether `precision auto` would choose double precision.
fn needs_double(scene: &Scene) -> bool {
    let mut chosen = scene.clone();
    chosen.settings.precision = Precision::Auto;
    chosen.chosen_precision().precision == Precision::Double
}

/// Warns of overlaps after `step` steps.
pub(crate) fn warn_of_overlaps(name: &str, simulation: &mut Simulation, step: u64) -> Result<(), Failure> {
    let (deepest, integrator) = (simulation.resting_overlap()?, simulation.integrator());
    if let Some(bodies) = deepest.bodies.filter(|_| deepest.radii > DEEP) {
        let scene = simulation.scene();
        let [a, b] = bodies.map(|body| scene.name_of(body));
        let radii = short_number(deepest.radii.into(), 3);
        let settings = &scene.settings;
        // Constants that are as stiff already are no remedy.
        let helps = |remedy: &Remedy| settings.resting_overlap == 0.0 && remedy.contact_force > settings.contact_force;
        let remedy = scene.remedy(integrator).filter(helps).map_or_else(String::new, |remedy| format!(": {remedy}"));
        output::note(&format!(
            "warning: {name}: at step {step} {a} and {b} overlap by {radii} radii of the smaller one{remedy}"
        ));
    }
    Ok(())
}

/// Warns of spheres that have passed walls. `parts` is the number of parts of a step, which the simulation counts as steps.
pub(crate) fn warn_of_passages(name: &str, simulation: &Simulation, parts: u64) {
    let report = simulation.report();
    let Some(Passage { sphere, step }) = report.first_passage else { return };
    let scene = simulation.scene();
    // Where spheres come and go, another one may have its number.
    let keeps_numbers = scene.inlets().is_empty() && scene.outlets().is_empty();
    let id = scene.sphere_ids().nth(sphere).filter(|_| keeps_numbers);
    let sphere = id.map_or_else(|| format!("sphere number {sphere}"), |id| scene.name_of(Body::Sphere(id)));
    let times = if report.passages == 1 { "once".to_owned() } else { format!("{} times", report.passages) };
    output::note(&format!(
        "warning: {name}: the centre of a sphere passed a polygon, triangle or plane {times}, first that of {sphere} in step {}; \
         try a smaller dt, a stiffer contact law, or boxes as thick as the impacts are deep",
        step.div_ceil(parts.max(1))
    ));
}

/// How much the energy grew, if that is too much and nothing in the scene explains it.
///
/// Moving surfaces (fixed spheres with a velocity or a spin, walls that follow motions, conveyors), a shear, external forces, muscles and a restitution of more than 1 do work, and
/// spheres that come and go have an energy.
/// Without them the energy can only fall. Integrators and late contacts make errors, which are measured by the energy that took part in
/// the motion: the kinetic, spring and contact energy at the start, what bodies fell, and 1 % of the weights times the radii.
fn growth(scene: &Scene, before: &Energy, after: &Energy) -> Option<f64> {
    let settings = &scene.settings;
    let surfaces = scene.spheres().iter().any(|sphere| {
        sphere.fixed && (sphere.velocity.length_squared() > 0.0 || sphere.angular_momentum.length_squared() > 0.0)
    });
    let belts = scene.boxes().iter().map(|cuboid| (cuboid.motion, cuboid.surface_velocity));
    let mut belts = belts.chain(scene.polygons().iter().map(|polygon| (polygon.motion, polygon.surface_velocity)));
    let drives = belts.any(|(motion, surface)| motion.is_some() || surface.length_squared() > 0.0) || scene.shear().is_some();
    let forces = scene.spheres().iter().any(|sphere| sphere.force.length_squared() > 0.0);
    let muscles = scene.springs().iter().any(|spring| spring.muscle.is_some());
    let comes_and_goes = !(scene.inlets().is_empty() && scene.outlets().is_empty());
    let driven = scene.joints().iter().any(|joint| joint.speed.is_some() || joint.stiffness > 0.0);
    if surfaces || drives || forces || muscles || driven || comes_and_goes || settings.restitution > 1.0 {
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
