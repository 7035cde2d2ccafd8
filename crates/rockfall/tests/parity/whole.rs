//! Compares both backends through the public API, over 20 steps of a well-conditioned scene.

use rockfall::{
    Backend, Capsule, Cuboid, Integrator, Options, Polygon, Rod, Scene, Simulation, Sphere, SphereState, Spring, Tether,
};

/// A scene with few contacts and no ambiguous decisions: each sphere that bounces does so once, at well above the threshold
/// velocity.
fn scene() -> Scene {
    let mut scene = Scene::new();
    scene.add_box(Cuboid::between((-4.0, -1.0, -4.0), (4.0, 0.0, 4.0))).unwrap();
    scene.add_polygon(Polygon::new((5.0, 0.0, -4.0), (0.0, 0.0, 8.0), (8.0, 0.3, 0.0))).unwrap();
    scene.add_sphere(Sphere::new((-3.0, 0.53, 0.0), 0.5).velocity((0.7, -2.0, 0.2))).unwrap();
    scene.add_sphere(Sphere::new((8.0, 0.7, 0.0), 0.5).velocity((0.0, -2.0, 0.3))).unwrap();
    let ends = [(0.0, 3.0, 0.0), (1.0, 3.2, 0.1), (2.0, 3.1, 0.0)]
        .map(|place| scene.add_sphere(Sphere::new(place, 0.2).mass(0.8)).unwrap());
    scene.add_rod(Rod::new(ends[0], ends[1], 0.1).length(1.02)).unwrap();
    scene.add_rod(Rod::new(ends[1], ends[2], 0.1).length(1.0)).unwrap();
    scene.add_spring(Spring::new(ends[2], ends[0], 15.0, 1.5).damping(0.3)).unwrap();
    scene.add_tether(Tether::new(ends[0], (0.0, 4.0, 0.0), 20.0).length(0.5)).unwrap();
    scene.add_sphere(Sphere::new((0.55, 4.0, 0.1), 0.3).velocity((0.0, -5.0, 0.0))).unwrap();
    scene.add_capsule(Capsule::new((-2.0, 2.0, 2.0), (-1.0, 2.1, 2.0), 0.2).velocity((0.3, 0.0, 0.0))).unwrap();
    scene
}

fn run(backend: Backend, integrator: Integrator) -> (Simulation, Vec<SphereState>) {
    let options = Options::new().backend(backend).integrator(integrator);
    let mut simulation = Simulation::with_options(scene(), options).expect("lavapipe is enough");
    simulation.run(20, 0.01).unwrap();
    let spheres = simulation.spheres().unwrap();
    (simulation, spheres)
}

/// Rounding differs from the first step on, and a bounce amplifies the difference only a little. The tolerance for positions is
/// about a hundred units in the last place, for coordinates of up to 10 units. Velocities get a larger tolerance, because
/// contact forces are a thousand times the overlap.
#[test]
fn both_backends_agree_over_twenty_steps() {
    for integrator in Integrator::ALL {
        let (cpu, cpu_spheres) = run(Backend::Cpu, integrator);
        let (gpu, gpu_spheres) = run(Backend::Gpu, integrator);
        assert_eq!((cpu.backend().kind, gpu.backend().kind), (Backend::Cpu, Backend::Gpu));
        assert_eq!(cpu.report().total_collisions, gpu.report().total_collisions);
        assert!(cpu.report().total_collisions >= 3, "{:?}", cpu.report());
        for (c, g) in cpu_spheres.iter().zip(&gpu_spheres) {
            assert!(c.position.distance(g.position) < 1e-4, "{c:?}\n{g:?}");
            assert!(c.velocity.distance(g.velocity) < 2e-3, "{c:?}\n{g:?}");
            assert!(c.angular_momentum.distance(g.angular_momentum) < 2e-4, "{c:?}\n{g:?}");
            assert!(c.orientation.dot(g.orientation).abs() > 1.0 - 1e-5, "{c:?}\n{g:?}");
        }
    }
}
