//! The way of a creature, in a simulation of its own.

use rockfall::glam::DVec3;
use rockfall::{Backend, Options, Scene, Simulation};

fn centre(simulation: &mut Simulation) -> DVec3 {
    let states = simulation.spheres().unwrap();
    states.iter().map(|state| state.position.as_dvec3()).sum::<DVec3>() / states.len() as f64
}

/// Distance of the centre along the ground from one step to another, in units, on the CPU with RK4.
pub(crate) fn distance(scene: &Scene, dt: f32, from: u64, to: u64) -> f64 {
    distance_after(scene, |_| {}, dt, from, to)
}

/// The same distance after a change of the start.
pub(crate) fn distance_after(scene: &Scene, change: impl FnOnce(&mut Simulation), dt: f32, from: u64, to: u64) -> f64 {
    let mut simulation = Simulation::with_options(scene.clone(), Options::new().backend(Backend::Cpu)).unwrap();
    change(&mut simulation);
    simulation.run(from, dt).unwrap();
    let start = centre(&mut simulation);
    simulation.run(to - from, dt).unwrap();
    let way = centre(&mut simulation) - start;
    way.x.hypot(way.z)
}
