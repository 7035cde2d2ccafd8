//! Single responses: the function of Rust against the WGSL, and the arguments that a kernel gives to a law.

use super::*;

/// The next number of a sequence from 0 to 1 (a linear congruential generator).
fn random(state: &mut u64) -> f32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1_u64 << 24) as f32
}

/// Function and WGSL give the same within rounding for random contacts.
#[test]
fn function_and_text_agree_for_random_contacts() {
    let mut seed = 5;
    for law in [hertz(), linear()] {
        let text = without_function(&law);
        for _ in 0..500 {
            let mut contact = ContactInput::default();
            contact.overlap = 10.0_f32.powf(-6.0 * random(&mut seed));
            contact.speed = 4.0 * random(&mut seed) - 2.0;
            (contact.radius, contact.mass) = (0.01 + random(&mut seed), 0.01 + random(&mut seed));
            (contact.young, contact.shear) = (1e5 * random(&mut seed), 1e5 * random(&mut seed));
            let parameters = [1e4 * random(&mut seed), random(&mut seed)];
            contact.parameters = if law.name() == "hertz" { &parameters[1..] } else { &parameters };
            let [one, other] = [&law, &text].map(|law| law.response(&contact).expect("a response"));
            let values = |r: ContactResponse| [r.normal_force, r.tangential_stiffness, r.tangential_damping];
            // The parts of the normal force may cancel.
            let scale = 1e-6 * values(one)[0].abs().max((1e4 * contact.overlap).max(100.0));
            for (one, other) in values(one).into_iter().zip(values(other)) {
                assert!((one - other).abs() <= scale.max(2e-6 * one.abs()), "{}: {one}, {other}", law.name());
            }
        }
    }
}

/// Laws without an impact: without a force, with a force that is infinite at the start, and without speed.
#[test]
fn law_without_a_rebound_has_no_impact() {
    let mut contact = ContactInput::default();
    (contact.radius, contact.mass, contact.speed) = (0.1, 1.0, 1.0);
    for force in ["0.0 * overlap", "1.0 / overlap", "2.0 * speed"] {
        let law = ContactForceLaw::new("none").wgsl(format!("normal_force = {force};"));
        assert_eq!(law.impact(&contact).expect("a valid law"), None, "{force}");
    }
    contact.speed = 0.0;
    assert_eq!(hertz().impact(&contact).expect("a valid law"), None);
    contact.speed = f32::NAN;
    assert_eq!(linear().impact(&contact).expect("a valid law"), None);
    contact.parameters = &[1.0];
    assert!(linear().impact(&contact).expect_err("two parameters").to_string().contains("expected 2 parameters, got 1"));
}

/// A law that depends on all of its inputs and parameters, in its two forms. `wrong` exchanges or drops an argument of the function.
#[cfg(feature = "gpu")]
fn of_all_inputs(wrong: usize) -> [ContactForceLaw; 2] {
    let wgsl = "normal_force = 1e3 * overlap + 2.0 * speed + 30.0 * radius + 5.0 * mass + 1e-4 * young + 1e-3 * shear + p + 3.0 * q;\n\
                tangential_stiffness = 1e3 * p;\ntangential_damping = q;";
    let law = || ContactForceLaw::new("all").parameter("p", 2.0).parameter("q", 3.0);
    let function = move |contact: &ContactInput<'_>| {
        let mut inputs = [
            contact.overlap,
            contact.speed,
            contact.radius,
            contact.mass,
            contact.young,
            contact.shear,
            contact.parameters[0],
            contact.parameters[1],
        ];
        let last = inputs.len();
        match wrong {
            0 => {}
            // The hook of kernels without a law.
            9 => return ContactResponse::default(),
            argument => inputs.swap(argument - 1, argument % last),
        }
        let weights = [1e3, 2.0, 30.0, 5.0, 1e-4, 1e-3, 1.0, 3.0];
        ContactResponse {
            normal_force: inputs.iter().zip(weights).map(|(input, weight)| input * weight).sum(),
            tangential_stiffness: 1e3 * inputs[6],
            tangential_damping: inputs[7],
        }
    };
    [law().function(function), law().wgsl(wgsl)]
}

/// The comparison of the backends accepts the right arguments, and detects each pair of exchanged ones and a missing law.
#[cfg(feature = "gpu")]
#[test]
fn comparison_of_the_backends_detects_wrong_arguments() {
    let scene = tumble(ContactLaw::User, 1.0);
    let run = |backend, law| {
        let mut simulation = open(&scene, backend, law);
        simulation.run(10, 1e-3).expect("steps");
        simulation
    };
    let [_, text] = of_all_inputs(0);
    let mut gpu = run(Backend::Gpu, text);
    for wrong in 0..=9 {
        let [function, _] = of_all_inputs(wrong);
        let off = difference(&mut run(Backend::Cpu, function), &mut gpu);
        assert!((off < 1e-5) == (wrong == 0), "mistake {wrong}: {off}");
    }
}
