//! Contact laws that a program gives (docs/physics section 4.15).

use crate::common::bits_of;

mod equal;
mod kept;
mod messages;
mod response;

use rockfall::{
    Backend, ContactForceLaw, ContactInput, ContactLaw, ContactResponse, Cuboid, Integrator, Material, Options, Pair, Scene,
    Settings, Simulation, Sphere,
};

/// The law `hertz-mindlin` with the damping `g`.
fn hertz() -> ContactForceLaw {
    let wgsl = "let a = sqrt(radius * overlap);\n\
                let normal = 2.0 * young * a;\n\
                normal_force = 2.0 / 3.0 * normal * overlap + g * sqrt(normal * mass) * speed;\n\
                tangential_stiffness = 8.0 * shear * a;\n\
                tangential_damping = g * sqrt(tangential_stiffness * mass);";
    let function = |contact: &ContactInput<'_>| {
        let (a, g) = ((contact.radius * contact.overlap).sqrt(), contact.parameters[0]);
        let (normal, tangential) = (2.0 * contact.young * a, 8.0 * contact.shear * a);
        ContactResponse {
            normal_force: 2.0 / 3.0 * normal * contact.overlap + g * (normal * contact.mass).sqrt() * contact.speed,
            tangential_stiffness: tangential,
            tangential_damping: g * (tangential * contact.mass).sqrt(),
        }
    };
    ContactForceLaw::new("hertz").parameter("g", 0.0).wgsl(wgsl).function(function)
}

/// The law `linear` with stiffness `k` and damping `g`.
fn linear() -> ContactForceLaw {
    let wgsl = "normal_force = k * overlap + g * sqrt(k * mass) * speed;\n\
                tangential_stiffness = 2.0 / 7.0 * k;\n\
                tangential_damping = g * sqrt(tangential_stiffness * mass);";
    let function = |contact: &ContactInput<'_>| {
        let [k, g] = [contact.parameters[0], contact.parameters[1]];
        let tangential = 2.0 / 7.0 * k;
        ContactResponse {
            normal_force: k * contact.overlap + g * (k * contact.mass).sqrt() * contact.speed,
            tangential_stiffness: tangential,
            tangential_damping: g * (tangential * contact.mass).sqrt(),
        }
    };
    ContactForceLaw::new("linear spring").parameter("k", 1e4).parameter("g", 0.0).wgsl(wgsl).function(function)
}

/// The law without its function, so that the CPU backend evaluates the WGSL.
fn without_function(law: &ContactForceLaw) -> ContactForceLaw {
    let start = ContactForceLaw::new(law.name()).wgsl(law.wgsl_text().expect("a text"));
    law.parameters().iter().fold(start, |law, (name, value)| law.parameter(name, *value))
}

/// The damping g for which an impact by a law rebounds with `restitution`.
fn damping_for(law: &ContactForceLaw, restitution: f64) -> f32 {
    let mut contact = ContactInput::default();
    (contact.radius, contact.mass, contact.young, contact.speed) = (0.25, 0.5, 1e5, 1.0);
    let (mut low, mut high) = (0.0, 4.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        let mut law = law.clone();
        law.set_parameter("g", middle).expect("a parameter");
        let impact = law.impact(&contact).expect("a valid law").expect("a rebound");
        if impact.restitution > restitution { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A scene with a law, without gravity and impulses.
fn scene_with(law: ContactLaw) -> Scene {
    let mut scene = Scene::new();
    scene.settings = Settings::default().with(|settings| {
        (settings.contact_law, settings.collisions, settings.gravity) = (law, false, 0.0);
    });
    scene
}

/// Balls and a floor of a soft material with friction and all resistances.
fn tumble(law: ContactLaw, restitution: f32) -> Scene {
    let mut scene = scene_with(law);
    scene.settings.gravity = 10.0;
    let soft = scene.add_material(Material::new("soft").density(1.0).young(1e5).poisson(0.25)).expect("a material");
    let pair =
        Pair::default().restitution(restitution).friction(0.5).stiffness(1e4).rolling_friction(0.1).twisting_friction(0.2);
    scene.set_pair(soft, soft, pair).expect("a pair");
    scene.add_box(Cuboid::between([-4.0, -1.0, -4.0], [4.0, 0.0, 4.0]).material(soft)).expect("a box");
    for (k, radius) in [0.5, 0.4, 0.5, 0.3].into_iter().enumerate() {
        let x = [-0.5, 0.42, 0.1, -0.3][k];
        let ball = Sphere::new([x, radius - 0.01 + [0.0, 0.0, 0.8, 0.7][k], [0.0, 0.1, 0.3, -0.55][k]], radius);
        let ball = ball.density(1.0).material(soft).velocity([-2.0 * x, -0.5, 0.3]).angular_momentum([0.05, 0.1, -0.05]);
        scene.add_sphere(ball).expect("a ball");
    }
    scene
}

fn options(backend: Backend) -> Options {
    Options::new().backend(backend).integrator(Integrator::SymplecticEuler)
}

fn open(scene: &Scene, backend: Backend, law: ContactForceLaw) -> Simulation {
    Simulation::with_options(scene.clone(), options(backend).contact_force_law(law)).expect("the simulation opens")
}

/// Two balls of mass 2 and radius 0.1 that approach each other along x at `speed`, without gravity.
fn impact(speed: f32) -> Scene {
    let mut scene = scene_with(ContactLaw::User);
    for x in [-0.1_f32, 0.1] {
        let ball = Sphere::new([x, 0.0, 0.0], 0.1).mass(2.0).velocity([-0.5 * speed * x.signum(), 0.0, 0.0]);
        scene.add_sphere(ball).expect("a ball");
    }
    scene
}

/// Largest difference of two states, in units and units/s; angular momenta are left out.
fn difference(one: &mut Simulation, other: &mut Simulation) -> f32 {
    let states = [one, other].map(|simulation| simulation.spheres().expect("spheres are read back"));
    let [one, other] = states;
    let pairs = one.iter().zip(&other);
    pairs.map(|(a, b)| a.position.distance(b.position).max(0.1 * a.velocity.distance(b.velocity))).fold(0.0, f32::max)
}
