//! Collisions of rigid bodies as impulses (docs/physics section 3.11).

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{
    Backend, Cuboid, Energy, Integrator, Material, MaterialId, Pair, Placement, Rod, Scene, Shape, Simulation, Sphere,
};

use crate::common::{on, open, with};

both! {
    a_rigid_capsule_is_a_case_of_a_rigid_body,
    elastic_bodies_that_meet_keep_energy_and_momentum,
    elastic_bodies_keep_bouncing,
    the_touched_point_rebounds_with_the_restitution,
    a_flat_landing_rebounds_with_the_restitution,
    an_elastic_clump_on_springs_keeps_its_energy,
}

const INTEGRATORS: [Integrator; 2] = [Integrator::SymplecticEuler, Integrator::VelocityVerlet];

/// The integrators of a case: all of them, or one in a shorter test.
fn integrators(case: usize, shorter: u64) -> impl Iterator<Item = Integrator> {
    INTEGRATORS.into_iter().enumerate().filter(move |(number, _)| shorter == 1 || *number == case % 2).map(|(_, kind)| kind)
}

/// A smooth scene with collisions, and its material.
fn scene(gravity: f32, restitution: f32) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", "linear").expect("a law");
        settings.collisions = true;
        (settings.gravity, settings.activation_threshold) = (gravity, 0.0);
    });
    let stuff = scene.add_material(Material::new("stuff")).unwrap();
    scene.set_pair(stuff, stuff, Pair::default().restitution(restitution).friction(0.0).stiffness(1e3)).unwrap();
    (scene, stuff)
}

/// A floor whose surface is at the height 0.
fn add_floor(scene: &mut Scene, material: MaterialId) {
    scene.add_box(Cuboid::between([-50.0, -1.0, -50.0], [50.0, 0.0, 50.0]).material(material)).unwrap();
}

/// Three spheres and a rod, with three different moments of inertia.
fn clump(material: MaterialId) -> Shape {
    let shape =
        Shape::new().material(material).sphere([0.0; 3], 0.2).sphere([0.3, 0.1, 0.0], 0.15).sphere([0.0, 0.1, 0.4], 0.1);
    shape.rod(0, 1, 0.1).mass_properties(2.0, [0.1, 0.05, 0.1], [0.05, 0.08, 0.06, 0.005, -0.004, 0.002])
}

fn add_clump((scene, material): (&mut Scene, MaterialId), at: [f64; 3], velocity: [f32; 3], spin: [f32; 3], turn: f32) {
    let shape = scene.add_shape(clump(material)).unwrap();
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), turn);
    scene.add_body(Placement::new(shape).at(at).turned(turn).velocity(velocity).spin(spin)).unwrap();
}

/// How much an energy and a momentum have changed, relative to their sizes.
fn changes(first: &Energy, last: &Energy) -> [f64; 3] {
    let of = |change: DVec3, size: DVec3| change.length() / size.length().max(1.0);
    [
        (last.total() - first.total()).abs() / first.kinetic.max(1.0),
        of(last.momentum - first.momentum, first.momentum),
        of(last.angular_momentum - first.angular_momentum, first.angular_momentum),
    ]
}

/// Two clumps, or a clump and a ball, meet. The energy, the momentum and the angular momentum of free bodies stay.
fn elastic_bodies_that_meet_keep_energy_and_momentum(backend: Backend) {
    let shorter = on(backend, 1_u64, 4);
    for seed in 0..16 / shorter {
        for integrator in integrators(seed as usize, shorter) {
            let turn = 0.4 * seed as f32;
            let (mut scene, stuff) = scene(0.0, 1.0);
            add_clump((&mut scene, stuff), [-1.0, 0.03 * seed as f64, 0.0], [2.0, 0.1, 0.2], [1.0, 2.0, 3.0], turn);
            if seed % 2 == 0 {
                add_clump((&mut scene, stuff), [0.3, 0.0, 0.1], [-1.0, 0.0, 0.0], [0.0, -2.0, 1.0], 1.0 - turn);
            } else {
                scene.add_sphere(Sphere::new([0.4, 0.05, 0.1], 0.25).mass(1.5).material(stuff)).unwrap();
            }
            let mut simulation = open(scene, backend, integrator);
            let first = simulation.energy().unwrap();
            let report = simulation.run(300, 4e-3).unwrap();
            let last = simulation.energy().unwrap();
            let [energy, momentum, angular] = changes(&first, &last);
            println!(
                "{backend} {integrator} {seed}: {} collisions, {energy:.1e} {momentum:.1e} {angular:.1e}",
                report.total_collisions
            );
            assert!(report.total_collisions > 0, "{backend} {integrator} {seed}: they meet");
            assert!(energy < 1e-5 && momentum < 1e-6 && angular < 1e-6, "{backend} {integrator} {seed}");
        }
    }
}

