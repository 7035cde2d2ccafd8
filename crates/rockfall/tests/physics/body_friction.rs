//! Friction impulses of rigid bodies (docs/physics.md section 3.9).

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{Backend, Cuboid, Energy, Integrator, Placement, RigidBody, Rod, Scene, Shape, Simulation, Sphere};

use crate::common::{on, open, with};

both! {
    bodies_stay_on_a_slope,
    bodies_slide_down_a_steep_slope,
    an_oblique_hit_has_the_friction_of_coulomb,
    an_oblique_hit_with_strong_friction_stops_the_slip,
    bodies_that_rub_keep_momentum_and_gain_no_energy,
}

const GRAVITY: f32 = 10.0;
/// A regular tetrahedron with edges of length 1, on a face, with its centre at the origin.
const TETRAHEDRON: [[f32; 3]; 4] = [
    [0.577_350_3, -0.204_124_15, 0.0],
    [-0.288_675_13, -0.204_124_15, 0.5],
    [-0.288_675_13, -0.204_124_15, -0.5],
    [0.0, 0.612_372_4, 0.0],
];
const RADIUS: f32 = 0.5;

/// A clump, and on the CPU a frame: kernels with rods take minutes on software Vulkan.
fn cases(shorter: u32) -> impl Iterator<Item = (bool, Integrator)> {
    [(false, Integrator::Rk4), (true, Integrator::SymplecticEuler)].into_iter().take(if shorter == 1 { 2 } else { 1 })
}

/// A slope, as a level floor with gravity at an angle in degrees, that falls towards +x.
fn slope(angle: f32, coulomb_friction: f32) -> Scene {
    let mut scene = with(|settings| {
        let angle = angle.to_radians();
        settings.gravity = GRAVITY;
        settings.gravity_direction = Vec3::new(angle.sin(), -angle.cos(), 0.0);
        settings.coulomb_friction = coulomb_friction;
    });
    scene.add_box(Cuboid::between([-20.0, -1.0, -20.0], [20.0, 0.0, 20.0])).unwrap();
    scene
}

/// Four balls that lie on a slope, as a clump or as a frame of rods.
fn add_tetrahedron(scene: &mut Scene, is_frame: bool) {
    // The overlap at which they rest is about 0.01.
    let centre = Vec3::new(0.0, 0.49 + 0.204_124_15, 0.0);
    if !is_frame {
        let balls = TETRAHEDRON.iter().fold(Shape::new(), |shape, at| shape.sphere(*at, RADIUS));
        let shape = scene.add_shape(balls.mass_properties(4.0, [0.0; 3], [1.4, 1.4, 1.4, 0.0, 0.0, 0.0])).unwrap();
        scene.add_body(Placement::new(shape).at(centre.as_dvec3())).unwrap();
        return;
    }
    let balls = TETRAHEDRON.map(|at| scene.add_sphere(Sphere::new(centre + Vec3::from_array(at), RADIUS).mass(1.0)).unwrap());
    for (one, two) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        scene.add_rod(Rod::new(balls[one], balls[two], 0.1).length(1.0)).unwrap();
    }
}

fn mean_velocity(simulation: &mut Simulation) -> Vec3 {
    let spheres = simulation.spheres().unwrap();
    spheres.iter().map(|sphere| sphere.velocity).sum::<Vec3>() / spheres.len() as f32
}

fn mean_place(simulation: &mut Simulation) -> Vec3 {
    let spheres = simulation.spheres().unwrap();
    spheres.iter().map(|sphere| sphere.position).sum::<Vec3>() / spheres.len() as f32
}

/// Below the angle of friction a body stays, but for a creep. The force that the friction of bodies was before let the clump creep at 0.0062
/// units/s.
fn bodies_stay_on_a_slope(backend: Backend) {
    let shorter = on(backend, 1_u32, 4);
    for (is_frame, integrator) in cases(shorter) {
        let mut scene = slope(10.0, 0.5);
        add_tetrahedron(&mut scene, is_frame);
        let mut simulation = open(scene, backend, integrator);
        let (steps, dt) = (2000 / shorter, 1e-3);
        simulation.run(u64::from(steps), dt).unwrap();
        let before = mean_place(&mut simulation);
        simulation.run(u64::from(steps), dt).unwrap();
        let creep = (mean_place(&mut simulation).x - before.x) / (steps as f32 * dt);
        println!("{backend} {integrator} {is_frame}: creeps at {creep:e}");
        assert!(creep.abs() < 0.006, "{backend} {integrator} {is_frame}: creeps at {creep}");
    }
}

