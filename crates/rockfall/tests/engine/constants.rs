//! A constant that changes while a simulation runs takes effect, on both backends.

use rockfall::{Backend, Cuboid, Integrator, Material, Options, Pair, Polygon, Settings, Simulation, Sphere};

/// Another value of every constant. A name without one fails the test.
fn other_value(name: &str) -> &'static str {
    match name {
        "activation_threshold" => "8",
        "restitution" => "0.2",
        "contact_damping" => "3",
        "contact_force" => "500",
        "friction" => "400",
        "coulomb_friction" | "collision_friction" => "0.4",
        "gravity" => "4",
        "collisions" => "off",
        "gravity_direction" => "0.6,-0.8,0",
        "continuous_collisions" => "on",
        "contact_pull" => "on",
        "resting_overlap" => "0.01",
        "mesh_angle" => "5",
        "linear_damping" | "angular_damping" => "0.5",
        "contact_law" => "linear",
        "precision" => "double",
        _ => panic!("no other value for {name}"),
    }
}

/// Balls that spin and slide on a floor, hit each other and part, and two that overlap with the floor by more than at rest: they are
/// pushed out, so that damping may pull. A small one flies past a thin post. Every constant matters to some of them.
fn scene(law: &str) -> rockfall::Scene {
    let mut scene = rockfall::Scene::new();
    scene.settings.set("contact_law", law).expect("a contact law");
    // The contact law `linear` needs a stiffness. The pair has no other property, so the constants of the scene hold.
    let material = scene.add_material(Material::new("plain")).expect("a valid material");
    scene.set_pair(material, material, Pair::default().stiffness(300.0)).expect("a valid pair");
    let floor = Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]).material(material);
    scene.add_box(floor).expect("a valid box");
    for k in 0..6_u8 {
        let (x, y) = (1.1 * f32::from(k % 3), 0.5 + 1.2 * f32::from(k / 3));
        let ball = Sphere::new([x, y, 0.01 * f32::from(k)], 0.5).velocity([2.0 - 1.5 * f32::from(k % 2), -1.0, 0.5]);
        scene.add_sphere(ball.angular_momentum([0.1, 0.2, -0.3]).material(material)).expect("a valid sphere");
    }
    // It flies past this post within a step.
    scene.add_box(Cuboid::between([-0.01, 2.9, -0.01], [0.01, 3.5, 0.01]).material(material)).expect("a valid box");
    scene
        .add_sphere(Sphere::new([-1.3, 3.2, 0.0], 0.05).velocity([20.0, 0.0, 0.2]).material(material))
        .expect("a valid sphere");
    // A ball in a hollow edge of two triangles, whose normals differ by 8 degrees.
    for side in [-1.0, 1.0] {
        let triangle = Polygon::triangle([0.0, 4.5, -4.0], [0.0, 4.5, -2.0], [side, 4.57, -3.0]).material(material);
        scene.add_polygon(triangle).expect("a valid triangle");
    }
    scene.add_sphere(Sphere::new([0.005, 4.99, -3.0], 0.5).material(material)).expect("a valid sphere");
    for (x, overlap) in [(-4.0, 0.004), (-2.5, 0.002)] {
        scene
            .add_sphere(Sphere::new([x, 0.5 - overlap, 3.0], 0.5).velocity([0.3, 0.0, 0.0]).material(material))
            .expect("a valid sphere");
    }
    scene
}

fn states(simulation: &mut Simulation) -> Vec<[u32; 9]> {
    let states = simulation.spheres().expect("states");
    let numbers = |state: &rockfall::SphereState| [state.position, state.velocity, state.angular_momentum];
    states.iter().map(|state| std::array::from_fn(|k| numbers(state)[k / 3][k % 3].to_bits())).collect()
}

/// The same bits come of a constant that is changed between two steps and of a simulation that begins there with the other value.
fn every_constant_takes_effect_while_running(backend: Backend) {
    take_effect(backend, "thesis", Settings::NAMES.to_vec());
}

fn take_effect(backend: Backend, law: &str, names: Vec<&str>) {
    // The laws with history need this integrator.
    let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler);
    let mut unchanged = Simulation::with_options(scene(law), options.clone()).expect("a simulation");
    unchanged.run(4, 0.01).expect("steps");
    let checkpoint = unchanged.checkpoint().expect("a checkpoint");
    unchanged.run(30, 0.01).expect("steps");
    let unchanged = states(&mut unchanged);
    for name in names {
        let mut changed = Simulation::with_options(scene(law), options.clone()).expect("a simulation");
        changed.run(4, 0.01).expect("steps");
        let mut settings = *changed.settings();
        settings.set(name, other_value(name)).expect("a valid value");
        changed.set_settings(settings).expect("valid settings");
        // With the contact force that `resting_overlap` chose; a simulation that is resumed keeps it.
        let settings = *changed.settings();
        changed.run(30, 0.01).expect("steps");
        let changed = states(&mut changed);
        assert_ne!(changed, unchanged, "{name} has no effect");
        let mut begun = checkpoint.clone();
        begun.scene.settings = settings;
        let mut begun = Simulation::resume(begun).expect("a simulation");
        begun.run(30, 0.01).expect("steps");
        assert_eq!(states(&mut begun), changed, "{name} changed while running and before");
    }
}

both!(every_constant_takes_effect_while_running);