/// A clump bounces on a floor for a long time.
fn elastic_bodies_keep_bouncing(backend: Backend) {
    let shorter = on(backend, 1_u64, 4);
    for integrator in integrators(0, shorter) {
        let (mut scene, stuff) = scene(5.0, 1.0);
        add_floor(&mut scene, stuff);
        add_clump((&mut scene, stuff), [0.0, 1.5, 0.0], [0.3, 0.0, 0.0], [3.0, 1.0, -2.0], 0.7);
        let mut simulation = open(scene, backend, integrator);
        let first = simulation.energy().unwrap();
        let report = simulation.run(4000 / shorter.pow(2), 4e-3).unwrap();
        let last = simulation.energy().unwrap();
        let kept = last.total() / first.total();
        println!("{backend} {integrator}: {} collisions, keeps {kept}", report.total_collisions);
        let allowed = if integrator == Integrator::SymplecticEuler { 0.01 } else { 1e-3 };
        assert!((kept - 1.0).abs() < allowed, "{backend} {integrator}: {first:?} {last:?}");
        assert!(report.total_collisions > 10 / shorter.pow(2), "{backend} {integrator}: {}", report.total_collisions);
    }
}

/// The touched point of a clump that falls on a floor rebounds with e. It lands on one sphere, off its centre of mass.
fn the_touched_point_rebounds_with_the_restitution(backend: Backend) {
    let shorter = on(backend, 1_u64, 4);
    for restitution in [0.0, 0.5, 1.0].into_iter().take(4 - shorter.min(2) as usize) {
        let (mut scene, stuff) = scene(0.0, restitution);
        add_floor(&mut scene, stuff);
        let shape = Shape::new().material(stuff).sphere([0.0; 3], 0.2).sphere([0.5, 0.3, 0.0], 0.2);
        let shape = scene.add_shape(shape.mass_properties(2.0, [0.25, 0.2, 0.1], [0.1, 0.2, 0.3, 0.01, 0.0, 0.0])).unwrap();
        let body = scene.add_body(Placement::new(shape).at([0.0, 0.203, 0.0]).velocity([0.0, -1.0, 0.0])).unwrap();
        let lower = scene.body(body).unwrap().spheres()[0];
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        // The first step that finds the overlap.
        let report = simulation.run(5, 1e-3).unwrap();
        let after = simulation.sync().unwrap().sphere(lower).unwrap().velocity.y;
        assert!(report.total_collisions == 1, "{backend} {restitution}: {}", report.total_collisions);
        assert!((after - restitution).abs() < 0.01, "{backend} {restitution}: {after}");
    }
}

/// A plate of 25 spheres that lands flat is one cluster, and rebounds with e as a whole.
fn a_flat_landing_rebounds_with_the_restitution(backend: Backend) {
    for restitution in [0.5, 1.0] {
        let (mut scene, stuff) = scene(0.0, restitution);
        add_floor(&mut scene, stuff);
        let place = |k: u8| 0.15 * (f32::from(k) - 2.0);
        let cells = (0..5).flat_map(|i| (0..5).map(move |j| [place(i), 0.0, place(j)]));
        let shape = cells.fold(Shape::new().material(stuff).density(1000.0), |shape, at| shape.sphere(at, 0.1));
        let shape = scene.add_shape(shape).unwrap();
        scene.add_body(Placement::new(shape).at([0.1, 0.103, 0.05]).velocity([0.0, -1.0, 0.0])).unwrap();
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        simulation.run(10, 1e-3).unwrap();
        let scene = simulation.sync().unwrap();
        let (velocity, momentum) = (scene.bodies()[0].velocity, scene.bodies()[0].angular_momentum);
        assert!((velocity.y - restitution).abs() < 0.01, "{backend} {restitution}: {velocity}");
        assert!(momentum.length() < 1e-2, "{backend} {restitution}: {momentum}");
    }
}

