//! Sheared periodic boundaries (docs/physics section 2.14).

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::glam::{DVec3, Vec3};
use rockfall::{
    Backend, BroadPhase, Checkpoint, ContactLaw, Integrator, Material, MaterialId, Meter, Options, Pair, Scene, Shear,
    Simulation, Sphere, Spring, Tether,
};

use crate::common::{bits_of, near, on, with};

const RATE: f32 = 2.0;
/// Each law with an integrator and a time step.
const WAYS: [(ContactLaw, Integrator, f32); 4] = [
    (ContactLaw::Thesis, Integrator::Rk4, 2e-3),
    (ContactLaw::Thesis, Integrator::SymplecticEuler, 1e-3),
    (ContactLaw::HertzMindlin, Integrator::VelocityVerlet, 2e-4),
    (ContactLaw::Linear, Integrator::SymplecticEuler, 2e-4),
];

fn open(scene: Scene, backend: Backend, integrator: Integrator, broad_phase: BroadPhase) -> Simulation {
    let options = Options::new().backend(backend).integrator(integrator).broad_phase(broad_phase);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

/// An empty box of 4 x 2 x 2 units with soft contacts, whose lower faces are at these coordinates.
fn sheared(law: ContactLaw, [x, y, z]: [f32; 3], shear: Option<Shear>) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", &law.to_string()).expect("a law");
        (settings.gravity, settings.collisions) = (0.0, false);
    });
    let stuff = scene.add_material(Material::new("stuff").density(800.0).young(2e5).poisson(0.3)).expect("a material");
    let pair = if law == ContactLaw::Linear { Pair::default().stiffness(2e3) } else { Pair::default() };
    scene.set_pair(stuff, stuff, pair.restitution(0.6).friction(0.4)).expect("a valid pair");
    for (axis, bounds) in [[x, x + 4.0], [y, y + 2.0], [z, z + 2.0]].into_iter().enumerate() {
        scene.set_periodic(axis, Some(bounds)).expect("valid bounds");
    }
    scene.set_shear(shear).expect("a valid shear");
    (scene, stuff)
}

/// Spheres all over the box, with the velocity of the flow.
fn crowd(law: ContactLaw, from: [f32; 3]) -> Scene {
    let mut random = Pcg64Mcg::seed_from_u64(11);
    let (mut scene, stuff) = sheared(law, from, Some(Shear::new(1, 0, RATE)));
    for index in 0..70 {
        // Multiples of 2^-12, so that whole periods can be added without rounding.
        let mut number = |most: f32| (random.random_range(0.0..most) * 4096.0_f32).round() / 4096.0;
        let at = Vec3::new(number(4.0), number(2.0), number(2.0));
        let velocity = Vec3::new(number(0.5) + RATE * (at.y - 1.0), number(0.5) - 0.25, number(0.5) - 0.25);
        let radius = if index % 3 == 0 { 0.2 } else { 0.14 };
        scene.add_sphere(Sphere::new(at, radius).velocity(velocity).material(stuff)).expect("a valid sphere");
    }
    scene
}

/// A sphere below the upper face and one above the lower face collide as inside the box, where the second one is written displaced by the
/// shear and with the velocity of the box above.
fn a_pair_across_the_face_collides_as_inside(backend: Backend) {
    for (law, integrator, dt) in WAYS {
        let shear = Shear::new(1, 0, RATE).with_turns(0.2);
        let run = |across: bool| {
            let (mut scene, stuff) = sheared(law, [0.0; 3], across.then_some(shear));
            let (one, other) = (Vec3::new(2.0, 1.9, 1.0), Vec3::new(1.35, 0.22, 1.1));
            let image = Vec3::new(0.8, 2.0, 0.0);
            let down = Vec3::new(0.0, -1.0, 0.0);
            let [one, other] = if across { [one, other] } else { [one + down, other + image + down] };
            let drift = if across { Vec3::ZERO } else { Vec3::new(2.0 * RATE, 0.0, 0.0) };
            let velocity = Vec3::new(-3.8, -0.7, 0.0) + drift;
            scene.add_sphere(Sphere::new(one, 0.15).material(stuff)).expect("a valid sphere");
            scene.add_sphere(Sphere::new(other, 0.15).velocity(velocity).material(stuff)).expect("a valid sphere");
            let mut simulation = open(scene, backend, integrator, BroadPhase::Auto);
            let mut touched = 0;
            for _ in 0..40 {
                touched += simulation.run((0.01 / dt) as u64, dt).expect("steps").contacts;
            }
            assert!(touched > 0, "{law}: no contact was seen");
            simulation.spheres().expect("states").to_vec()
        };
        let (across, inside) = (run(true), run(false));
        let turned = inside[0].angular_momentum.length();
        assert!(turned > 0.0, "{law}: the collision is oblique");
        for (number, (one, other)) in across.iter().zip(&inside).enumerate() {
            let drift = if number == 1 { Vec3::new(2.0 * RATE, 0.0, 0.0) } else { Vec3::ZERO };
            near(one.velocity + drift, other.velocity.as_dvec3(), 2e-3, &format!("velocity {number}, {law}, {integrator}"));
            near(
                one.angular_momentum,
                other.angular_momentum.as_dvec3(),
                2e-3 * f64::from(turned),
                &format!("spin {number}, {law}"),
            );
        }
    }
}

