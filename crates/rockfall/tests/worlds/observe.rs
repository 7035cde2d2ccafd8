//! What is found out about a world is what its own simulation finds.

use rockfall::generate::{Kind, creature};
use rockfall::{Backend, Energy, Integrator, Options, Scene, Simulation, Worlds};

const DT: f32 = 0.005;

fn scenes() -> Vec<Scene> {
    vec![
        creature(12, 0).expect("a creature"),
        Kind::Chain.generate(7, 1).expect("a scene"),
        creature(8, 1).expect("a creature"),
    ]
}

fn numbers(energy: &Energy) -> Vec<f64> {
    let momenta = [energy.momentum, energy.angular_momentum].into_iter().flat_map(|vector| vector.to_array());
    [energy.kinetic, energy.potential, energy.spring, energy.contact].into_iter().chain(momenta).collect()
}

fn a_world_is_observed_as_a_simulation(backend: Backend) {
    let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler);
    let mut worlds = Worlds::new(scenes(), options.clone()).expect("worlds");
    assert_eq!(worlds.time_step(), 0.02);
    worlds.run(150, DT).expect("steps");
    assert_eq!(worlds.time_step(), DT);
    let energies = worlds.energies().expect("energies");
    assert_eq!(energies.len(), 3);
    let mut touching = 0;
    for (world, scene) in scenes().into_iter().enumerate() {
        let mut own = Simulation::with_options(scene, options.clone()).expect("a simulation");
        own.run(150, DT).expect("steps");
        assert_eq!(numbers(&energies[world]), numbers(&own.energy().expect("an energy")), "world {world}");
        let (found, expected) = (worlds.contacts(world).expect("contacts"), own.contacts().expect("contacts"));
        let shown = |contacts: &[rockfall::Contact]| {
            contacts
                .iter()
                .map(|contact| format!("{:?} {} {:?}", contact.point, contact.overlap, contact.action))
                .collect::<Vec<_>>()
        };
        assert_eq!(shown(&found), shown(&expected), "world {world}");
        touching += found.len();
        let mut alone = Simulation::resume(worlds.checkpoint(world).expect("a checkpoint")).expect("a simulation");
        assert_eq!((alone.backend().kind, alone.report().steps), (backend, 150));
        for simulation in [&mut alone, &mut own] {
            simulation.run(50, DT).expect("steps");
        }
        assert_eq!(alone.spheres().expect("states"), own.spheres().expect("states"), "world {world}");
    }
    assert!(touching > 0, "no world has a contact");
    assert!(worlds.contacts(3).is_err() && worlds.checkpoint(3).is_err() && worlds.set_time_step(0.0).is_err());
}

both_in_turn!(a_world_is_observed_as_a_simulation);
