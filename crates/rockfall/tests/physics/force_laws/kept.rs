//! Checkpoints of simulations with laws.

use rockfall::Checkpoint;

use super::*;

fn scene() -> Scene {
    let mut scene = weightless();
    spheres(&mut scene, [Sphere::new([1.0, 0.0, 0.0], 0.1).velocity([0.0, 1.0, 0.0]), Sphere::new([-1.0, 0.0, 0.5], 0.3)]);
    scene
}

fn from_file(simulation: &mut Simulation) -> Checkpoint {
    let bytes = simulation.checkpoint().expect("a checkpoint").to_bytes();
    Checkpoint::from_bytes(&bytes, "file.ckpt").expect("a checkpoint")
}

fn message<T: std::fmt::Debug>(result: rockfall::Result<T>) -> String {
    result.expect_err("a wrong law").to_string()
}

both!(resumed_run_with_laws_is_identical);

fn resumed_run_with_laws_is_identical(backend: Backend) {
    let mut whole = with_laws(scene(), backend, [trap(), drag()]);
    whole.run(5, DT).expect("steps");
    whole.set_force_law_parameter("trap", "k", 7.0).expect("a parameter");
    let mut checkpoint = from_file(&mut whole);
    let in_memory = whole.checkpoint().expect("a checkpoint");
    whole.run(6, DT).expect("steps");
    let expected = whole.spheres().expect("the state");
    // In another order: they act in that of the checkpoint.
    checkpoint.give_force_law(drag()).expect("a law");
    checkpoint.give_force_law(trap()).expect("a law");
    for checkpoint in [checkpoint, in_memory.clone()] {
        let mut resumed = Simulation::resume(checkpoint).expect("it resumes");
        assert_eq!(resumed.force_laws()[0].parameters()[0], ("k".to_owned(), 7.0));
        resumed.run(6, DT).expect("steps");
        assert_eq!(resumed.spheres().expect("the state"), expected);
    }
    whole.set_force_law_parameter("trap", "k", 1.0).expect("a parameter");
    whole.restore(&in_memory).expect("it is restored");
    whole.run(6, DT).expect("steps");
    assert_eq!(whole.spheres().expect("the state"), expected);
}

#[test]
fn checkpoint_without_its_laws_is_refused() {
    let mut simulation = with_laws(scene(), Backend::Cpu, [trap(), drag()]);
    let mut checkpoint = from_file(&mut simulation);
    let expected = "law 'trap': the simulation of the checkpoint had this force law, which is part of the program that ran it; \
                    give it with Checkpoint::give_force_law, in Python with force_laws=[...]";
    assert_eq!(message(Simulation::resume(checkpoint.clone())), expected);
    assert_eq!(message(checkpoint.give_force_law(magnet())), "law 'magnet': the checkpoint lacks trap, drag");
    // A checkpoint that was read and written again still needs its laws.
    checkpoint.give_force_law(drag()).expect("a law");
    let again = Checkpoint::from_bytes(&checkpoint.to_bytes(), "again.ckpt").expect("a checkpoint");
    assert_eq!(message(Simulation::resume(again)), expected);
    assert_eq!(message(Simulation::resume(checkpoint.clone())), expected);
    checkpoint.give_force_law(trap()).expect("a law");
    assert_eq!(message(checkpoint.give_force_law(trap())), "law 'trap': the checkpoint lacks no force law");
    Simulation::resume(checkpoint).expect("it resumes");
}

#[test]
fn law_with_another_text_is_refused() {
    let mut simulation = with_laws(scene(), Backend::Cpu, [drag()]);
    let mut checkpoint = from_file(&mut simulation);
    let other = ForceLaw::new("drag").parameter("c", 0.75).wgsl("force = -2.0 * c * velocity;");
    let expected = "law 'drag': its WGSL is not that of the law in the checkpoint";
    assert_eq!(message(checkpoint.give_force_law(other.clone())), expected);
    let renamed = ForceLaw::new("drag").parameter("d", 0.75).wgsl("force = -c * velocity;");
    let expected_names = "law 'drag': its parameters are 'd', those of the law in the checkpoint 'c'";
    assert_eq!(message(checkpoint.give_force_law(renamed)), expected_names);
    let mut with_other = with_laws(scene(), Backend::Cpu, [other]);
    assert_eq!(message(with_other.restore(&checkpoint)), expected);
    let mut without = with_laws(scene(), Backend::Cpu, []);
    assert!(message(without.restore(&checkpoint)).contains("'drag': the simulation of the checkpoint had this force law"));
    let bare = from_file(&mut without);
    assert!(
        message(simulation.restore(&bare)).contains("'drag': the simulation of the checkpoint did not have this force law")
    );
}
