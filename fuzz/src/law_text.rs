//! The target `law_text`: any bytes as the text of a law.

use rockfall::{Backend, ContactForceLaw, ContactInput, ForceLaw, Integrator, Options, Scene, Simulation, Sphere};

use super::message::assert_short;

/// Reads any bytes as the text of a force law or a contact law. A refused text gets a short error. Accepted laws are evaluated, and
/// give the same numbers each time.
///
/// # Panics
/// When one of these promises is broken.
pub fn law_text(bytes: &[u8]) {
    let Some((kind, text)) = bytes.split_first() else { return };
    let text = String::from_utf8_lossy(text);
    if kind & 1 == 0 { force(&text) } else { contact(&text) }
}

fn force(text: &str) {
    let law = ForceLaw::new("pull").parameter("k", 2.0).wgsl(text);
    if let Err(error) = law.check() {
        return assert_short(&error);
    }
    let runs = [(); 2].map(|()| {
        let mut scene = Scene::new();
        for x in [0.0, 3.0] {
            let sphere = Sphere::new([x, 1.0, -2.0], 0.5).velocity([1.0, x, 0.0]).angular_momentum([0.5, 0.0, x]);
            scene.add_sphere(sphere).expect("a valid sphere");
        }
        let options = Options::new().backend(Backend::Cpu).integrator(Integrator::SymplecticEuler).force_law(law.clone());
        let mut simulation = Simulation::with_options(scene, options).expect("the law was checked");
        let end = simulation.run(2, 0.01).map(drop);
        end.as_ref().err().into_iter().for_each(assert_short);
        let states = simulation.spheres().expect("the CPU backend does not fail");
        assert!(states.iter().all(|state| state.velocity.is_finite() && state.angular_momentum.is_finite()), "{states:?}");
        format!("{end:?} {states:?}")
    });
    assert_eq!(runs[0], runs[1]);
}

fn contact(text: &str) {
    let law = ContactForceLaw::new("push").parameter("k", 2.0).wgsl(text);
    if let Err(error) = law.check() {
        return assert_short(&error);
    }
    for (overlap, speed) in [(0.0, 0.0), (0.01, 1.0), (0.5, -2.0), (1e-30, 1e30)] {
        let mut input = ContactInput::default();
        (input.overlap, input.speed, input.radius, input.mass) = (overlap, speed, 0.5, 1.0);
        (input.young, input.shear) = (1e5, 4e4);
        let [one, other] = [(); 2].map(|()| law.response(&input).expect("the law was checked"));
        assert_eq!(format!("{one:?}"), format!("{other:?}"));
    }
}