/// Above the angle of friction it slides with the acceleration g (sin a - mu cos a).
fn bodies_slide_down_a_steep_slope(backend: Backend) {
    let shorter = on(backend, 1_u32, 4);
    for (is_frame, integrator) in cases(shorter) {
        let (angle, mu) = (30.0_f32, 0.2);
        let mut scene = slope(angle, mu);
        add_tetrahedron(&mut scene, is_frame);
        let mut simulation = open(scene, backend, integrator);
        let (steps, dt) = (800 / shorter, 1e-3);
        simulation.run(u64::from(steps), dt).unwrap();
        let before = mean_velocity(&mut simulation);
        simulation.run(u64::from(steps), dt).unwrap();
        let found = (mean_velocity(&mut simulation) - before).x / (steps as f32 * dt);
        let expected = GRAVITY * (angle.to_radians().sin() - mu * angle.to_radians().cos());
        println!("{backend} {integrator} {is_frame}: {found} instead of {expected}");
        assert!((found / expected - 1.0).abs() < 0.03, "{backend} {integrator} {is_frame}: {found} instead of {expected}");
    }
}

/// A smooth scene with collisions, which have the friction `mu`.
fn scene(restitution: f32, mu: f32) -> Scene {
    with(|settings| {
        (settings.gravity, settings.restitution, settings.friction) = (0.0, restitution, 0.0);
        (settings.contact_damping, settings.activation_threshold, settings.collision_friction) = (0.0, 0.0, mu);
        // Friction may turn a contact that overlaps back to the other body. Its force would add potential energy then.
        settings.contact_force = 1e-3;
    })
}

/// Three spheres with three different moments of inertia.
fn clump() -> Shape {
    let shape = Shape::new().sphere([0.0; 3], 0.2).sphere([0.3, 0.1, 0.0], 0.15).sphere([0.0, 0.1, 0.4], 0.1);
    shape.mass_properties(2.0, [0.1, 0.05, 0.1], [0.05, 0.08, 0.06, 0.005, -0.004, 0.002])
}

/// Velocity of the point of a body at a lever.
fn velocity_at(body: &RigidBody, lever: DVec3, spin: DVec3) -> DVec3 {
    body.velocity.as_dvec3() + spin.cross(lever)
}

/// A clump hits a floor obliquely with its first sphere. Returns it before and after the hit, and the lever of the contact point.
fn oblique_hit(backend: Backend, mu: f32) -> (Simulation, RigidBody, RigidBody, DVec3) {
    let mut scene = scene(0.5, mu);
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])).unwrap();
    let shape = scene.add_shape(clump()).unwrap();
    // Its first sphere is the lowest one, and no other one comes near the floor.
    let placed = Placement::new(shape).at([0.0, 0.2001, 0.0]).turned(Quat::from_axis_angle(Vec3::Z, 0.3));
    let id = scene.add_body(placed.velocity([1.5, -1.0, 0.7]).spin([0.4, -0.3, 0.2])).unwrap();
    let before = scene.body(id).unwrap().clone();
    let mut simulation = open(scene, backend, Integrator::Rk4);
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

fn add_clump(scene: &mut Scene, at: [f64; 3], velocity: [f32; 3], spin: [f32; 3], turn: f32) {
    let shape = scene.add_shape(clump()).unwrap();
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
        let mut scene = scene(1.0, [0.2, 0.5, 3.0][seed as usize % 3]);
        add_clump(&mut scene, [-1.0, 0.03 * f64::from(seed), 0.0], [2.0, 0.1, 0.2], [1.0, 2.0, 3.0], turn);
        if seed % 2 == 0 {
            add_clump(&mut scene, [0.3, 0.0, 0.1], [-1.0, 0.0, 0.0], [0.0, -2.0, 1.0], 1.0 - turn);
        } else {
            scene.add_sphere(Sphere::new([0.4, 0.05, 0.1], 0.25).mass(1.5)).unwrap();
        }
        let mut simulation = open(scene, backend, Integrator::Rk4);
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
