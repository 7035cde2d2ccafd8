//! The target `checkpoint_file`: checkpoints with changed bytes, whose lengths and checksums are made right again.

use std::sync::OnceLock;

use arbitrary::{Arbitrary, Unstructured};
use rockfall::generate::Kind;
use rockfall::{Backend, Checkpoint, ContactForceLaw, ForceLaw, Integrator, Options, Result, Scene, Simulation};

use super::damage::{changed, close};
use super::message::assert_short;
use super::worlds_file::{HERTZ, LINEAR, grains};

/// Changes a checkpoint, and reads it. A refused one gets a short error. An accepted one is written again with the same bytes, and a
/// simulation continues from it, or a short error says why not.
///
/// # Panics
/// When one of these promises is broken.
pub fn checkpoint_file(bytes: &[u8]) {
    let mut source = Unstructured::new(bytes);
    let Ok(file) = changed_file(&mut source) else { return };
    let read = || Checkpoint::from_bytes(&file, "fuzz.ckpt");
    let checkpoint = match read() {
        Ok(checkpoint) => checkpoint,
        Err(error) => return assert_short(&error),
    };
    let written = checkpoint.to_bytes();
    let again = Checkpoint::from_bytes(&written, "again.ckpt");
    let again = again.unwrap_or_else(|error| panic!("the written checkpoint cannot be read: {error}"));
    assert!(again.to_bytes() == written, "the bytes differ");
    let [one, other] =
        [checkpoint, again].map(|checkpoint| continued(checkpoint).unwrap_or_else(|error| vec![error.to_string()]));
    assert_eq!(one, other, "they go on differently");
}

/// Continues from a checkpoint, and returns the states as text.
fn continued(mut checkpoint: Checkpoint) -> Result<Vec<String>> {
    let refused = |error| {
        assert_short(&error);
        error
    };
    let _ = checkpoint.give_force_law(pull()).map_err(refused);
    let _ = checkpoint.give_contact_force_law(push()).map_err(refused);
    checkpoint.options.backend = Backend::Cpu;
    let mut simulation = Simulation::resume(checkpoint).map_err(refused)?;
    let mut seen = Vec::new();
    for _ in 0..2 {
        let end = simulation.run(2, 0.005).map(|report| report.steps).map_err(refused);
        let states = simulation.spheres()?;
        let are_finite = states.iter().all(|state| state.position.is_finite() && state.velocity.is_finite());
        assert!(are_finite, "{states:?}");
        seen.push(format!("{:?} {states:?} {:?}", end.map_err(|error| error.to_string()), simulation.contacts()));
    }
    Ok(seen)
}

fn pull() -> ForceLaw {
    ForceLaw::new("pull").parameter("k", 2.0).function(|body| -body.parameters[0] * body.position)
}

fn push() -> ContactForceLaw {
    ContactForceLaw::new("push").parameter("k", 1e3).function(|contact| contact.parameters[0] * contact.overlap)
}

/// Checkpoints of different scenes and laws.
fn files() -> &'static [Vec<u8>] {
    static FILES: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| {
        let file = |scene: Scene, options: Options| {
            let mut simulation = Simulation::with_options(scene, options.backend(Backend::Cpu)).expect("a valid scene");
            simulation.run(4, 0.005).expect("steps");
            simulation.checkpoint().expect("the CPU backend does not fail").to_bytes()
        };
        let with = |integrator| Options::new().integrator(integrator);
        let mixed = Kind::Mixed.generate(6, 1).expect("a scene");
        let user = HERTZ.replace("hertz-mindlin", "user").replace(" cohesion=jkr", "");
        vec![
            file(mixed, with(Integrator::Rk4).force_law(pull())),
            file(grains(HERTZ), with(Integrator::VelocityVerlet)),
            file(grains(LINEAR), with(Integrator::SymplecticEuler).force_law(pull())),
            file(grains(&user), with(Integrator::SymplecticEuler).contact_force_law(push())),
            file(Kind::Chain.generate(4, 1).expect("a scene"), with(Integrator::VelocityVerlet)),
        ]
    })
}

fn changed_file(source: &mut Unstructured<'_>) -> arbitrary::Result<Vec<u8>> {
    let files = files();
    let file = files[usize::from(u8::arbitrary(source)?) % files.len()].clone();
    changed(file, source, close)
}
