//! Rigid bodies (docs/physics sections 1.5, 4.16 and 5.9).

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{
    Backend, ContactLaw, Cuboid, Integrator, Material, MaterialId, Options, Pair, Placement, Polygon, RigidBody, Rod, Scene,
    Shape, Simulation, Sphere,
};

use crate::common::{on, open, with};

both! {
    a_free_body_keeps_its_momentum_and_flips,
    one_contact_has_the_restitution_of_its_pair,
    several_contacts_have_the_restitution_of_one,
    several_contacts_of_two_bodies_have_the_restitution_of_one,
    impacts_of_bodies_keep_what_they_must,
    a_body_of_one_ball_moves_as_the_ball,
    a_resumed_run_of_bodies_has_the_same_bits,
}

const INTEGRATORS: [Integrator; 2] = [Integrator::SymplecticEuler, Integrator::VelocityVerlet];

/// A scene without gravity and collisions, and its material.
fn free() -> (Scene, MaterialId) {
    with_law(ContactLaw::Linear, 0.0, Pair::default())
}

/// A body with the moments 1, 2 and 3: mass 6, from six balls on the axes of the shape.
fn top(material: MaterialId) -> Shape {
    Shape::new().material(material).sphere([1.0, 0.0, 0.0], 0.1).sphere([0.0, 1.0, 0.2], 0.1).mass_properties(
        6.0,
        [0.0; 3],
        [1.0, 2.0, 3.0, 0.0, 0.0, 0.0],
    )
}

fn body_of(simulation: &mut Simulation) -> RigidBody {
    let scene = simulation.sync().expect("the state");
    scene.bodies()[0].clone()
}

fn stuff(scene: &mut Scene, pair: Pair) -> MaterialId {
    let stuff = scene.add_material(Material::new("stuff").density(1000.0).young(1e7).poisson(0.3)).unwrap();
    scene.set_pair(stuff, stuff, pair).unwrap();
    stuff
}

/// A scene with a law with history and one material.
fn with_law(law: ContactLaw, gravity: f32, pair: Pair) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", &law.to_string()).expect("a law");
        (settings.gravity, settings.collisions) = (gravity, false);
    });
    let material = stuff(&mut scene, pair.characteristic_velocity(2.0));
    (scene, material)
}

/// Two balls of radius 0.1 that are 0.15 apart.
fn dimer(material: MaterialId) -> Shape {
    Shape::new().material(material).sphere([-0.075, 0.0, 0.0], 0.1).sphere([0.075, 0.0, 0.0], 0.1).density(1000.0)
}

/// Runs at most `times` times 25 steps, until a contact has begun and ended. Returns whether one has begun.
fn run_through_contact(simulation: &mut Simulation, times: u32, dt: f32) -> bool {
    let mut has_met = false;
    for _ in 0..times {
        simulation.run(25, dt).unwrap();
        let touches = simulation.energy().unwrap().contact > 0.0;
        if has_met && !touches {
            break;
        }
        has_met |= touches;
    }
    has_met
}

/// A free body keeps L bit for bit, its energy is bounded, and its intermediate axis flips with the period of the elliptic integral.
fn a_free_body_keeps_its_momentum_and_flips(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    for integrator in INTEGRATORS {
        let (mut scene, material) = free();
        let shape = scene.add_shape(top(material)).unwrap();
        let momentum = Vec3::new(0.01, 2.0, 0.0);
        let placed = Placement::new(shape).velocity([0.1, 0.0, -0.2]).angular_momentum(momentum);
        scene.add_body(placed).unwrap();
        let mut simulation = open(scene, backend, integrator);
        let first = simulation.energy().unwrap().kinetic;
        let (mut flips, mut before) = (Vec::new(), 1.0);
        for step in 1..=2000 / u32::from(shorter).pow(2) {
            simulation.run(2, 0.05).unwrap();
            let body = body_of(&mut simulation);
            assert_eq!(body.angular_momentum, momentum, "{backend} {integrator}");
            let along = (body.orientation * Vec3::Y).dot(momentum);
            if along * before < 0.0 {
                flips.push(0.1 * f64::from(step));
            }
            before = along;
        }
        assert!((flips[0] - 10.3773).abs() < 0.1, "{backend} {integrator}: {flips:?}");
        for pair in flips.windows(2) {
            assert!((pair[1] - pair[0] - 20.7546).abs() < 0.3, "{backend} {integrator}: {flips:?}");
        }
        let energy = simulation.energy().unwrap().kinetic;
        assert!((energy / first - 1.0).abs() < 1e-4, "{backend} {integrator}: {first} {energy}");
    }
}