/// The faces of the box may be anywhere, any broad phase finds the pairs, and steps may be divided in any way: the bits are the same.
fn results_do_not_depend_on_faces_broad_phases_and_calls(backend: Backend) {
    for (law, integrator, dt) in WAYS {
        let run = |from, broad_phase, calls: u64| {
            let mut simulation = open(crowd(law, from), backend, integrator, broad_phase);
            let mut touching = 0;
            for _ in 0..calls {
                touching = simulation.run(120 / calls, dt).expect("steps").contacts;
            }
            assert!(touching > 5, "{law}: {touching} contacts");
            bits_of(&mut simulation)
        };
        let plain = run([0.0; 3], BroadPhase::Grid, 1);
        assert!(run([0.0; 3], BroadPhase::BruteForce, 1) == plain, "brute force, {law}");
        assert!(run([-1.37, 0.71, 0.3], BroadPhase::Grid, 1) == plain, "other faces, {law}");
        assert!(run([0.0; 3], BroadPhase::Grid, 12) == plain, "other calls, {law}");
    }
}

/// The sum of the velocities of the state is conserved, and a body that passes the upper face keeps its path.
fn momentum_is_conserved(backend: Backend) {
    for (law, integrator, dt) in WAYS {
        let mut simulation = open(crowd(law, [0.0; 3]), backend, integrator, BroadPhase::Auto);
        let before = simulation.energy().expect("an energy");
        simulation.run(300, dt).expect("steps");
        let after = simulation.energy().expect("an energy");
        let scale: f64 = simulation.scene().spheres().iter().map(|sphere| f64::from(sphere.mass)).sum();
        let lost = (after.momentum - before.momentum).length() / scale;
        assert!(lost < 1e-5, "{law}: {lost}");
    }
}

/// What the shear does is what an elastic crowd gains: through contacts, springs and tethers, and where bodies pass a face.
fn the_shear_does_the_work_that_a_crowd_gains(backend: Backend) {
    let mut scene = crowd(ContactLaw::HertzMindlin, [0.0; 3]);
    let stuff = scene.material_ids().next().expect("a material");
    scene.set_pair(stuff, stuff, Pair::default().restitution(1.0).friction(0.0)).expect("a valid pair");
    let ids: Vec<_> = scene.sphere_ids().collect();
    for pair in ids.chunks(2).take(20) {
        scene.add_spring(Spring::new(pair[0], pair[1], 40.0, 1.0)).expect("a valid spring");
    }
    scene.add_tether(Tether::new(ids[60], [1.0, 1.0, 1.0], 40.0)).expect("a valid tether");
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet, BroadPhase::Auto);
    let dt = 1e-4;
    let before = simulation.energy().expect("an energy").total();
    let mut meter = Meter::new(simulation.scene(), false, true);
    simulation.run_metered(on(backend, 6_000, 300), dt, &mut meter).expect("steps");
    let gained = simulation.energy().expect("an energy").total() - before;
    assert!(gained.abs() > 0.01 * before, "{gained} of {before}");
    let error = (meter.work - gained).abs();
    assert!(error < 0.01 * gained.abs().max(meter.work.abs()), "{} of {gained}, {before} before", meter.work);
}

/// A flow with the velocity of the shear everywhere meets no edge: its bodies never touch, and their images stay in the box.
fn a_uniform_flow_has_no_edges(backend: Backend) {
    let (mut scene, _) = sheared(ContactLaw::Thesis, [0.0; 3], Some(Shear::new(1, 0, RATE)));
    for [x, y] in (0..32).map(|index| [0.5 * (index % 8) as f32 + 0.25, 0.5 * (index / 8) as f32 + 0.25]) {
        let velocity = Vec3::new(RATE * y, 0.0, 0.0);
        scene.add_sphere(Sphere::new([x, y, 1.0], 0.2).velocity(velocity)).expect("a valid sphere");
    }
    let mut simulation = open(scene, backend, Integrator::Rk4, BroadPhase::Auto);
    let mut contacts = 0;
    for _ in 0..40 {
        contacts += simulation.run(50, 2e-3).expect("steps").contacts;
    }
    assert_eq!(contacts, 0);
    let scene = simulation.snapshot().expect("a scene");
    let shear = scene.shear().expect("a shear");
    // 4 s at 1 period/s.
    assert!(shear.turns().abs() < 1e-4, "{}", shear.turns());
    for mut sphere in simulation.spheres().expect("states").to_vec() {
        sphere.bring_into_box(&scene);
        assert!((0.0..=4.0).contains(&sphere.position.x), "{}", sphere.position);
        near(sphere.velocity, DVec3::new(f64::from(RATE * sphere.position.y), 0.0, 0.0), 1e-5, "the velocity of the flow");
    }
}

fn checkpoints_have_the_shear(backend: Backend) {
    let (law, integrator, dt) = WAYS[2];
    let mut simulation = open(crowd(law, [0.0; 3]), backend, integrator, BroadPhase::Auto);
    simulation.run(50, dt).expect("steps");
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    simulation.run(50, dt).expect("steps");
    let mut again = Simulation::resume(Checkpoint::from_bytes(&bytes, "memory").expect("it reads back")).expect("it resumes");
    again.run(50, dt).expect("steps");
    assert_eq!(again.scene().shear(), simulation.scene().shear());
    assert!(bits_of(&mut again) == bits_of(&mut simulation));
}

both! {
    a_pair_across_the_face_collides_as_inside,
    results_do_not_depend_on_faces_broad_phases_and_calls,
    momentum_is_conserved,
    a_uniform_flow_has_no_edges,
    checkpoints_have_the_shear,
    the_shear_does_the_work_that_a_crowd_gains,
}