/// A clump that springs and a tether pull bounces between walls. The work of its displacements on the springs is taken from the rebound.
fn an_elastic_clump_on_springs_keeps_its_energy(backend: Backend) {
    let shorter = on(backend, 1_u64, 4);
    let (mut scene, stuff) = scene(3.0, 1.0);
    add_floor(&mut scene, stuff);
    add_clump((&mut scene, stuff), [0.0, 0.8, 0.0], [0.5, 0.0, 0.0], [3.0, 1.0, -2.0], 0.7);
    let spheres = scene.bodies()[0].spheres().to_vec();
    for (sphere, at) in [(spheres[0], [0.3, 0.4, 0.0]), (spheres[2], [-0.2, 0.5, 0.3])] {
        scene.add_tether(rockfall::Tether::new(sphere, at, 40.0).length(0.1)).unwrap();
    }
    let mut simulation: Simulation = open(scene, backend, Integrator::VelocityVerlet);
    let first = simulation.energy().unwrap().total();
    let report = simulation.run(3000 / shorter.pow(2), 2e-3).unwrap();
    let last = simulation.energy().unwrap().total();
    println!("{backend}: {} collisions, {first} -> {last}", report.total_collisions);
    assert!(report.total_collisions > 10 / shorter.pow(2), "{backend}: {}", report.total_collisions);
    assert!((last / first - 1.0).abs() < 0.05, "{backend}: {first} -> {last}");
}

/// A rigid capsule (docs/physics section 3.3) responds to collisions as the rigid body with its mass and inertia: its end falls on a
/// floor, and a ball hits its rod.
fn a_rigid_capsule_is_a_case_of_a_rigid_body(backend: Backend) {
    let (places, masses, radius) = ([Vec3::new(-0.5, 0.6, 0.0), Vec3::new(0.3, 1.0, 0.1)], [1.0, 2.5], 0.2);
    let (velocity, spin) = (Vec3::new(0.2, -1.0, 0.1), Vec3::new(0.3, 1.0, 2.0));
    let mass: f32 = masses.iter().sum();
    let centre = (masses[0] * places[0] + masses[1] * places[1]) / mass;
    let axis = places[1] - places[0];
    let spin = spin - spin.dot(axis) / axis.length_squared() * axis;
    let states = |as_body: bool, backend: Backend, integrator: Integrator| {
        let (mut scene, stuff) = scene(3.0, 0.8);
        add_floor(&mut scene, stuff);
        let ends = if as_body {
            let arms = places.map(|place| place - centre);
            let mut inertia = [0.0; 6];
            for (arm, mass) in arms.into_iter().zip(masses) {
                let ball = 0.4 * mass * radius * radius + mass * arm.length_squared();
                let [x, y, z] = arm.to_array();
                let own = [ball - mass * x * x, ball - mass * y * y, ball - mass * z * z, x * y, x * z, y * z];
                let sign = [1.0, 1.0, 1.0, -mass, -mass, -mass];
                (0..6).for_each(|k| inertia[k] += sign[k] * own[k]);
            }
            let shape = Shape::new().material(stuff).sphere(arms[0], radius).sphere(arms[1], radius).rod(0, 1, radius);
            let shape = scene.add_shape(shape.mass_properties(mass, [0.0; 3], inertia)).unwrap();
            let placed = Placement::new(shape).at(centre.as_dvec3()).velocity(velocity).spin(spin);
            let body = scene.add_body(placed).unwrap();
            scene.body(body).unwrap().spheres().to_vec()
        } else {
            let ends: Vec<_> = (0..2)
                .map(|end| {
                    let velocity = velocity + spin.cross(places[end] - centre);
                    let inertia = 0.4 * masses[end] * radius * radius;
                    let ball = Sphere::new(places[end], radius).mass(masses[end]).velocity(velocity).material(stuff);
                    scene.add_sphere(ball.angular_momentum(inertia * spin)).unwrap()
                })
                .collect();
            scene.add_rod(Rod::new(ends[0], ends[1], radius).length(axis.length()).material(stuff)).unwrap();
            ends
        };
        scene.add_sphere(Sphere::new([0.1, 1.6, 0.05], 0.2).mass(0.5).velocity([0.0, -3.0, 0.0]).material(stuff)).unwrap();
        let mut simulation = open(scene, backend, integrator);
        let report = simulation.run(250, 1e-3).unwrap();
        assert!(report.total_collisions > 1, "{backend} {integrator}: {}", report.total_collisions);
        let scene = simulation.sync().unwrap();
        ends.into_iter().map(|end| *scene.sphere(end).unwrap()).collect::<Vec<_>>()
    };
    let shorter = on(backend, 1_u64, 4);
    for integrator in integrators(0, shorter) {
        let (capsule, body) = (states(false, backend, integrator), states(true, backend, integrator));
        for (one, other) in capsule.iter().zip(&body) {
            let (moved, sped) = (one.position.distance(other.position), one.velocity.distance(other.velocity));
            println!("{backend} {integrator}: {moved:.1e} {sped:.1e}, {} {}", one.velocity, other.velocity);
            assert!(moved < 1e-4 && sped < 1e-3, "{backend} {integrator}: {one:?} {other:?}");
        }
    }
}
