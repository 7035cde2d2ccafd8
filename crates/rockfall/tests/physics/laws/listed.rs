//! Contacts of stiff grains, whose overlaps are far below 1e-5 of the radius: each is listed where its force is.

use rockfall::{Backend, ContactLaw, Cuboid, Integrator, Material, Pair, Precision, Scene, Simulation, Sphere};

use super::{assert_close, options, scene_with};

/// A column of two beads of 1 mm in equilibrium on a floor of the same glass. The contact under k beads carries k m g, with the overlap
/// (3 k m g / (4 E* sqrt R*))^(2/3) of `hertz-mindlin`, about 1e-6 of the radius, or k m g / k_n of `linear`.
fn column(law: ContactLaw) -> (Scene, f64) {
    let radius = f64::from(5e-4_f32);
    let (young, stiffness, gravity) = (6.3e10_f32, 3e5_f32, 9.81_f32);
    let mut scene = scene_with(law);
    scene.settings.precision = Precision::Double;
    scene.settings.gravity = gravity;
    let glass = scene.add_material(Material::new("glass").density(2500.0).young(young).poisson(0.24)).expect("a material");
    let pair = Pair::default().restitution(0.6).friction(0.3).stiffness(stiffness);
    scene.set_pair(glass, glass, pair).expect("a valid pair");
    scene.add_box(Cuboid::between([-0.01; 3], [0.01, 0.0, 0.01]).material(glass)).expect("a valid box");
    let bead = Sphere::new([0.0; 3], 5e-4).density(2500.0).material(glass);
    let weight = f64::from(bead.mass) * f64::from(gravity);
    let overlap = |force: f64, radius: f64| match law {
        ContactLaw::HertzMindlin => {
            let effective = f64::from(young) / (2.0 * (1.0 - 0.24 * 0.24));
            (3.0 * force / (4.0 * effective * radius.sqrt())).powf(2.0 / 3.0)
        }
        _ => force / f64::from(stiffness),
    };
    let low = radius - overlap(2.0 * weight, radius);
    let high = low + 2.0 * radius - overlap(weight, 0.5 * radius);
    for y in [low, high] {
        scene.add_sphere(bead.centred_at([0.0, y, 0.0])).expect("a valid sphere");
    }
    (scene, weight)
}

fn contacts_are_listed_where_their_forces_are(backend: Backend) {
    for law in [ContactLaw::Linear, ContactLaw::HertzMindlin] {
        let (scene, weight) = column(law);
        let options = options(backend).integrator(Integrator::VelocityVerlet);
        let mut simulation = Simulation::with_options(scene, options).expect("the simulation opens");
        simulation.run(20, 2e-8).expect("steps");
        assert_eq!(simulation.report().contacts, 2, "{law}");
        let mut forces: Vec<f64> =
            simulation.contacts().expect("contacts").iter().map(|contact| contact.normal_force().into()).collect();
        forces.sort_by(f64::total_cmp);
        assert_eq!(forces.len(), 2, "{law}: {forces:?}");
        for (found, expected) in forces.into_iter().zip([weight, 2.0 * weight]) {
            assert_close(found, expected, 0.02, "force");
        }
    }
}

both!(contacts_are_listed_where_their_forces_are);
