//! Friction impulses of rigid bodies (docs/physics section 3.9).

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{
    Backend, Cuboid, Energy, Integrator, Material, MaterialId, Pair, Placement, RigidBody, Scene, Shape, Simulation, Sphere,
};

use crate::common::{on, open, with};

both! {
    an_oblique_hit_has_the_friction_of_coulomb,
    an_oblique_hit_with_strong_friction_stops_the_slip,
    bodies_that_rub_keep_momentum_and_gain_no_energy,
}

/// A scene with collisions, which have the friction `mu`, and without friction of contacts; and its material.
fn scene(restitution: f32, mu: f32) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", "linear").expect("a law");
        settings.collisions = true;
        (settings.gravity, settings.coulomb_friction) = (0.0, 0.0);
        (settings.activation_threshold, settings.collision_friction) = (0.0, mu);
    });
    let stuff = scene.add_material(Material::new("stuff")).unwrap();
    // Friction may turn a contact that overlaps back to the other body. Its force would add potential energy then.
    scene.set_pair(stuff, stuff, Pair::default().restitution(restitution).stiffness(1e-3)).unwrap();
    (scene, stuff)
}

/// Three spheres with three different moments of inertia.
fn clump(material: MaterialId) -> Shape {
    let shape =
        Shape::new().material(material).sphere([0.0; 3], 0.2).sphere([0.3, 0.1, 0.0], 0.15).sphere([0.0, 0.1, 0.4], 0.1);
    shape.mass_properties(2.0, [0.1, 0.05, 0.1], [0.05, 0.08, 0.06, 0.005, -0.004, 0.002])
}

/// Velocity of the point of a body at a lever.
fn velocity_at(body: &RigidBody, lever: DVec3, spin: DVec3) -> DVec3 {
    body.velocity.as_dvec3() + spin.cross(lever)
}

/// A clump hits a floor obliquely with its first sphere. Returns it before and after the hit, and the lever of the contact point.
fn oblique_hit(backend: Backend, mu: f32) -> (Simulation, RigidBody, RigidBody, DVec3) {
    let (mut scene, stuff) = scene(0.5, mu);
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]).material(stuff)).unwrap();
    let shape = scene.add_shape(clump(stuff)).unwrap();
    // Its first sphere is the lowest one, and no other one comes near the floor.
    let placed = Placement::new(shape).at([0.0, 0.2001, 0.0]).turned(Quat::from_axis_angle(Vec3::Z, 0.3));
    let id = scene.add_body(placed.velocity([1.5, -1.0, 0.7]).spin([0.4, -0.3, 0.2])).unwrap();
    let before = scene.body(id).unwrap().clone();
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    let report = simulation.run(5, 1e-4).unwrap();
    assert_eq!(report.total_collisions, 1, "{backend}");
    let scene = simulation.sync().unwrap();
    let after = scene.body(id).unwrap().clone();
    let touched = scene.sphere(after.spheres()[0]).unwrap().position.as_dvec3();
    let lever = touched - DVec3::from_array(after.centre()) - 0.2 * DVec3::Y;
    (simulation, before, after, lever)
}

/// While a contact slips, the impulse along the floor is mu times that of the collision, against the slip, and acts at the contact point.
fn an_oblique_hit_has_the_friction_of_coulomb(backend: Backend) {
    let mu = 0.1;
    let (_, before, after, lever) = oblique_hit(backend, mu);
    let impulse = 2.0 * (after.velocity - before.velocity).as_dvec3();
    let along = impulse.reject_from(DVec3::Y);
    println!("{backend}: {impulse}");
    assert!(impulse.y > 1.0, "{backend}: {impulse}");
    assert!((along.length() / impulse.y - f64::from(mu)).abs() < 1e-3, "{backend}: {impulse}");
    let turning = (after.angular_momentum - before.angular_momentum).as_dvec3();
    let expected = lever.cross(impulse);
    assert!(turning.distance(expected) < 2e-3 * expected.length(), "{backend}: {turning} instead of {expected}");
}

/// Where friction is strong enough it stops the slip along its direction.
fn an_oblique_hit_with_strong_friction_stops_the_slip(backend: Backend) {
    let (mut simulation, before, after, lever) = oblique_hit(backend, 5.0);
    let states = simulation.spheres().unwrap();
    let inertia = simulation.sync().unwrap().spheres()[0].inertia();
    let spin = (states[0].angular_momentum / inertia).as_dvec3();
    let impulse = 2.0 * (after.velocity - before.velocity).as_dvec3();
    let along = impulse.reject_from(DVec3::Y).normalize();
    let slip = velocity_at(&after, lever, spin).dot(along);
    println!("{backend}: {impulse}, slip {slip}");
    assert!(slip.abs() < 2e-3, "{backend}: {slip}");
}

fn add_clump((scene, material): (&mut Scene, MaterialId), at: [f64; 3], velocity: [f32; 3], spin: [f32; 3], turn: f32) {
    let shape = scene.add_shape(clump(material)).unwrap();
    let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), turn);
    scene.add_body(Placement::new(shape).at(at).turned(turn).velocity(velocity).spin(spin)).unwrap();
}

/// How much the momentum and the angular momentum have changed, relative to their sizes.
fn changes(first: &Energy, last: &Energy) -> [f64; 2] {
    let of = |change: DVec3, size: DVec3| change.length() / size.length().max(1.0);
    [
        of(last.momentum - first.momentum, first.momentum),
        of(last.angular_momentum - first.angular_momentum, first.angular_momentum),
    ]
}

/// Elastic bodies that meet lose energy by friction, in each of several meetings, and keep both momenta.
fn bodies_that_rub_keep_momentum_and_gain_no_energy(backend: Backend) {
    let shorter = on(backend, 1_u32, 4);
    let mut lost = 0;
    let (seeds, times) = if shorter == 1 { (24, 10) } else { (3, 5) };
    for seed in 0..seeds {
        let turn = 0.3 * seed as f32;
        let (mut scene, stuff) = scene(1.0, [0.2, 0.5, 3.0][seed as usize % 3]);
        add_clump((&mut scene, stuff), [-1.0, 0.03 * f64::from(seed), 0.0], [2.0, 0.1, 0.2], [1.0, 2.0, 3.0], turn);
        if seed % 2 == 0 {
            add_clump((&mut scene, stuff), [0.3, 0.0, 0.1], [-1.0, 0.0, 0.0], [0.0, -2.0, 1.0], 1.0 - turn);
        } else {
            scene.add_sphere(Sphere::new([0.4, 0.05, 0.1], 0.25).mass(1.5).material(stuff)).unwrap();
        }
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        let first = simulation.energy().unwrap();
        let mut before = first;
        for _ in 0..times {
            simulation.run(30, 4e-3).unwrap();
            let after = simulation.energy().unwrap();
            let gain = (after.total() - before.total()) / first.total();
            let [momentum, angular] = changes(&first, &after);
            assert!(gain < 1e-5, "{backend} {seed}: gains {gain}");
            assert!(momentum < 1e-6 && angular < 1e-6, "{backend} {seed}: {momentum:e} {angular:e}");
            lost += u32::from(gain < -1e-3);
            before = after;
        }
    }
    println!("{backend}: {lost} losses");
    assert!(2 * lost > seeds, "{backend}: {lost} losses");
}
