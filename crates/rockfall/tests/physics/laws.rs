//! The contact laws with history, `linear` and `hertz-mindlin` (docs/physics section 4.11), against closed forms and an
//! independent computation in f64.

mod chains;
mod chung_ooi;
mod coarse;
mod cohesion;
mod jkr;
mod kept;
mod listed;
mod precision;
mod rest;
mod restitution;
mod rolling;
mod witness;

use rockfall::{Backend, ContactLaw, Integrator, Material, MaterialId, Options, Pair, Scene, Settings, Simulation, Sphere};

/// An empty scene with a law, without gravity and impulses.
pub(crate) fn scene_with(law: ContactLaw) -> Scene {
    let mut scene = Scene::new();
    scene.settings = Settings::default().with(|settings| {
        settings.contact_law = law;
        settings.collisions = false;
        settings.gravity = 0.0;
    });
    scene
}

/// Adds a material of density 1 that is so soft that impacts at 1 unit/s take some hundredths of a second.
pub(crate) fn soft(scene: &mut Scene, name: &str) -> MaterialId {
    scene.add_material(Material::new(name).density(1.0).young(1e5).poisson(0.25)).expect("a valid material")
}

pub(crate) fn pair(scene: &mut Scene, one: MaterialId, other: MaterialId, e: f32, mu: f32) {
    let pair = Pair::default().restitution(e).friction(mu).stiffness(1e4);
    scene.set_pair(one, other, pair).expect("a valid pair");
}

pub(crate) fn options(backend: Backend) -> Options {
    Options::new().backend(backend).integrator(Integrator::SymplecticEuler)
}

pub(crate) fn simulation(scene: Scene, backend: Backend) -> Simulation {
    Simulation::with_options(scene, options(backend)).expect("the simulation opens")
}

/// A sphere of a material and its density.
pub(crate) fn ball(scene: &Scene, material: MaterialId, position: [f32; 3], radius: f32) -> Sphere {
    let density = scene.material(material).expect("a material").density.expect("a density");
    Sphere::new(position, radius).density(density).material(material)
}

pub(crate) fn assert_close(found: f64, expected: f64, relative: f64, what: &str) {
    let error = (found - expected).abs() / expected.abs();
    assert!(error <= relative, "{what}: {found}, expected {expected} within {relative}, off by {error:.5}");
}

/// What a law needs is checked before the first step, and named.
#[test]
fn laws_that_lack_something_are_refused() {
    let refusal = |scene: &Scene, integrator| {
        let options = Options::new().backend(Backend::Cpu).integrator(integrator);
        Simulation::with_options(scene.clone(), options).map(drop).expect_err("refused").to_string()
    };
    let euler = Integrator::SymplecticEuler;
    let mut scene = scene_with(ContactLaw::HertzMindlin);
    scene.add_sphere(Sphere::new([0.0; 3], 0.5)).expect("a valid sphere");
    assert!(refusal(&scene, Integrator::Rk4).contains("symplectic-euler"), "{}", refusal(&scene, Integrator::Rk4));
    assert!(refusal(&scene, euler).contains("without a material for sphere number 0"), "{}", refusal(&scene, euler));

    let mut scene = scene_with(ContactLaw::HertzMindlin);
    let hard = scene.add_material(Material::new("hard").young(1e9)).expect("a valid material");
    scene.add_sphere(Sphere::new([0.0; 3], 0.5).material(hard)).expect("a valid sphere");
    assert!(refusal(&scene, euler).contains("the material 'hard'"), "{}", refusal(&scene, euler));
    scene.settings.contact_law = ContactLaw::Linear;
    let static_only = scene.add_material(Material::new("static")).expect("a valid material");
    scene.add_box(rockfall::Cuboid::between([9.0; 3], [10.0; 3]).material(static_only)).expect("a valid box");
    assert!(refusal(&scene, euler).contains("the pair 'hard' 'static'"), "{}", refusal(&scene, euler));
    // Neither a pair of which there is one object, nor a pair of static objects is needed.
    scene.set_pair(hard, static_only, Pair::default().stiffness(1e3)).expect("a valid pair");
    let mut running = simulation(scene, Backend::Cpu);

    // Also while a simulation runs. A refused change leaves everything as it was.
    let wanted = running.settings().with(|settings| settings.contact_law = ContactLaw::HertzMindlin);
    assert!(running.set_settings(wanted).is_err());
    assert_eq!(running.settings().contact_law, ContactLaw::Linear);
    running.run(1, 1e-3).expect("a step");
    running.update_material(hard, |material| material.poisson = Some(0.25)).expect("a valid material");
    let elastic = |material: &mut Material| (material.young, material.poisson) = (Some(1e9), Some(0.3));
    running.update_material(static_only, elastic).expect("a valid material");
    running.set_settings(wanted).expect("a complete law");
    running.run(1, 1e-3).expect("a step");
}

/// Setting a law by name switches collisions off, unless the scene sets them, before or after the law.
#[test]
fn a_law_switches_impulses_off_in_scene_texts() {
    let law = "set contact_law linear\n";
    for (text, collisions) in [
        (law.to_owned(), false),
        (format!("{law}set collisions on\n"), true),
        (format!("set collisions on\n{law}"), true),
        (format!("set collisions off\n{law}"), false),
        ("set contact_law thesis\n".to_owned(), true),
    ] {
        let scene = Scene::parse(&text, std::path::Path::new("law")).expect("a valid text").scene;
        assert_eq!(scene.settings.collisions, collisions, "{text}");
        let again = Scene::parse(&scene.to_text(), std::path::Path::new("law")).expect("a valid text").scene;
        assert_eq!(again.settings, scene.settings, "{text}");
    }
    let error = Scene::parse("set contact_law hertz\n", std::path::Path::new("law")).map(drop).expect_err("refused");
    assert!(error.to_string().contains("thesis, linear, hertz-mindlin, user or rigid"), "{error}");
}
