use super::*;
use crate::user_laws::ContactResponse;
use crate::{Integrator, Material, Pair, Scene, Settings, Sphere};

/// Text in which a user finds the names of the laws.
const DOCS: [(&str, &str); 4] = [
    ("settings.rs", include_str!("../settings.rs")),
    ("docs/guide.md", include_str!("../../../../docs/guide.md")),
    ("docs/models.md", include_str!("../../../../docs/models.md")),
    ("typing.py", include_str!("../../../rockfall-python/python/rockfall/typing.py")),
];

fn with_contact<T>(law: &dyn GrainLaw, overlap: f32, approach: f32, of: impl FnOnce(&Contact) -> T) -> T {
    let function = |contact: &crate::ContactInput| ContactResponse {
        normal_force: 1e4 * contact.overlap + 3.0 * contact.speed,
        tangential_stiffness: 3e3,
        tangential_damping: 2.0,
    };
    let springs = ContactForceLaw::new("springs").function(function);
    let program = Some((&springs, [0.0; MOST_PARAMETERS]));
    let [normal, tangential] = law.constants(&given()).expect("constants");
    let (friction, rolling, rolling_damping, twisting) = (0.5, 0.0, 0.0, 0.0);
    let constants = Constants { normal, tangential, damping: 0.2, friction, rolling, rolling_damping, twisting, cohesion: 0.0 };
    let bodies = Bodies { radius: 0.05, mass: 0.5 };
    let before = Some(2.0 * overlap);
    of(&Contact { constants: &constants, bodies: &bodies, overlap, approach, before, resists: true, program })
}

fn given() -> Given {
    Given { stiffness: Some(1e4), characteristic_velocity: None, moduli: Some([1e5, 3e4]) }
}

fn files() -> impl Iterator<Item = (ContactLaw, &'static dyn GrainLaw)> {
    ContactLaw::ALL.into_iter().filter_map(|law| Some((law, law.grain()?)))
}

#[test]
fn every_law_is_read_printed_and_documented() {
    let mut settings = Settings::default();
    for law in ContactLaw::ALL {
        let name = law.name();
        settings.set("contact_law", name).expect("a law");
        assert_eq!((settings.contact_law, settings.get("contact_law").as_deref()), (law, Some(name)));
        assert!(settings.set("contact_law", "none").expect_err("no law").to_string().contains(name), "{name}");
        for (file, text) in DOCS {
            let is_named = [format!("`{name}`"), format!("\"{name}\"")].iter().any(|quoted| text.contains(quoted));
            assert!(is_named, "{file} does not name {name}");
        }
    }
}

#[test]
fn every_law_is_checked() {
    for (law, file) in files() {
        let mut scene = Scene::new();
        scene.settings.set("contact_law", law.name()).expect("a law");
        let bare = scene.add_material(Material::new("bare")).expect("a material");
        for x in [0.0, 3.0] {
            scene.add_sphere(Sphere::new([x, 0.0, 0.0], 1.0).material(bare)).expect("a sphere");
        }
        let check = |scene: &Scene| scene.check_contact_law(Integrator::VelocityVerlet);
        assert_eq!(check(&scene).is_ok(), matches!(file.needs(), Needs::Nothing), "{law}");
        scene.update_material(bare, |material| (material.young, material.poisson) = (Some(1e5), Some(0.3))).expect("valid");
        scene.set_pair(bare, bare, Pair::default().stiffness(1e4)).expect("a pair");
        check(&scene).expect("all that the law needs");
        assert!(scene.check_contact_law(Integrator::Rk4).is_err(), "{law}");
        // A law whose time is not known warns of nothing.
        assert_eq!(scene.law_time().is_some(), file.unit_impact().is_some(), "{law}");
    }
}

/// The force is the slope of the energy, and the slopes are those of the force.
#[test]
fn every_law_has_a_force_slopes_and_an_energy() {
    let near = |one: f64, other: f64| (one - other).abs() <= 2e-3 * other.abs();
    for (law, file) in files() {
        let press = |overlap, speed| f64::from(with_contact(file, overlap, speed, |contact| file.answer(contact).press));
        let energy = |overlap| with_contact(file, overlap, 0.0, |contact| file.energy(contact));
        let (d, h) = (1e-2_f32, 1e-4_f32);
        let twice = 2.0 * f64::from(h);
        let force = press(d, 0.0);
        assert!(force > 0.0 && near((energy(d + h) - energy(d - h)) / twice, force), "{law}");
        let [by_overlap, by_speed] = with_contact(file, d, 0.0, |contact| file.slopes(contact, 1e-3)).map(f64::from);
        assert!(near((press(d + h, 0.0) - press(d - h, 0.0)) / twice, by_overlap), "{law}: {by_overlap}");
        let v = 1e-2_f32;
        assert!(near((press(d, v) - press(d, -v)) / f64::from(2.0 * v), by_speed), "{law}: {by_speed}");
        let answer = with_contact(file, d, 0.0, |contact| file.answer(contact));
        assert!(answer.stiffness.tangential > 0.0 && answer.dashpot > 0.0, "{law}");
        assert!(near(answer.stiffness.normal.into(), by_overlap), "{law}");
    }
}

/// What is known of a law before a run agrees with its force.
#[test]
fn estimates_of_every_law_agree_with_its_force() {
    let bodies = Reduced { radius: 0.05_f32.into(), mass: 0.5 };
    for (law, file) in files().filter(|(_, file)| file.unit_impact().is_some()) {
        let at = |overlap: f64| {
            with_contact(file, overlap as f32, 0.0, |contact| (file.answer(contact).press, file.energy(contact)))
        };
        let (overlap, power) = file.overlap_under(&given(), bodies, 30.0).expect("an overlap");
        let near = |one: f64, other: f64| (one - other).abs() <= 1e-3 * other.abs();
        assert!(near(at(overlap).0.into(), 30.0), "{law}");
        assert!(near((f64::from(at(2.0 * overlap).0) / 30.0).log2(), power), "{law}");
        let (depth, _) = file.depth_at(&given(), bodies, 2.0).expect("a depth");
        assert!(near(at(depth).1, 0.5 * bodies.mass * 4.0), "{law}");
        let [force, double] = [1.0, 2.0].map(|overlap| file.relative_force(overlap));
        assert!(near((double / force).log2().into(), power), "{law}");
        // S ~ F^(1 - 1/p) ~ (R* o)^(p - 1) for F ~ o^p.
        assert!(near(file.stiffness_by_force(8.0).log2().into(), 3.0 * (1.0 - 1.0 / power)), "{law}");
        assert!(near(file.stiffness_by_overlap(4.0).log2().into(), 2.0 * (power - 1.0)), "{law}");
        let ball = Ball { radius: 0.1, mass: 1.0, elastic: Some([1e5, 0.3]), partners: &[given()] };
        let seconds = file.reaction_time(&ball).expect("a time");
        assert!(seconds > 0.0 && file.impact_time(&ball, 2.0).is_none_or(|impact| impact > seconds), "{law}: {seconds}");
    }
}

/// The WGSL of a law has every function.
#[test]
fn every_law_has_its_functions_for_kernels() {
    assert_eq!(WGSL.len(), files().count());
    for ((_, name, file, text), (function, _, kind, result)) in WGSL.iter().flat_map(|law| FUNCTIONS.map(|one| (law, one))) {
        let head = format!("fn {name}_{function}(");
        let found = text.lines().find(|line| line.starts_with(&head));
        let is_right = found.is_some_and(|line| line.ends_with(&format!(": {kind}) -> {result} {{")));
        assert!(is_right, "{file}: {head}...: {kind}) -> {result}");
    }
}
