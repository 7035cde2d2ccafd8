//! Errors: where they are in the text, and what they say.

use rockfall::Worlds;

use super::*;

fn refused(law: ContactForceLaw) -> String {
    law.check().expect_err("a mistake").to_string()
}

fn with_text(text: &str) -> String {
    refused(ContactForceLaw::new("bond").parameter("k", 1.0).wgsl(text))
}

#[test]
fn mistakes_name_line_and_column() {
    for (text, expected) in [
        ("normal_force = k * overlap", "law 'bond', line 1: "),
        ("let a = 2.0;\nnormal_force = k * overlp;", "law 'bond', line 2, column 20: "),
        ("normal_force = vec3f(k);", "law 'bond', line 1, column 1: "),
        ("normal_force = k;\n  tangential_stifness = 1.0;", "law 'bond', line 2, column 3: "),
        ("normal_force = force;", "law 'bond', line 1, column 16: "),
        ("normal_force = 1.0; }", "law 'bond', line 1, column 21: this '}' closes nothing"),
    ] {
        let message = with_text(text);
        assert!(message.starts_with(expected), "{text}: {message}");
    }
    let message = with_text("normal_force = k * overlp;");
    assert!(
        message.contains("overlp") && message.ends_with("\n    normal_force = k * overlp;\n                       ^"),
        "{message}"
    );
}

#[test]
fn laws_that_lack_something_are_refused() {
    let law = || ContactForceLaw::new("bond").wgsl("normal_force = overlap;");
    let many = (0..9).fold(law(), |law, k| law.parameter(format!("p{k}"), 1.0));
    for (law, expected) in [
        (ContactForceLaw::new("bond"), "law 'bond': it has neither WGSL nor a function"),
        (law().parameter("speed", 1.0), "law 'bond': the name 'speed' of a parameter is taken"),
        (law().parameter("normal_force", 1.0), "law 'bond': the name 'normal_force' of a parameter is taken"),
        (law().parameter("k", f32::NAN), "law 'bond': parameter 'k' is NaN, expected a finite number"),
        (law().pair_parameter(["a", "b"], "k", 1.0), "law 'bond': it has no parameter 'k': it has none"),
        (many, "law 'bond': it has 9 parameters, expected at most 8"),
    ] {
        assert_eq!(refused(law), expected);
    }
}

/// What only the simulation knows.
#[test]
fn simulations_refuse_laws_that_do_not_suit_them() {
    let law = || ContactForceLaw::new("bond").parameter("k", 1.0).wgsl("normal_force = k * overlap;");
    let refused = |scene: &Scene, options: Options| {
        Simulation::with_options(scene.clone(), options).map(drop).expect_err("refused").to_string()
    };
    let scene = impact(1.0);
    let missing = refused(&scene, options(Backend::Cpu));
    assert!(missing.contains("contact_law") && missing.contains("a scene alone cannot define one"), "{missing}");
    let rk4 = refused(&scene, options(Backend::Cpu).integrator(Integrator::Rk4).contact_force_law(law()));
    assert!(rk4.contains("user with the integrator rk4"), "{rk4}");
    let named = law().pair_parameter(["ice", "snow"], "k", 2.0);
    let expected = "law 'bond': parameter 'k' is given for the material 'ice'; the scene has none";
    assert_eq!(refused(&scene, options(Backend::Cpu).contact_force_law(named)), expected);
    let worlds = Worlds::new([scene.clone()], options(Backend::Cpu).contact_force_law(law())).map(drop);
    let expected = "law 'bond': Worlds do not take contact laws of the program, expected a Simulation for each scene";
    assert_eq!(worlds.expect_err("refused").to_string(), expected);

    let mut plain = Simulation::with_options(scene_with(ContactLaw::Thesis), options(Backend::Cpu)).expect("it opens");
    let error = plain.set_contact_law_parameter("k", 1.0).expect_err("no law").to_string();
    assert!(error.contains("the simulation has no contact law of the program"), "{error}");
    let user = plain.settings().with(|settings| settings.contact_law = ContactLaw::User);
    assert!(plain.set_settings(user).expect_err("no law").to_string().contains("contact_law"));
    assert_eq!(plain.settings().contact_law, ContactLaw::Thesis);
    plain.set_contact_force_law(law()).expect("a law");
    assert_eq!(plain.settings().contact_law, ContactLaw::User);
    let error = plain.set_contact_law_parameter("j", 1.0).expect_err("no parameter").to_string();
    assert_eq!(error, "law 'bond': it has no parameter 'j': it has k");
    let error = plain.set_contact_law_pair_parameter(["a", "b"], "k", 1.0).expect_err("no material").to_string();
    assert!(error.contains("the material 'a'"), "{error}");
    assert_eq!(plain.contact_force_law(), Some(&law()));
}

#[cfg(feature = "gpu")]
#[test]
fn gpu_needs_the_text() {
    let law = ContactForceLaw::new("bond").function(|contact| contact.overlap);
    let refused = Simulation::with_options(impact(1.0), options(Backend::Gpu).contact_force_law(law)).map(drop);
    let expected =
        "law 'bond': it has no WGSL, which the GPU needs; give it with ContactForceLaw::wgsl, or use the CPU backend";
    assert_eq!(refused.expect_err("no text").to_string(), expected);
}

both!(result_that_is_not_finite_is_reported);

/// The run ends, and the message names the law and the line of its text.
fn result_that_is_not_finite_is_reported(backend: Backend) {
    let text = "let d = overlap - overlap;\nnormal_force = 1.0 / (d * d);";
    let mut simulation = open(&impact(1.0), backend, ContactForceLaw::new("pole").wgsl(text));
    let error = simulation.run(4, 1e-3).expect_err("not finite").to_string();
    assert!(error.starts_with("law 'pole', line 2: the normal_force of a contact of sphere "), "{error}");
    let endless = ContactForceLaw::new("hang").wgsl("loop {\n    normal_force += 0.0;\n}");
    let mut simulation = open(&impact(1.0), backend, endless);
    let error = simulation.run(4, 1e-3).expect_err("not a number").to_string();
    assert!(error.starts_with("law 'hang': its loops make more than 10000 rounds for a contact of sphere "), "{error}");
}