/// One contact rebounds with the coefficient that the pair has, whatever the direction of the impact (docs/physics section 4.16): the
/// speed of the contact point along the normal.
fn one_contact_has_the_restitution_of_its_pair(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        for tilt in [0.4_f32, 1.0, 0.0, 1.45].into_iter().take(4 / usize::from(shorter)) {
            let (mut scene, material) = with_law(law, 0.0, Pair::default().restitution(0.5).friction(0.0));
            let shape = scene.add_shape(dimer(material)).unwrap();
            let floor = Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0]).material(material);
            scene.add_box(floor).unwrap();
            let turn = Quat::from_rotation_z(0.5 * std::f32::consts::PI - tilt);
            // The lower ball just touches the floor.
            let height = 0.1001 + 0.075 * tilt.cos();
            let placed = Placement::new(shape).at([0.0, f64::from(height), 0.0]).turned(turn).velocity([0.0, -1.0, 0.0]);
            let body = scene.add_body(placed).unwrap();
            let lower = scene.body(body).unwrap().spheres()[0];
            let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
            // The body turns, so the speed is that at the end of the contact.
            run_through_contact(&mut simulation, 100, 2e-5);
            let after = simulation.sync().unwrap().sphere(lower).unwrap().velocity;
            assert!((after.y - 0.5).abs() < 0.02, "{backend} {law}, tilt {tilt}: {after}");
            let energy = simulation.energy().unwrap();
            assert!(energy.contact == 0.0, "{backend} {law}, tilt {tilt}: it still touches");
        }
    }
}

/// A square plate of `side` by `side` balls of radius 0.1.
fn plate(side: u8, material: MaterialId) -> Shape {
    let place = |k: u8| 0.15 * (f32::from(k) - 0.5 * f32::from(side - 1));
    let cells = (0..side).flat_map(|i| (0..side).map(move |j| [place(i), 0.0, place(j)]));
    cells.fold(Shape::new().material(material).density(1000.0), |shape, at| shape.sphere(at, 0.1))
}

/// Any number of balls that land at once, flat or on an edge of a plate, rebound with the restitution of the pair: the speed of the contact points along the normal.
fn several_contacts_have_the_restitution_of_one(backend: Backend) {
    let rebound = |backend: Backend, law: ContactLaw, side: u8, tilt: f32, is_mesh: bool| {
        let (mut scene, material) = with_law(law, 0.0, Pair::default().restitution(0.5).friction(0.0));
        let shape = scene.add_shape(plate(side, material)).unwrap();
        let [low, high] = [[-3.0, 0.0, -3.0], [3.0, 0.0, 3.0]];
        if is_mesh {
            for corner in [[-3.0, 0.0, 3.0], [3.0, 0.0, -3.0]] {
                let ends = if corner[0] < 0.0 { [low, high] } else { [high, low] };
                scene.add_polygon(Polygon::triangle(corner, ends[1], ends[0]).material(material)).unwrap();
            }
        } else {
            scene.add_box(Cuboid::between([-3.0, -1.0, -3.0], [3.0, 0.0, 3.0]).material(material)).unwrap();
        }
        let height = 0.1001 + 0.075 * f32::from(side - 1) * tilt.sin();
        let placed = Placement::new(shape).at([0.1, f64::from(height), 0.05]).turned(Quat::from_rotation_z(tilt));
        let body = scene.add_body(placed.velocity([0.0, -1.0, 0.0])).unwrap();
        let lower = scene.body(body).unwrap().spheres()[0];
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        let has_met = run_through_contact(&mut simulation, 200, 1e-5);
        assert!(has_met && simulation.energy().unwrap().contact == 0.0);
        simulation.sync().unwrap().sphere(lower).unwrap().velocity.y
    };
    let shorter = on(backend, 1_u8, 4);
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        let cases = [(5, 0.0, false), (5, 0.6, true), (1, 0.0, false), (2, 0.0, true), (2, 0.6, false), (3, 0.0, false)];
        for (side, tilt, is_mesh) in cases.into_iter().take(6 / usize::from(shorter)) {
            let found = rebound(backend, law, side, tilt, is_mesh);
            // A tilted plate turns a little before its speed is read.
            let allowed = if tilt > 0.0 { 0.03 } else { 0.01 };
            assert!((found - 0.5).abs() < allowed, "{backend} {law}, {side} x {side}, tilt {tilt}: {found}");
        }
    }
}

