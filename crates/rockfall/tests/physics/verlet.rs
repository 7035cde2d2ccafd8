//! Velocity Verlet (docs/physics section 5.7) against closed forms.

mod edits;
mod order;
mod oscillators;

use rockfall::glam::DVec3;
use rockfall::{Backend, Integrator, Options, Scene, Simulation, SphereId};

pub(crate) fn simulation(scene: Scene, backend: Backend, integrator: Integrator) -> Simulation {
    let options = Options::new().backend(backend).integrator(integrator);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

pub(crate) fn verlet(scene: Scene, backend: Backend) -> Simulation {
    simulation(scene, backend, Integrator::VelocityVerlet)
}

/// Position and velocity of a sphere.
pub(crate) fn state(simulation: &mut Simulation, id: SphereId) -> [DVec3; 2] {
    let sphere = simulation.sync().expect("the state").sphere(id).expect("the sphere");
    [sphere.position, sphere.velocity].map(|vector| vector.as_dvec3())
}
