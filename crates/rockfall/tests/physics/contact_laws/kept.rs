//! Checkpoints of simulations with a contact law of the program.

use rockfall::Checkpoint;

use super::*;

const DT: f32 = 5e-4;

fn law() -> ContactForceLaw {
    hertz().pair_parameter(["soft", "soft"], "g", 0.2)
}

fn from_file(simulation: &mut Simulation) -> Checkpoint {
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    Checkpoint::from_bytes(&bytes, "file.ckpt").expect("a checkpoint")
}

both!(resumed_run_is_identical);

fn resumed_run_is_identical(backend: Backend) {
    let given = || crate::common::on(backend, law(), without_function(&law()));
    for integrator in [Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let options = options(backend).integrator(integrator).contact_force_law(law());
        let mut whole = Simulation::with_options(tumble(ContactLaw::User, 1.0), options).expect("the simulation opens");
        whole.run(40, DT).expect("steps");
        whole.set_contact_law_pair_parameter(["soft", "soft"], "g", 0.5).expect("a parameter");
        whole.run(20, DT).expect("steps");
        let mut checkpoint = from_file(&mut whole);
        let in_memory = whole.checkpoint().expect("a checkpoint");
        whole.run(40, DT).expect("steps");
        let expected = bits_of(&mut whole);
        checkpoint.give_contact_force_law(given()).expect("the law");
        for checkpoint in [checkpoint, in_memory.clone()] {
            let mut resumed = Simulation::resume(checkpoint).expect("it resumes");
            assert_eq!(resumed.contact_force_law().expect("a law").pair_parameters()[0].value, 0.5);
            resumed.run(40, DT).expect("steps");
            assert!(bits_of(&mut resumed) == expected, "{integrator}");
        }
        whole.set_contact_law_pair_parameter(["soft", "soft"], "g", 0.1).expect("a parameter");
        whole.restore(&in_memory).expect("it is restored");
        whole.run(40, DT).expect("steps");
        assert!(bits_of(&mut whole) == expected, "{integrator}, restored");
    }
}

/// A law that is not used any more is part of the checkpoint, but does not come into use again.
#[test]
fn resumed_run_with_another_law_keeps_that() {
    let mut simulation = open(&tumble(ContactLaw::User, 1.0), Backend::Cpu, law());
    let other = simulation.settings().with(|settings| settings.contact_law = ContactLaw::Linear);
    simulation.set_settings(other).expect("a complete law");
    simulation.run(3, DT).expect("steps");
    let mut checkpoint = from_file(&mut simulation);
    checkpoint.give_contact_force_law(law()).expect("the law");
    let mut resumed = Simulation::resume(checkpoint).expect("it resumes");
    assert_eq!(resumed.settings().contact_law, ContactLaw::Linear);
    for simulation in [&mut simulation, &mut resumed] {
        simulation.run(20, DT).expect("steps");
    }
    assert!(bits_of(&mut simulation) == bits_of(&mut resumed));
}

#[test]
fn checkpoint_without_its_law_or_with_another_is_refused() {
    let message = |result: rockfall::Result<()>| result.expect_err("a wrong law").to_string();
    let mut simulation = open(&tumble(ContactLaw::User, 1.0), Backend::Cpu, law());
    let mut checkpoint = from_file(&mut simulation);
    let missing = "law 'hertz': the simulation of the checkpoint had this contact law, which is part of the program that ran it; \
                   give it with Checkpoint::give_contact_force_law, in Python with contact_law=...";
    assert_eq!(message(Simulation::resume(checkpoint.clone()).map(drop)), missing);
    // A checkpoint that was read and written again still needs its law.
    let again = Checkpoint::from_bytes(&checkpoint.to_bytes(), "again.ckpt").expect("a checkpoint");
    assert_eq!(message(Simulation::resume(again).map(drop)), missing);
    let text = hertz().wgsl_text().expect("a text").to_owned();
    for (law, expected) in [
        (linear(), "law 'linear spring': the simulation of the checkpoint had the contact law 'hertz'"),
        (hertz().wgsl("normal_force = g;"), "law 'hertz': its WGSL is not that of the law in the checkpoint"),
        (
            ContactForceLaw::new("hertz").parameter("h", 0.0).wgsl(text),
            "law 'hertz': its parameters are 'h', those of the law in the checkpoint 'g'",
        ),
    ] {
        assert_eq!(message(checkpoint.give_contact_force_law(law)), expected);
    }
    let mut plain = Simulation::with_options(tumble(ContactLaw::Linear, 1.0), options(Backend::Cpu)).expect("it opens");
    let expected = "law 'hertz': the simulation of the checkpoint had this contact law; set it first";
    assert_eq!(message(plain.restore(&checkpoint)), expected);
    let mut before = from_file(&mut plain);
    assert_eq!(message(before.give_contact_force_law(law())), "law 'hertz': the checkpoint lacks no contact law");
    let expected = "law 'hertz': the simulation of the checkpoint did not have this contact law";
    assert_eq!(message(simulation.restore(&before)), expected);
    checkpoint.give_contact_force_law(law()).expect("the law");
    Simulation::resume(checkpoint).expect("it resumes");
}
