//! The memory of the CPU backend can be left to another owner.

use rockfall::{Backend, Options, Scene, Simulation, Sphere};

fn simulation(backend: Backend) -> Simulation {
    let mut scene = Scene::new();
    for place in 0..3 {
        scene.add_sphere(Sphere::new([place as f32, 5.0, 0.0], 0.3)).unwrap();
    }
    Simulation::with_options(scene, Options::new().backend(backend)).unwrap()
}

#[test]
fn replaced_memory_keeps_its_address_and_its_values() {
    let mut simulation = simulation(Backend::Cpu);
    let address = simulation.cpu_view().unwrap().states[0].as_ptr();
    let [state, orientations] = simulation.replace_cpu_state().unwrap();
    // Positions, velocities, angular momenta and low parts of positions, of three spheres each.
    assert_eq!((state.as_ptr(), state.len(), orientations.len()), (address, 12, 3));
    let before = state.clone();
    simulation.run(20, 0.02).unwrap();
    assert_eq!(state, before);
    let world = simulation.cpu_view().unwrap();
    assert_ne!(world.states[0].as_ptr(), address);
    assert_ne!(world.states[0], before);
}

#[test]
fn replacing_memory_does_not_change_the_steps() {
    let [mut one, mut other] = [simulation(Backend::Cpu), simulation(Backend::Cpu)];
    for _ in 0..10 {
        one.step(0.02).unwrap();
        other.step(0.02).unwrap();
        other.replace_cpu_state();
    }
    assert_eq!(one.spheres().unwrap(), other.spheres().unwrap());
}
