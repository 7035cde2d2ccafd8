//! Boxes of rigid bodies (docs/physics.md section 2.16).

use rockfall::glam::{EulerRot, Quat, Vec3};
use rockfall::{
    Backend, Body, BroadPhase, ContactLaw, Cuboid, Integrator, Material, MaterialId, Motion, MotionTerm, Options, Pair,
    Placement, Polygon, RigidBody, Scene, Shape, Simulation, Sphere,
};

use crate::common::{on, with};

both! {
    faces_rest_on_faces,
    impacts_of_boxes_keep_what_they_must,
    broad_phases_find_the_same_contacts,
    a_plank_rests_on_the_corners_of_a_post,
    a_corner_of_several_walls_counts_once,
    a_box_slides_over_tiles_as_over_one_floor,
    a_moving_post_carries_a_plank,
}

const ORIGIN: [f32; 3] = [0.0; 3];

/// A scene with a law with history and one material.
fn stage(gravity: f32, pair: Pair) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", &ContactLaw::Linear.to_string()).expect("a law");
        (settings.gravity, settings.collisions) = (gravity, false);
    });
    let material = scene.add_material(Material::new("stuff").density(1000.0).young(1e9).poisson(0.3)).unwrap();
    scene.set_pair(material, material, pair.characteristic_velocity(1.0)).unwrap();
    (scene, material)
}

/// A box with these edges about the origin.
fn block(material: MaterialId, edges: [f32; 3]) -> Shape {
    let half = 0.5 * Vec3::from_array(edges);
    Shape::new().material(material).density(1000.0).cuboid(Cuboid::between(-half, half))
}

