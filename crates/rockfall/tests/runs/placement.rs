//! Overlaps of initial positions, overlaps at rest, and searches for contacts near the limits of f32.

use rockfall::placement::Inside;
use rockfall::{Backend, Body, Cuboid, Integrator, Options, Scene, Simulation, Sphere};

fn simulation(scene: Scene) -> Simulation {
    Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).unwrap()
}

#[test]
fn overlaps_are_measured_in_radii_of_the_smaller_body() {
    let mut scene = Scene::new();
    let small = scene.add_sphere(Sphere::new([0.0; 3], 0.1)).unwrap();
    let large = scene.add_sphere(Sphere::new([1.05, 0.0, 0.0], 1.0)).unwrap();
    scene.add_sphere(Sphere::new([0.0, 5.0, 0.0], 0.1).fixed()).unwrap();
    scene.add_sphere(Sphere::new([0.0, 5.0, 0.0], 0.1).fixed()).unwrap();
    scene.add_sphere(Sphere::new([0.0; 3], 0.1).group(3)).unwrap();
    let found = scene.placement().unwrap();
    assert_eq!(found.overlaps.len(), 1, "fixed spheres and other groups do not count");
    let overlap = found.overlaps[0];
    assert_eq!((overlap.bodies, overlap.what), ([Body::Sphere(small), Body::Sphere(large)], Inside::Surface));
    assert!((overlap.radii - 0.5).abs() < 1e-5 && (overlap.units - 0.05).abs() < 1e-6, "{overlap:?}");
    assert_eq!(overlap.radii, found.deepest);
}

/// A ball at rest on a floor overlaps it by gravity / contact_force; a ball in flight over the same floor does not rest.
#[test]
fn only_bodies_at_rest_have_a_resting_overlap() {
    for (speed, expected) in [(0.0, 0.1), (-3.0, 0.0)] {
        let mut scene = Scene::new();
        scene.settings.gravity = 10.0;
        scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])).unwrap();
        scene.add_sphere(Sphere::new([0.0, 0.09, 0.0], 0.1).velocity([0.0, speed, 0.0])).unwrap();
        let mut simulation = simulation(scene);
        let [resting, any] = [simulation.resting_overlap().unwrap(), simulation.max_overlap().unwrap()];
        assert!((resting.radii - expected).abs() < 1e-5 && (any.radii - 0.1).abs() < 1e-5, "{resting:?} {any:?}");
    }
}

/// The square of the margin of the AABB exceeds f32, so the body seems to be outside its own AABB.
#[test]
fn the_search_for_contacts_ends_near_the_limits_of_f32() {
    let mut scene = Scene::new();
    scene.add_sphere(Sphere::new([1e20, 3e18, 0.0], 0.1).velocity([1e18, 3e17, 7e17])).unwrap();
    scene.add_sphere(Sphere::new([0.0; 3], 0.1)).unwrap();
    let mut simulation = simulation(scene);
    for dt in [1e9, 1e12, 1e16] {
        simulation.set_time_step(dt).unwrap();
        assert_eq!(simulation.energy().unwrap().contact, 0.0);
    }
}

/// The suggestion causes no warning, and only what is needed changes.
#[test]
fn a_suggestion_removes_every_warning() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        let mut scene = Scene::new();
        scene.settings.gravity = 9.81;
        scene.add_box(Cuboid::between([-1.0, -0.1, -1.0], [1.0, 0.0, 1.0])).unwrap();
        for ball in 0..10 {
            scene.add_sphere(Sphere::new([0.1 * ball as f32 - 0.5, 2.0, 0.0], 0.04)).unwrap();
        }
        assert!(scene.concerns(0.02, integrator).len() >= 2);
        let suggestion = scene.suggestion(0.02, integrator).unwrap();
        scene.settings.resting_overlap = suggestion.resting_overlap.unwrap();
        assert_eq!(scene.concerns(suggestion.time_step, integrator), Vec::<String>::new());
        assert_eq!(scene.suggestion(suggestion.time_step, integrator), None);
        // It has a margin: 10 to 18 % longer steps cause no warning either.
        let longer = |factor: f32| scene.concerns(factor * suggestion.time_step, integrator);
        assert_eq!(longer(1.1), Vec::<String>::new());
        assert_ne!(longer(1.24), Vec::<String>::new());
        assert_eq!(scene.resolved_settings().contact_force, suggestion.contact_force);
    }
}

/// A body on a hinge of the world hangs, and what hangs on it does, too. A body that no joint holds falls, and is named once.
#[test]
fn bodies_that_joints_hold_do_not_fall_for_ever() {
    let text = "set contact_law rigid\nset gravity 9.81\n@body bar mass=2\nB 0 0 0 1 0 0 0 0.1 0 0 0 0.1\n@end\n\
                @place bar at=0,0,0 name=one\n@place bar at=1,0,0 name=two\n@place bar at=5,0,0 name=three\n@place bar at=60,0,0\n\
                @joint hinge world one at=0,0,0 axis=0,0,1\n@joint ball one two at=1,0,0\n@joint ball three two at=5,0,0\n";
    let scene = Scene::parse(text, std::path::Path::new("chain.txt")).unwrap().scene;
    let falling = scene.placement().unwrap().falling;
    let bodies: Vec<_> = falling.into_iter().map(|sphere| scene.body_of_sphere(sphere)).collect();
    assert_eq!(bodies, [scene.body_ids().last()]);
}
