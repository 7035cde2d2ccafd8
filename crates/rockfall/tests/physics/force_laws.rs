//! Forces that a program defines (docs/physics section 4.14), as WGSL and as functions of Rust, on both backends.

mod kept;
mod messages;
mod motion;

use rockfall::glam::Vec3;
use rockfall::{
    Backend, Capsule, ForceInput, ForceLaw, ForceLoad, Integrator, Options, Placement, Rod, Scene, Shape, Simulation, Sphere,
};

use crate::common::*;

/// Linear drag, as WGSL and as a function.
fn drag() -> ForceLaw {
    let function = |body: &ForceInput<'_>| -body.parameters[0] * body.velocity;
    ForceLaw::new("drag").parameter("c", 0.75).wgsl("force = -c * velocity;").function(function)
}

/// A harmonic trap that also slows spins.
fn trap() -> ForceLaw {
    let wgsl = "let d = position - vec3f(x, 0.5, 0.0);\nforce = -k * d;\ntorque = -0.1 * angular_velocity;";
    let function = |body: &ForceInput<'_>| {
        let force = -body.parameters[0] * (body.position - Vec3::new(body.parameters[1], 0.5, 0.0));
        ForceLoad { force, torque: -0.1 * body.angular_velocity }
    };
    ForceLaw::new("trap").parameter("k", 3.0).parameter("x", 0.25).wgsl(wgsl).function(function)
}

/// The force of a magnetic field on a charge that is proportional to the volume.
fn magnet() -> ForceLaw {
    let wgsl = "let charge = q * radius * radius * radius;\nforce = charge * cross(velocity, vec3f(0.0, 0.0, b));";
    let function = |body: &ForceInput<'_>| {
        let charge = body.parameters[0] * body.radius.powi(3);
        charge * body.velocity.cross(Vec3::new(0.0, 0.0, body.parameters[1]))
    };
    ForceLaw::new("magnet").parameter("q", 8.0).parameter("b", 2.0).wgsl(wgsl).function(function)
}

/// The law without its function, so that the CPU backend evaluates the WGSL.
fn without_function(law: &ForceLaw) -> ForceLaw {
    let start = ForceLaw::new(law.name()).wgsl(law.wgsl_text().expect("a text"));
    law.parameters().iter().fold(start, |law, (name, value)| law.parameter(name, *value))
}

fn with_laws(scene: Scene, backend: Backend, laws: impl IntoIterator<Item = ForceLaw>) -> Simulation {
    let options = laws.into_iter().fold(Options::new().backend(backend), Options::force_law);
    Simulation::with_options(scene, options).expect("the simulation opens")
}

/// Spheres of all sizes, a rod, a capsule and a spring, some of which touch. There are no impulses, whose kernels have nothing to do with
/// the laws.
fn crowd() -> Scene {
    let mut scene = with(|settings| (settings.gravity, settings.collisions) = (1.0, false));
    floor_box(&mut scene);
    let ball = |x: f32, radius: f32| {
        Sphere::new([x, radius + 0.01, 0.3], radius).velocity([1.0, 0.5, -0.5]).angular_momentum([0.2, 0.1, 0.3])
    };
    let fixed = Sphere::new([0.0, 3.0, 0.0], 0.2).fixed();
    let [_, b, ..] = spheres(&mut scene, [ball(-2.0, 1.0), ball(0.0, 0.25), ball(0.4, 0.2), ball(2.0, 0.3), fixed]);
    let [c, d] = spheres(&mut scene, [ball(3.0, 0.2), ball(3.8, 0.2)]);
    scene.add_rod(Rod::new(c, d, 0.1).length(0.8)).expect("a rod");
    scene.add_capsule(Capsule::new([-0.5, 1.0, 2.0], [0.5, 1.2, 2.0], 0.2).mass(2.0)).expect("a capsule");
    scene.add_spring(rockfall::Spring::new(b, c, 2.0, 2.5)).expect("a spring");
    scene
}

/// Asserts that two simulations are in the same state up to a tolerance.
#[track_caller]
fn assert_agree(one: &mut Simulation, other: &mut Simulation, tolerance: f64, what: &str) {
    let [one, other] = [one, other].map(|simulation| simulation.spheres().expect("the state"));
    for (index, (a, b)) in one.iter().zip(&other).enumerate() {
        near(a.position, b.position.as_dvec3(), tolerance, &format!("{what}: position of sphere {index}"));
        near(a.velocity, b.velocity.as_dvec3(), tolerance, &format!("{what}: velocity of sphere {index}"));
        near(a.angular_momentum, b.angular_momentum.as_dvec3(), tolerance, &format!("{what}: spin of sphere {index}"));
    }
}
