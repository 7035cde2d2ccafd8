//! How a scene is run: what its line `@run` says, and the integrator that follows from its contact law.

use std::path::Path;

use rockfall::{Backend, Integrator, IntegratorChoice, Options, Scene, Simulation, WorldPath, Worlds};

/// A grain on a floor, with Hertz's law.
const GRAIN: &str = "set contact_law hertz-mindlin\nset gravity 9.81\n@material glass density=2500 young=5e7 poisson=0.2\n@use glass\n\
                     B -1 -1 -1 2 0 0 0 1 0 0 0 2\nS 1 0 0.0101 0 0 -0.5 0 0 0 0 - 0.01\n";
const BALL: &str = "S 1 0 0 0 0 0 0 0 0 0 1 0.5\n";

fn scene(text: &str) -> Scene {
    Scene::parse(text, Path::new("scene.txt")).unwrap().scene
}

fn cpu() -> Options {
    Options::new().backend(Backend::Cpu)
}

#[test]
fn the_integrator_follows_the_contact_law() {
    for (text, expected) in [(GRAIN, Integrator::VelocityVerlet), (BALL, Integrator::Rk4)] {
        let mut simulation = Simulation::with_options(scene(text), cpu()).unwrap();
        assert_eq!(simulation.integrator(), expected);
        simulation.run(5, 1e-5).unwrap();
        // A choice that is made again from another scene could be another one.
        let checkpoint = simulation.checkpoint().unwrap();
        assert_eq!(checkpoint.options.integrator, IntegratorChoice::Given(expected));
        let given = Simulation::with_options(scene(text), cpu().integrator(expected)).map(|mut given| {
            given.run(5, 1e-5).unwrap();
            given.spheres().unwrap()
        });
        assert_eq!(given.unwrap(), simulation.spheres().unwrap());
    }
    let euler = Simulation::with_options(scene(GRAIN), cpu().integrator(Integrator::SymplecticEuler)).unwrap();
    assert_eq!(euler.integrator(), Integrator::SymplecticEuler);
    let error = Simulation::with_options(scene(GRAIN), cpu().integrator(Integrator::Rk4)).map(drop).unwrap_err();
    assert!(error.to_string().contains("hertz-mindlin with the integrator rk4"), "{error}");
}

/// The integrator of a simulation stays when its law changes to one that allows every integrator.
#[test]
fn the_integrator_stays_when_the_law_changes() {
    let mut simulation = Simulation::with_options(scene(GRAIN), cpu()).unwrap();
    let mut settings = *simulation.settings();
    settings.set("contact_law", "thesis").unwrap();
    simulation.set_settings(settings).unwrap();
    assert_eq!(simulation.integrator(), Integrator::VelocityVerlet);
    simulation.run(3, 1e-4).unwrap();
}

#[test]
fn each_world_has_the_integrator_of_its_law() {
    let mut worlds = Worlds::new([scene(BALL), scene(GRAIN)], cpu()).unwrap();
    assert_eq!([0, 1].map(|world| worlds.integrator(world).unwrap()), [Integrator::Rk4, Integrator::VelocityVerlet]);
    worlds.run(5, 1e-5).unwrap();
    let resumed = Worlds::from_bytes(&worlds.to_bytes().unwrap(), "worlds.rkw", None).unwrap();
    assert_eq!(resumed.integrator(1).unwrap(), Integrator::VelocityVerlet);
    worlds.replace(0, scene(GRAIN)).unwrap();
    assert_eq!(worlds.integrator(0).unwrap(), Integrator::VelocityVerlet);
    assert!(Worlds::new([scene(GRAIN)], cpu().integrator(Integrator::Rk4)).is_err());
}

/// Options override what the scene says, one by one.
#[test]
fn a_scene_says_how_it_is_run() {
    let text = format!("{BALL}@run dt=0.004 integrator=symplectic-euler substeps=4\n");
    let mut simulation = Simulation::with_options(scene(&text), cpu()).unwrap();
    assert_eq!((simulation.integrator(), simulation.time_step()), (Integrator::SymplecticEuler, 0.001));
    assert_eq!(simulation.snapshot().unwrap().run, scene(&text).run);
    let given = Simulation::with_options(scene(&text), cpu().integrator(Integrator::VelocityVerlet)).unwrap();
    assert_eq!(given.integrator(), Integrator::VelocityVerlet);
}

/// Worlds with another integrator than that of the workgroups run by themselves, with the same results.
#[test]
#[cfg(feature = "gpu")]
fn worlds_on_a_gpu_may_have_different_integrators() {
    let plain = "set collisions off\nset gravity 3\nB -2 -1 -2 4 0 0 0 1 0 0 0 4\nS 1 0 0.6 0 1 0 0 0 0 0 1 0.5\n";
    let euler = format!("{plain}@run integrator=symplectic-euler\n");
    let options = || Options::new().backend(Backend::Gpu);
    for texts in [[plain, &euler], [&euler, plain]] {
        let mut worlds = Worlds::new([scene(plain)], options()).unwrap();
        worlds.replace_all(texts.map(scene)).unwrap();
        worlds.run(40, 0.01).unwrap();
        let paths = [0, 1].map(|world| worlds.report(world, None).unwrap().path);
        assert_eq!(paths, [WorldPath::Device, WorldPath::Simulation]);
        for (world, text) in texts.iter().enumerate() {
            let mut alone = Simulation::with_options(scene(text), options()).unwrap();
            alone.run(40, 0.01).unwrap();
            assert_eq!(worlds.integrator(world).unwrap(), alone.integrator());
            assert_eq!(worlds.states(world).unwrap(), alone.spheres().unwrap(), "{text}");
        }
    }
}