/// Two plates of any number of balls that meet flat rebound with the restitution of the pair. So does a plate that meets a ball which lies in
/// the middle of four of its balls.
fn several_contacts_of_two_bodies_have_the_restitution_of_one(backend: Backend) {
    let rebound = |backend: Backend, law: ContactLaw, side: u8, with_ball: bool| {
        let (mut scene, material) = with_law(law, 0.0, Pair::default().restitution(0.5).friction(0.0));
        let shape = scene.add_shape(plate(side, material)).unwrap();
        let turn = Quat::from_rotation_z(0.7) * Quat::from_rotation_x(-0.4);
        // Four balls touch the one between them at a place below the tops of the balls.
        let gap = if with_ball { (0.2_f32.powi(2) - 2.0 * 0.075_f32.powi(2)).sqrt() } else { 0.2 };
        let up = turn * Vec3::Y;
        let place = |sign: f32| (sign * (0.5 * gap + 0.0001) * up).as_dvec3();
        scene.add_body(Placement::new(shape).at(place(-1.0)).turned(turn).velocity(0.5 * up)).unwrap();
        if with_ball {
            let ball = Sphere::new(place(1.0).as_vec3(), 0.1).density(1000.0).material(material);
            scene.add_sphere(ball.velocity(-0.5 * up)).unwrap();
        } else {
            scene.add_body(Placement::new(shape).at(place(1.0)).turned(turn).velocity(-0.5 * up)).unwrap();
        }
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        let before = simulation.energy().unwrap();
        let has_met = run_through_contact(&mut simulation, 200, 1e-5);
        let after = simulation.energy().unwrap();
        assert!(has_met && after.contact == 0.0);
        let size = before.momentum.length().max(1.0);
        assert!((after.momentum - before.momentum).length() < 1e-5 * size, "{before:?} {after:?}");
        let scene = simulation.sync().unwrap();
        let other = if with_ball {
            scene.spheres()[usize::from(side) * usize::from(side)].velocity
        } else {
            scene.bodies()[1].velocity
        };
        (other - scene.bodies()[0].velocity).dot(up)
    };
    let shorter = on(backend, 1_u8, 4);
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        let cases = [(3, false), (2, true), (1, false), (2, false)];
        for (side, with_ball) in cases.into_iter().take(4 / usize::from(shorter)) {
            let found = rebound(backend, law, side, with_ball);
            assert!((found - 0.5).abs() < 0.01, "{backend} {law}, {side} x {side}, ball {with_ball}: {found}");
        }
    }
}

/// Elastic bodies that meet off centre keep their energy, momentum and angular momentum.
fn impacts_of_bodies_keep_what_they_must(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    for seed in 0..4 / shorter {
        let (mut scene, material) = with_law(ContactLaw::HertzMindlin, 0.0, Pair::default().restitution(1.0).friction(0.0));
        let shape = scene.add_shape(dimer(material)).unwrap();
        let tripod = Shape::new().material(material).density(1500.0).sphere([0.1, 0.0, 0.0], 0.08);
        let tripod = tripod.sphere([-0.05, 0.08, 0.0], 0.1).capsule([-0.05, -0.08, 0.02], [-0.05, -0.1, 0.25], 0.06);
        let tripod = scene.add_shape(tripod).unwrap();
        let aside = 0.03 * f64::from(seed);
        let one = Placement::new(shape).at([-0.5, aside, 0.02]).velocity([1.0, 0.0, 0.0]).spin([1.0, 2.0, 5.0]);
        let two = Placement::new(tripod).at([0.2, 0.0, 0.0]).turned(Quat::from_rotation_y(0.3 * f32::from(seed)));
        scene.add_body(one).unwrap();
        scene.add_body(two.spin([0.0, 3.0, -4.0])).unwrap();
        scene
            .add_sphere(Sphere::new([0.9, 0.05, 0.0], 0.1).density(1000.0).velocity([-0.5, 0.0, 0.0]).material(material))
            .unwrap();
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        let first = simulation.energy().unwrap();
        simulation.run(40_000, 2e-5).unwrap();
        let last = simulation.energy().unwrap();
        let size = DVec3::from_array(first.momentum.into()).length().max(1.0);
        assert!(
            (last.kinetic + last.contact - first.kinetic).abs() < 5e-3 * first.kinetic,
            "{backend} {seed}: {first:?} {last:?}"
        );
        assert!((last.momentum - first.momentum).length() < 1e-5 * size, "{backend} {seed}: {first:?} {last:?}");
        assert!(
            (last.angular_momentum - first.angular_momentum).length() < 1e-4 * size,
            "{backend} {seed}: {first:?} {last:?}"
        );
        let body = body_of(&mut simulation);
        assert!(body.velocity.x < 0.97, "{backend} {seed}: they met");
    }
}