fn open(scene: Scene, backend: Backend) -> Simulation {
    let options = Options::new().backend(backend).integrator(Integrator::VelocityVerlet);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

fn last_body(simulation: &mut Simulation) -> RigidBody {
    simulation.sync().expect("the state").bodies().last().expect("a body").clone()
}

fn floor(scene: &mut Scene, material: MaterialId) {
    scene.add_box(Cuboid::between([-9.0, -1.0, -9.0], [9.0, 0.0, 9.0]).material(material)).unwrap();
}

/// The mass properties are those of the sharp box.
#[test]
fn a_box_has_its_closed_form() {
    let (mut scene, material) = stage(0.0, Pair::default());
    let shape = scene.add_shape(block(material, [0.2, 0.3, 0.5])).unwrap();
    let properties = scene.shape(shape).unwrap().mass_properties_of().unwrap();
    assert!((properties.mass - 30.0).abs() < 1e-4, "{properties:?}");
    let [xx, yy, zz, ..] = properties.inertia;
    for (found, exact) in [(xx, 30.0 / 12.0 * 0.34), (yy, 30.0 / 12.0 * 0.29), (zz, 30.0 / 12.0 * 0.13)] {
        assert!((found / exact - 1.0).abs() < 1e-5, "{properties:?}");
    }
    // A box that a ball overlaps by an eighth of the ball: the volume of the union.
    let corner = Shape::new().density(1.0).cuboid(Cuboid::between([-1.0; 3], ORIGIN)).sphere(ORIGIN, 0.5);
    let union = 1.0 + 7.0 / 8.0 * std::f64::consts::PI / 6.0;
    let found = corner.mass_properties_of().unwrap();
    assert!((found.mass / union - 1.0).abs() < 1e-3, "{found:?} {union}");
}

/// A box that falls flat, and one on top of it, come to rest at the heights of their faces.
fn faces_rest_on_faces(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    let (mut scene, material) = stage(9.81, Pair::default().restitution(0.2).friction(0.5));
    floor(&mut scene, material);
    let shape = scene.add_shape(block(material, [0.4, 0.2, 0.3])).unwrap();
    scene.add_body(Placement::new(shape).at([0.0, 0.1005, 0.0])).unwrap();
    let turn = Quat::from_rotation_y(0.5);
    scene.add_body(Placement::new(shape).at([0.03, 0.302, 0.01]).turned(turn)).unwrap();
    let mut simulation = open(scene, backend);
    simulation.run(8000 / u64::from(shorter), 1e-4).unwrap();
    let energy = simulation.energy().unwrap();
    let body = last_body(&mut simulation);
    assert!((body.position.y - 0.3).abs() < 1e-3, "{backend}: {body:?}");
    assert!(shorter > 1 || energy.kinetic < 1e-5, "{backend}: {energy:?}");
    assert!(body.orientation.dot(turn).abs() > 0.99999, "{backend}: {body:?}");
}

/// A cube on an incline slides if the slope is steeper than friction; a tall box tips over its edge instead.
#[test]
fn a_box_slides_or_tips() {
    for (slope, edges, slides, tips) in
        [(0.3, [0.2, 0.2, 0.2], false, false), (0.5, [0.2, 0.2, 0.2], true, false), (0.35, [0.1, 0.4, 0.2], false, true)]
    {
        let (mut scene, material) = stage(9.81, Pair::default().restitution(0.2).friction(0.4));
        let angle = f32::atan(slope);
        scene.settings.gravity_direction = Vec3::new(angle.sin(), -angle.cos(), 0.0);
        floor(&mut scene, material);
        let shape = scene.add_shape(block(material, edges)).unwrap();
        scene.add_body(Placement::new(shape).at([0.0, f64::from(0.5 * edges[1]), 0.0])).unwrap();
        let mut simulation = open(scene, Backend::Cpu);
        simulation.run(10_000, 5e-5).unwrap();
        let body = last_body(&mut simulation);
        let up = (body.orientation * Vec3::Y).y;
        assert_eq!(up < 0.99, tips, "slope {slope}: {body:?}");
        if !tips {
            // x = (sin a - mu cos a) g t² / 2
            let exact = if slides { 0.5 * 9.81 * (angle.sin() - 0.4 * angle.cos()) * 0.25 } else { 0.0 };
            assert!((body.position.x - exact).abs() < 0.02 * exact.max(0.02), "slope {slope}: {body:?} {exact}");
        }
    }
}

/// Elastic boxes that meet corner to face, edge to edge and edge to ball keep energy, momentum and angular momentum.
fn impacts_of_boxes_keep_what_they_must(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    for seed in 0..4 / shorter {
        let (mut scene, material) = stage(0.0, Pair::default().restitution(1.0).friction(0.0));
        let shape = scene.add_shape(block(material, [0.3, 0.4, 0.2])).unwrap();
        let tilt = 0.4 * f32::from(seed);
        let place = |x: f64| Placement::new(shape).at([x, 0.01 * f64::from(seed), 0.0]);
        let one = place(-0.4).turned(Quat::from_euler(EulerRot::XYZ, tilt, 0.7, 0.3));
        scene.add_body(one.velocity([1.0, 0.0, 0.0]).spin([1.0, 2.0, 3.0])).unwrap();
        scene.add_body(place(0.1).turned(Quat::from_rotation_z(tilt)).spin([0.0, 1.0, 0.0])).unwrap();
        scene
            .add_sphere(Sphere::new([0.6, 0.05, 0.0], 0.1).density(1000.0).velocity([-0.5, 0.0, 0.0]).material(material))
            .unwrap();
        let mut simulation = open(scene, backend);
        let first = simulation.energy().unwrap();
        simulation.run(20_000, 5e-5).unwrap();
        let last = simulation.energy().unwrap();
        let change = (last.kinetic + last.contact) / first.kinetic - 1.0;
        println!("{backend} {seed}: {change}");
        assert!(change.abs() < 0.06, "{backend} {seed}: {change}, {first:?} {last:?}");
        let size = first.momentum.length().max(1.0);
        assert!((last.momentum - first.momentum).length() < 1e-5 * size, "{backend} {seed}: {first:?} {last:?}");
        assert!(
            (last.angular_momentum - first.angular_momentum).length() < 1e-4 * size,
            "{backend} {seed}: {first:?} {last:?}"
        );
        assert!(last_body(&mut simulation).velocity.length() > 0.05, "{backend} {seed}: they met");
    }
}

/// Lists leave out parts of bodies that never touch. All broad phases find the same pairs, so the same bits follow.
fn broad_phases_find_the_same_contacts(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    let states = [BroadPhase::BruteForce, BroadPhase::Grid, BroadPhase::SortAndSkip].map(|broad_phase| {
        let (mut scene, material) = stage(9.81, Pair::default().restitution(0.4).friction(0.5));
        floor(&mut scene, material);
        let shape = scene.add_shape(block(material, [0.4, 0.2, 0.3])).unwrap();
        for number in 0..6_u8 {
            let turn = Quat::from_rotation_z(0.3 * f32::from(number)) * Quat::from_rotation_y(0.1 * f32::from(number));
            let place = [0.05 * f64::from(number), 0.11 + 0.36 * f64::from(number), 0.0];
            scene.add_body(Placement::new(shape).at(place).turned(turn)).unwrap();
        }
        // Its corners meet the face of a box.
        scene.add_box(Cuboid::between([0.04, -0.5, -0.03], [0.1, 0.02, 0.03]).material(material)).unwrap();
        scene.add_sphere(Sphere::new([0.9, 0.2, 0.0], 0.1).density(1000.0).material(material)).unwrap();
        let options = Options::new().backend(backend).integrator(Integrator::VelocityVerlet).broad_phase(broad_phase);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        simulation.run(4000 / u64::from(shorter), 1e-4).unwrap();
        let state = |body: &RigidBody| (body.centre(), body.velocity, body.angular_momentum, body.orientation);
        let bodies: Vec<_> = simulation.sync().unwrap().bodies().iter().map(state).collect();
        assert!(simulation.report().contacts >= 4, "{backend}");
        bodies
    });
    assert_eq!(states[0], states[1], "{backend}: grid");
    assert_eq!(states[0], states[2], "{backend}: sort-and-skip");
}

/// A ray meets the faces of a turned box, and neither the sphere that stands for it nor its vertices and edges.
#[test]
fn rays_meet_the_faces_of_a_box() {
    let (mut scene, material) = stage(0.0, Pair::default());
    let shape = scene.add_shape(block(material, [0.4, 0.2, 0.2])).unwrap();
    let body = scene.add_body(Placement::new(shape).at([1.0, 0.0, 0.0]).turned(Quat::from_rotation_z(0.5))).unwrap();
    let solid = scene.body(body).unwrap().spheres()[0];
    let mut simulation = open(scene, Backend::Cpu);
    // Along x through the centre: the long face is h / sin a away from the centre, nearer than the end at H / cos a.
    let hit = simulation.cast_ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]).unwrap().expect("a hit");
    assert_eq!(hit.body, Body::Sphere(solid));
    assert!((hit.distance - (1.0 - 0.1 / 0.5_f32.sin())).abs() < 1e-5, "{hit:?}");
    let normal = Quat::from_rotation_z(0.5) * Vec3::Y;
    assert!(hit.normal.distance(normal) < 1e-5, "{hit:?}");
    assert_eq!(simulation.cast_ray([0.0, 0.15, 0.0], [1.0, 0.0, 0.0]).unwrap().map(|hit| hit.body), Some(Body::Sphere(solid)));
    // Past a corner and past a face, but inside the sphere around the box.
    for origin in [[0.0, 0.2, 0.0], [0.0, 0.0, 0.15]] {
        assert_eq!(simulation.cast_ray(origin, [1.0, 0.0, 0.0]).unwrap(), None);
    }
}

