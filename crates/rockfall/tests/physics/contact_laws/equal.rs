//! Laws of the program against the laws that rockfall has, against closed forms, and on both backends.

use super::*;

both!(
    built_in_laws_are_equalled,
    square_law_gives_the_time_and_the_depth_of_its_closed_form,
    parameters_belong_to_pairs_of_materials,
    runs_do_not_depend_on_how_pairs_are_found,
);

/// The laws `linear` and `hertz-mindlin`, written as laws of the program, with friction and resistances. Without damping only rounding
/// differs. The damping is found by trial impacts, to some 1e-4.
fn built_in_laws_are_equalled(backend: Backend) {
    let (steps, dt) = crate::common::on(backend, (800, 2.5e-4), (200, 5e-4));
    let laws = [(ContactLaw::Linear, linear()), (ContactLaw::HertzMindlin, hertz())];
    for (law, mut own, restitution, bound) in
        laws.into_iter().flat_map(|(law, own)| [(law, own.clone(), 1.0, 1e-5), (law, own, 0.6, 1e-4)])
    {
        if restitution < 1.0 {
            own.set_parameter("g", damping_for(&own, restitution)).expect("a parameter");
        }
        let own = crate::common::on(backend, own.clone(), without_function(&own));
        let scene = tumble(law, restitution as f32);
        let mut expected = Simulation::with_options(scene.clone(), options(backend)).expect("the simulation opens");
        let mut found = open(&scene, backend, own);
        assert_eq!(found.settings().contact_law, ContactLaw::User);
        for simulation in [&mut expected, &mut found] {
            simulation.run(steps, dt).expect("steps");
        }
        let off = difference(&mut expected, &mut found);
        assert!(off < bound, "{law}, restitution {restitution}: {off}");
        let moved = found.spheres().expect("spheres")[0].position.distance(scene.spheres()[0].position);
        assert!(moved > 0.02, "{law}: the balls move by {moved}");
        let energies = [&mut expected, &mut found].map(|simulation| simulation.energy().expect("energy"));
        let [one, other] = energies.map(|energy| energy.contact);
        assert!((one - other).abs() < 100.0 * f64::from(bound) * one.abs().max(1e-3), "{law}: contact energies {one}, {other}");
    }
}

/// F = k d²: by energy, the depth is d = (3 m* v² / (2 k))^(1/3), and the time is 2 d/v times the integral of
/// (1 - s³)^(-1/2) from 0 to 1, which is 1.40218. Velocity Verlet, no damping.
fn square_law_gives_the_time_and_the_depth_of_its_closed_form(backend: Backend) {
    let (k, speed, mass) = (1e6_f64, 1.0_f64, 1.0_f64);
    let law = ContactForceLaw::new("square").parameter("k", k as f32).wgsl("normal_force = k * overlap * overlap;");
    let depth = (3.0 * mass * speed * speed / (2.0 * k)).cbrt();
    let seconds = 2.0 * depth / speed * 1.402_182;
    let mut contact = ContactInput::default();
    (contact.radius, contact.mass, contact.speed) = (0.05, mass as f32, speed as f32);
    let found = law.impact(&contact).expect("a valid law").expect("a rebound");
    for (found, expected) in [(found.overlap, depth), (found.seconds, seconds), (found.restitution, 1.0)] {
        assert!((found / expected - 1.0).abs() < 2e-3, "impact: {found}, expected {expected}");
    }
    let options = options(backend).integrator(Integrator::VelocityVerlet).contact_force_law(law);
    let mut simulation = Simulation::with_options(impact(speed as f32), options).expect("the simulation opens");
    let dt = (seconds / 400.0) as f32;
    let (mut deepest, mut steps) = (0.0_f32, 0);
    loop {
        simulation.step(dt).expect("a step");
        steps += 1;
        let state = simulation.spheres().expect("spheres");
        let gap = state[1].position.x - state[0].position.x;
        deepest = deepest.max(0.2 - gap);
        if gap >= 0.2 {
            assert!((state[1].velocity.x - 0.5).abs() < 1e-3, "it rebounds with its speed: {}", state[1].velocity);
            break;
        }
    }
    let taken = f64::from(steps) * f64::from(dt);
    assert!((f64::from(deepest) / depth - 1.0).abs() < 0.01, "depth {deepest}, expected {depth}");
    assert!((taken / seconds - 1.0).abs() < 0.01, "time {taken}, expected {seconds}");
}

