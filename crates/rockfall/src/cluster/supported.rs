//! What several processes can simulate together.

use crate::checkpoint::Checkpoint;
use crate::error::{Error, Result};
use crate::settings::Integrator;
use crate::simulation::Simulation;

/// Returns an error that names the first thing in a simulation that several processes cannot share. `state` is its checkpoint.
pub(super) fn check(simulation: &Simulation, state: &Checkpoint) -> Result<()> {
    let Checkpoint { scene, options, .. } = state;
    let counts = scene.counts();
    let refused = [
        (scene.is_rigid(), "the contact law rigid"),
        (counts.bodies > 0, "a scene with rigid bodies"),
        (counts.capsules > 0, "a scene with capsules"),
        (counts.rods > 0, "a scene with rods"),
        (scene.springs().iter().any(|spring| spring.muscle.is_some()), "a scene with muscles"),
        (counts.springs > 0, "a scene with springs"),
        (counts.tethers > 0, "a scene with tethers"),
        (scene.motions().iter().any(|motion| motion.servo.is_some()), "a scene with servos"),
        (scene.inlets().iter().any(|inlet| inlet.shapes().next().is_some()), "a scene with inlets of rigid bodies"),
        (scene.settings.collisions, "a scene with impulses of collisions (without: set collisions off)"),
        (simulation.has_friction_impulses(), "a scene with impulses of friction (without: set coulomb_friction 0)"),
        (simulation.integrator() == Integrator::Rk4, "the integrator rk4"),
        (!options.force_laws.is_empty(), "forces of the program"),
        (options.contact_force_law.is_some(), "a contact law of the program"),
        (options.keep_going, "a simulation that keeps going"),
    ];
    match refused.into_iter().find(|(is_used, _)| *is_used) {
        None => Ok(()),
        Some((_, what)) => Err(Error::Invalid {
            field: "MPI",
            value: what.to_owned(),
            expected: "free spheres among boxes, polygons, smooth walls, meshes and fixed spheres, also in a periodic or sheared box, a law \
                       without impulses, and the integrator symplectic-euler or velocity-verlet on the backend cpu (docs/cluster.md)",
        }),
    }
}
