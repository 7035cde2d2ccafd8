//! The target `checkpoint_file`: checkpoints with changed bytes, whose lengths and checksums are made right again.

use std::path::Path;
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

/// Number of the files of laws other than `rigid`.
const SOFT: usize = 5;

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
            file(hard(HARD), Options::new()),
            file(hard(HULLS), Options::new()),
        ]
    })
}

/// A stack, a ball that bounces, and a capsule.
const HARD: &str = "B -5 -1 -5 10 0 0 0 1 0 0 0 10\n@body cube mass=1\nB -0.5 -0.5 -0.5 1 0 0 0 1 0 0 0 1\n@end\n\
                    @place cube at=0,0.5,0\n@place cube at=0.1,1.5,0 spin=0,1,0\nS 1 1.5 0.55 0 0 -3 0 0 0 0 1 0.5\n\
                    C -2 0.3 0 -1 0.3 0 0 -1 0 1 0.3\n";
/// Hulls, one of them with a ball, and materials.
const HULLS: &str = "@material ice\n@pair ice ice restitution=0.3 friction=0.1\n@use ice\nP -5 0 -5 0 0 10 10 0 0\n\
                     @body t density=10\n@hull 0,0,0 1,0,0 0,1,0 0,0,1\nS 1 0.2 0.2 0.2 0 0 0 0 0 0 - 0.3\n@end\n\
                     @place t at=0,0.05,0 spin=1,0,0\n@place t at=0.2,1.1,0 axis=1,0,0 turn=30\n";

fn hard(text: &str) -> Scene {
    let text = format!("set contact_law rigid\nset gravity 9.81\n{text}");
    Scene::parse(&text, Path::new("hard.txt")).expect("a scene").scene
}

fn changed_file(source: &mut Unstructured<'_>) -> arbitrary::Result<Vec<u8>> {
    let files = files();
    let (soft, hard) = files.split_at(SOFT);
    let number = u8::arbitrary(source)?;
    let some = if number < 192 { soft } else { hard };
    let file = some[usize::from(number) % some.len()].clone();
    changed(file, source, close)
}