/// A plank lies on a narrow post, whose four corners meet the middle of its face, with both kinds of laws. It fell through the post.
fn a_plank_rests_on_the_corners_of_a_post(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    for law in [ContactLaw::Linear, ContactLaw::Thesis] {
        let (mut scene, material) = stage(9.81, Pair::default().restitution(0.2).friction(0.5));
        if law == ContactLaw::Thesis {
            scene.settings.set("contact_law", "thesis").unwrap();
            (scene.settings.collisions, scene.settings.contact_force, scene.settings.contact_damping) = (false, 1e5, 300.0);
        }
        scene.add_box(Cuboid::between([-0.1, 0.0, -0.1], [0.1, 1.0, 0.1]).material(material)).unwrap();
        let shape = scene.add_shape(block(material, [1.0, 0.2, 1.0])).unwrap();
        scene.add_body(Placement::new(shape).at([0.02, 1.1005, 0.01])).unwrap();
        let mut simulation = open(scene, backend);
        simulation.run(4000 / u64::from(shorter), 1e-4).unwrap();
        let (body, contacts) = (last_body(&mut simulation), simulation.contacts().unwrap());
        assert!((body.position.y - 1.1).abs() < 1e-3 && contacts.len() == 4, "{backend} {law}: {body:?} {contacts:?}");
        assert!(contacts.iter().all(|contact| (contact.point.y - 1.0).abs() < 1e-3), "{contacts:?}");
    }
}

