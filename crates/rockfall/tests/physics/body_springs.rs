//! Springs of contacts of rigid bodies, which go along from sphere to sphere (docs/physics.md section 4.11).

use rockfall::glam::Vec3;
use rockfall::{Backend, ContactLaw, Cuboid, Integrator, Material, MaterialId, Pair, Placement, Scene, Shape, Sphere};

use crate::common::{on, open, with};

both! {
    a_rocker_on_a_slope_does_not_creep,
}

/// Radius of the arc of the centres of the spheres, and of the spheres.
const ARC: f32 = 1.0;
const RADIUS: f32 = 0.1;
/// How far the centre of mass is below the centre of the arc.
const DEPTH: f32 = 0.8;
/// Radius of the ball that it rolls on.
const BALL: f32 = 50.0;

/// A slope of 10 degrees: the ground is level, and gravity leans.
fn slope(law: ContactLaw) -> (Scene, MaterialId) {
    let mut scene = with(|settings| {
        settings.set("contact_law", &law.to_string()).expect("a law");
        (settings.gravity, settings.collisions) = (9.81, false);
        settings.gravity_direction = Vec3::new(10f32.to_radians().sin(), -10f32.to_radians().cos(), 0.0);
    });
    let stuff = scene.add_material(Material::new("stuff").density(1000.0).young(1e6).poisson(0.3)).unwrap();
    scene.set_pair(stuff, stuff, Pair::default().restitution(0.8).friction(0.8).stiffness(7e3)).unwrap();
    (scene, stuff)
}

/// Two arcs of spheres, one every 3 degrees.
fn rocker(material: MaterialId) -> Shape {
    let mut shape = Shape::new().material(material);
    for side in [-0.5, 0.5] {
        for number in -6..=6 {
            let angle = (3.0 * number as f32).to_radians();
            shape = shape.sphere([ARC * angle.sin(), -ARC * angle.cos(), side], RADIUS);
        }
    }
    shape.mass_properties(1.0, [0.0, -DEPTH, 0.0], [0.2, 0.2, 0.2, 0.0, 0.0, 0.0])
}

/// A rocker of spheres swings on a slope, on a box or on a large ball that was added before it. Its contact goes from sphere to sphere and
/// back, and it does not creep: the path of the centre of its arc stays that of rolling.
fn a_rocker_on_a_slope_does_not_creep(backend: Backend) {
    let cases = [(ContactLaw::Linear, false), (ContactLaw::Linear, true), (ContactLaw::HertzMindlin, false)];
    for (law, on_ball) in cases.into_iter().take(on(backend, 3, 2)) {
        let (mut scene, stuff) = slope(law);
        if on_ball {
            scene.add_sphere(Sphere::new([0.0, -BALL, 0.0], BALL).fixed().material(stuff)).unwrap();
        } else {
            scene.add_box(Cuboid::between([-9.0, -1.0, -9.0], [9.0, 0.0, 9.0]).material(stuff)).unwrap();
        }
        let shape = scene.add_shape(rocker(stuff)).unwrap();
        let body = scene.add_body(Placement::new(shape).at([0.0, f64::from(ARC + RADIUS - 5e-4), 0.0])).unwrap();
        let mut simulation = open(scene, backend, Integrator::VelocityVerlet);
        let (mut swing, mut slips) = (0.0f32, Vec::new());
        for _ in 0..on(backend, 60, 15) {
            simulation.run(500, 2e-4).unwrap();
            let body = simulation.sync().unwrap().body(body).unwrap().clone();
            let turn = 2.0 * body.orientation.z.atan2(body.orientation.w);
            let centre = body.position.x - DEPTH * turn.sin();
            let about = BALL + ARC + RADIUS;
            slips.push(if on_ball { about * (centre / about).asin() } else { centre } + (ARC + RADIUS) * turn);
            swing = swing.min(turn.to_degrees());
        }
        // It has landed after half a second.
        let creep = slips[slips.len() - 1] - slips[5];
        println!("{backend} {law} {on_ball}: creeps {creep:.2e}, to {swing:.1} degrees");
        assert!(swing < -6.0, "{backend} {law}: it swings over two spheres, to {swing} degrees");
        assert!(creep.abs() < 5e-4, "{backend} {law}: {creep}");
    }
}