/// A body of one ball rolls, bounces and slides as the ball does.
fn a_body_of_one_ball_moves_as_the_ball(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let states = [false, true].map(|is_body| {
            let (mut scene, material) =
                with_law(ContactLaw::HertzMindlin, 9.81, Pair::default().restitution(0.6).friction(0.4));
            scene.add_box(Cuboid::between([-2.0, -1.0, -1.0], [2.0, 0.0, 1.0]).material(material)).unwrap();
            if is_body {
                let shape = Shape::new().material(material).sphere([0.0; 3], 0.1).density(1000.0);
                let shape = scene.add_shape(shape).unwrap();
                scene
                    .add_body(Placement::new(shape).at([0.0, 0.15, 0.0]).velocity([1.0, 0.0, 0.2]).spin([1.0, 0.0, 3.0]))
                    .unwrap();
            } else {
                let ball = Sphere::new([0.0, 0.15, 0.0], 0.1).density(1000.0).velocity([1.0, 0.0, 0.2]).material(material);
                let momentum = ball.inertia() * Vec3::new(1.0, 0.0, 3.0);
                scene.add_sphere(ball.angular_momentum(momentum)).unwrap();
            }
            let mut simulation = open(scene, backend, integrator);
            simulation.run(20_000 / u64::from(shorter).pow(2), 2e-5).unwrap();
            simulation.spheres().unwrap()[0]
        });
        let [ball, body] = states;
        assert!(ball.position.distance(body.position) < 1e-4, "{backend} {integrator}: {ball:?} {body:?}");
        assert!(ball.velocity.distance(body.velocity) < 1e-3, "{backend} {integrator}: {ball:?} {body:?}");
    }
}

/// A run that is resumed from a file has the same bits, also with the accelerations that velocity Verlet keeps for bodies.
fn a_resumed_run_of_bodies_has_the_same_bits(backend: Backend) {
    let (mut scene, material) = with_law(ContactLaw::Linear, 9.81, Pair::default().restitution(0.5).friction(0.5));
    let shape = scene.add_shape(dimer(material)).unwrap();
    scene.add_body(Placement::new(shape).at([0.0, 0.101, 0.0]).velocity([0.5, -0.5, 0.0])).unwrap();
    scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0]).material(material)).unwrap();
    let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
    simulation.run(40, 2e-4).unwrap();
    let bytes = simulation.checkpoint().unwrap().to_bytes();
    let mut resumed = Simulation::resume(rockfall::Checkpoint::from_bytes(&bytes, "memory").unwrap()).unwrap();
    simulation.run(40, 2e-4).unwrap();
    resumed.run(40, 2e-4).unwrap();
    assert_eq!(format!("{:?}", body_of(&mut simulation)), format!("{:?}", body_of(&mut resumed)));
}

/// A rod of fixed length to a body would take momentum away, so it is refused. One of free length is not.
#[test]
fn rods_of_fixed_length_do_not_end_in_bodies() {
    let opened = |length: Option<f32>| {
        let (mut scene, material) = free();
        let shape = Shape::new().material(material).sphere([0.0; 3], 0.1).sphere([0.2, 0.0, 0.0], 0.1);
        let shape = scene.add_shape(shape).unwrap();
        let body = scene.add_body(Placement::new(shape)).unwrap();
        let ball = scene.add_sphere(Sphere::new([0.7, 0.0, 0.0], 0.1).material(material)).unwrap();
        let rod = Rod::new(scene.body(body).unwrap().spheres()[1], ball, 0.05).material(material);
        scene.add_rod(length.map_or(rod, |length| rod.length(length))).unwrap();
        Simulation::with_options(scene, Options::new().backend(Backend::Cpu)).map(drop)
    };
    let error = opened(Some(0.5)).unwrap_err().to_string();
    assert!(error.contains("rod") && error.contains("does not pull a rigid body"), "{error}");
    opened(None).unwrap();
}