/// A plank on the peak of four triangles has one contact: the triangles share the corner. A peak below a nearer wall is not felt.
fn a_corner_of_several_walls_counts_once(backend: Backend) {
    let (mut scene, material) = stage(9.81, Pair::default().restitution(0.2).friction(0.5));
    let foot = |number: usize| [[0.3, 0.0, 0.3], [-0.3, 0.0, 0.3], [-0.3, 0.0, -0.3], [0.3, 0.0, -0.3]][number % 4];
    for number in 0..4 {
        let triangle = Polygon::triangle([0.0, 1.0, 0.0], foot(number), foot(number + 1));
        scene.add_polygon(triangle.material(material)).unwrap();
    }
    // Its top is above the peak by less than the overlap.
    scene.add_box(Cuboid::between([5.0, 0.0, 5.0], [5.4, 1.0, 5.4]).material(material)).unwrap();
    scene.add_box(Cuboid::between([4.8, 0.0, 4.8], [5.6, 1.0001, 5.6]).material(material)).unwrap();
    let shape = scene.add_shape(block(material, [1.0, 0.2, 1.0])).unwrap();
    for x in [0.0, 5.2] {
        scene.add_body(Placement::new(shape).at([x, 1.0999, f64::from(x as f32)])).unwrap();
    }
    let mut simulation = open(scene, backend);
    simulation.run(1, 1e-5).unwrap();
    let contacts = simulation.contacts().unwrap();
    let places: Vec<Vec3> = contacts.iter().map(|contact| contact.point).collect();
    let (peak, box_): (Vec<Vec3>, Vec<Vec3>) = places.iter().partition(|place| place.x < 2.0);
    assert!(peak.len() == 1 && peak[0].distance(Vec3::Y) < 1e-3, "{backend}: {places:?}");
    // The corners of the inner box are no corners of the surface.
    assert_eq!(box_.len(), 4, "{backend}: {places:?}");
    assert!(box_.iter().all(|place| (place.x - 5.2).abs() > 0.3), "{backend}: {places:?}");
}

/// A box slides without friction over tiles and over triangles as over one floor: it meets no corners.
fn a_box_slides_over_tiles_as_over_one_floor(backend: Backend) {
    let slide = |backend: Backend, kind: u32, steps: u64| {
        let (mut scene, material) = stage(9.81, Pair::default().restitution(0.2).friction(0.0));
        for x in -3..5 {
            for z in -2..2 {
                let [x, z] = [x, z].map(|number: i32| 0.37 * number as f32);
                if kind == 1 {
                    scene.add_box(Cuboid::between([x, -1.0, z], [x + 0.37, 0.0, z + 0.37]).material(material)).unwrap();
                } else if kind == 2 {
                    let corner = |i: f32, k: f32| [x + 0.37 * i, 0.0, z + 0.37 * k];
                    for triangle in [
                        [corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0)],
                        [corner(0.0, 0.0), corner(1.0, 1.0), corner(1.0, 0.0)],
                    ] {
                        scene.add_polygon(Polygon::triangle(triangle[0], triangle[1], triangle[2]).material(material)).unwrap();
                    }
                }
            }
        }
        if kind == 0 {
            floor(&mut scene, material);
        }
        let shape = scene.add_shape(block(material, [0.4, 0.2, 0.3])).unwrap();
        let turned = Placement::new(shape).at([-0.5, 0.1, 0.0]).turned(Quat::from_rotation_y(0.3)).velocity([1.0, 0.0, 0.1]);
        scene.add_body(turned).unwrap();
        let mut simulation = open(scene, backend);
        simulation.run(steps, 1e-4).unwrap();
        (last_body(&mut simulation), simulation.contacts().unwrap().len())
    };
    let shorter = on(backend, 1_u8, 4);
    let steps = 10_000 / u64::from(shorter);
    for kind in [0, 1, 2] {
        let (body, contacts) = slide(backend, kind, steps);
        assert_eq!(contacts, 4, "{backend} {kind}");
        assert!((body.velocity.x - 1.0).abs() < 2e-4 && body.velocity.y.abs() < 1e-4, "{backend} {kind}: {body:?}");
        assert!((body.position.y - 0.1).abs() < 1e-4 && body.angular_momentum.length() < 1e-3, "{backend} {kind}: {body:?}");
    }
}

/// A post that rises carries a plank with it.
fn a_moving_post_carries_a_plank(backend: Backend) {
    let shorter = on(backend, 1_u8, 4);
    let (mut scene, material) = stage(9.81, Pair::default().restitution(0.2).friction(0.5));
    let motion = scene.add_motion(Motion::new("up", MotionTerm::translation([0.3, 0.5, 0.0]))).unwrap();
    let post = scene.add_box(Cuboid::between([-0.1, 0.0, -0.1], [0.1, 1.0, 0.1]).material(material)).unwrap();
    scene.set_motion(post, Some(motion)).unwrap();
    let shape = scene.add_shape(block(material, [1.0, 0.2, 1.0])).unwrap();
    scene.add_body(Placement::new(shape).at([0.0, 1.1, 0.0]).velocity([0.3, 0.5, 0.0])).unwrap();
    let mut simulation = open(scene, backend);
    let steps = 4000 / u64::from(shorter);
    simulation.run(steps, 1e-4).unwrap();
    let (body, time) = (last_body(&mut simulation), 1e-4 * steps as f32);
    let expected = Vec3::new(0.3 * time, 1.1 + 0.5 * time, 0.0);
    assert!(body.position.distance(expected) < 1e-3 && body.angular_momentum.length() < 0.05, "{backend}: {body:?}");
}