/// Balls of the materials a and b at rest with an overlap: the acceleration is k d / m with the stiffness k of the pair.
fn parameters_belong_to_pairs_of_materials(backend: Backend) {
    let mut scene = scene_with(ContactLaw::User);
    let [a, b] = ["a", "b"].map(|name| scene.add_material(Material::new(name)).expect("a material"));
    for (row, pair) in [[Some(a), Some(a)], [Some(b), Some(a)], [Some(b), Some(b)], [None, Some(a)]].into_iter().enumerate() {
        for (place, material) in pair.into_iter().enumerate() {
            let ball = Sphere::new([0.875 * place as f32, 4.0 * row as f32, 0.0], 0.5).mass(2.0);
            scene.add_sphere(material.map_or(ball, |id| ball.material(id))).expect("a ball");
        }
    }
    let law = ContactForceLaw::new("k").parameter("unused", 7.0).parameter("k", 4.0).wgsl("normal_force = k * overlap;");
    let law = law.pair_parameter(["a", "b"], "k", 16.0).pair_parameter(["b", "b"], "k", 64.0);
    let mut simulation = open(&scene, backend, law);
    let dt = 1.0 / 1024.0;
    let expect = |simulation: &mut Simulation, stiffness: [f32; 4], what: &str| {
        let speeds =
            |simulation: &mut Simulation| simulation.spheres().expect("spheres").iter().map(|s| s.velocity.x).collect();
        let before: Vec<f32> = speeds(simulation);
        simulation.step(dt).expect("a step");
        let after: Vec<f32> = speeds(simulation);
        for (row, k) in stiffness.into_iter().enumerate() {
            let found = (after[2 * row + 1] - before[2 * row + 1]) / dt;
            assert!((found / (k * 0.125 / 2.0) - 1.0).abs() < 1e-2, "{what}, pair {row}: {found} with k = {k}");
        }
    };
    expect(&mut simulation, [4.0, 16.0, 64.0, 4.0], "at the start");
    simulation.set_contact_law_parameter("k", 8.0).expect("a parameter");
    expect(&mut simulation, [8.0, 16.0, 64.0, 8.0], "for all pairs");
    simulation.set_contact_law_pair_parameter(["b", "a"], "k", 32.0).expect("a parameter");
    expect(&mut simulation, [8.0, 32.0, 64.0, 8.0], "for one pair");
    let other = ContactForceLaw::new("other").parameter("k", 2.0).wgsl("normal_force = 3.0 * k * overlap;");
    simulation.set_contact_force_law(other).expect("another law");
    expect(&mut simulation, [6.0; 4], "with another law");
    // With a force law, the parameters of the contact law stand after its own.
    let push = rockfall::ForceLaw::new("push").parameter("f", 0.0).wgsl("force.x = f;");
    simulation.add_force_law(push).expect("a force law");
    expect(&mut simulation, [6.0; 4], "with a force law");
}

/// The same bits with all broad phases, with sorted memory, and on the CPU with any number of threads.
fn runs_do_not_depend_on_how_pairs_are_found(backend: Backend) {
    let (steps, dt) = crate::common::on(backend, (800, 2.5e-4), (120, 5e-4));
    let scene = tumble(ContactLaw::User, 1.0);
    let mut law = hertz();
    law.set_parameter("g", 0.3).expect("a parameter");
    let law = crate::common::on(backend, law.clone(), without_function(&law));
    let run = |method: rockfall::BroadPhase| {
        let options = options(backend).broad_phase(method).contact_force_law(law.clone());
        let mut simulation = Simulation::with_options(scene.clone(), options).expect("the simulation opens");
        simulation.run(steps / 2, dt).expect("steps");
        simulation.sort_memory().expect("sorted memory");
        simulation.run(steps / 2, dt).expect("steps");
        bits_of(&mut simulation)
    };
    let expected = run(rockfall::BroadPhase::Grid);
    for method in [rockfall::BroadPhase::BruteForce, rockfall::BroadPhase::SortAndSkip] {
        assert!(run(method) == expected, "{method}");
    }
    if backend == Backend::Cpu {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        assert!(pool.install(|| run(rockfall::BroadPhase::Grid)) == expected, "one thread");
    }
}

/// The function of Rust, its WGSL on the CPU, and the WGSL on the GPU.
#[cfg(feature = "gpu")]
#[test]
fn backends_agree_in_a_crowd() {
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let mut law = hertz();
        law.set_parameter("g", 0.3).expect("a parameter");
        let scene = tumble(ContactLaw::User, 1.0);
        let run = |backend, law| {
            let options = options(backend).integrator(integrator).contact_force_law(law);
            let mut simulation = Simulation::with_options(scene.clone(), options).expect("the simulation opens");
            simulation.run(60, 5e-4).expect("steps");
            simulation
        };
        let mut function = run(Backend::Cpu, law.clone());
        let mut interpreted = run(Backend::Cpu, without_function(&law));
        let mut gpu = run(Backend::Gpu, law);
        let off = [difference(&mut function, &mut interpreted), difference(&mut function, &mut gpu)];
        assert!(off[0] < 2e-6 && off[1] < 1e-5, "{integrator}: {off:?}");
    }
}
