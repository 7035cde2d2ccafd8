//! The target `worlds_file`: files of worlds with changed bytes, whose lengths and checksums are made right again.

use std::path::Path;
use std::sync::OnceLock;

use arbitrary::{Arbitrary, Unstructured};
use rockfall::generate::{Kind, creature};
use rockfall::{Backend, Integrator, Options, Scene, Sleep, Worlds};

use super::damage::{PREFIX, changed, close};
use super::message::assert_short;

/// Number of files that are chosen by most bytes.
const FIRST: usize = 4;

/// Changes a file of worlds, and reads it. A refused file gets a short error. Worlds from an accepted one advance, and are written and
/// read again with the same bytes.
///
/// # Panics
/// When one of these promises is broken.
pub fn worlds_file(bytes: &[u8]) {
    let mut source = Unstructured::new(bytes);
    let Ok(file) = changed_file(&mut source) else { return };
    let mut worlds = match Worlds::from_bytes(&file, "fuzz.ckpt", Some(Backend::Cpu)) {
        Ok(worlds) => worlds,
        Err(error) => return assert_short(&error),
    };
    goes_on(&mut worlds);
    let written = worlds.to_bytes().expect("the CPU backend does not fail");
    let again = Worlds::from_bytes(&written, "again.ckpt", Some(Backend::Cpu));
    let mut again = again.unwrap_or_else(|error| panic!("the written file cannot be read: {error}"));
    assert!(again.to_bytes().expect("the CPU backend does not fail") == written, "the bytes differ");
    // The counts of list builds may differ.
    assert_eq!(goes_on(&mut worlds), goes_on(&mut again), "they go on differently");
}

/// Advances worlds, and resets the first. Returns what they did as text. A world whose state is not finite is stopped.
fn goes_on(worlds: &mut Worlds) -> Vec<String> {
    let mut seen = Vec::new();
    worlds.run(3, 0.005).expect("errors of worlds are in their reports");
    let states = worlds.all_states().expect("the CPU backend does not fail");
    for (world, states) in states.iter().enumerate() {
        let report = worlds.report(world, None).expect("the world exists");
        let are_finite = states.iter().all(|state| state.position.is_finite() && state.velocity.is_finite());
        assert!(are_finite || report.stopped.is_some(), "world {world} is not finite and goes on: {report:?}");
        assert!(!(report.sleeping && report.stopped.is_some()), "{report:?}");
        let report = (report.report.steps, report.report.contacts, report.sleeping, report.stopped);
        seen.push(format!("{report:?} {states:?}"));
    }
    let sampled = worlds.sample(|sample| sample.all_states()).expect("the CPU backend does not fail");
    assert_eq!(format!("{sampled:?}"), format!("{states:?}"));
    if !worlds.is_empty() {
        worlds.reset(&[0]).expect("the world exists");
    }
    seen
}

/// Constants of two materials with cohesion and resistance to rolling, for the contact law of Hertz and Mindlin.
pub(crate) const HERTZ: &str = "set contact_law hertz-mindlin
@material one density=2 young=1e4 poisson=0.3
@material other young=1e5 poisson=0.2
@pair one other rolling_friction=0.1 rolling_model=c twisting_friction=0.2
@pair one one friction=0.5 surface_energy=3 cohesion=jkr
";
/// Constants for the linear contact law, with double precision.
pub(crate) const LINEAR: &str = "set contact_law linear
set precision double
@material one density=2
@material other
@pair one one stiffness=1e3 restitution=0.5 rolling_friction=0.1
@pair other other stiffness=1e4 friction=0.3
";

/// Grains on a plate.
pub(crate) fn grains(law: &str) -> Scene {
    let objects = "@use one
@name floor
@label a floor
B -5 -1 -5  10 0 0  0 1 0  0 0 10
@name grain
@colour red
@look wood
S 1  0 0.495 0  1 0 0  0 0 0.1  - 0.5
S 1  0.99 0.49 0  0 0 0  0 0 0  - 0.5
@use other
@name -
@label -
S 1  0.5 0.5 0.8  0 -1 0  0 0 0  1 0.5
P -5 0 -4  10 0 0  0 1 9
";
    let loaded = Scene::parse(&format!("{law}{objects}"), Path::new("grains.txt"));
    loaded.unwrap_or_else(|error| panic!("{error}")).scene
}

/// Files of different worlds.
fn files() -> &'static [Vec<u8>] {
    static FILES: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| {
        let file = |scenes: Vec<Scene>, integrator: Integrator, sleep: Sleep| {
            let options = Options::new().backend(Backend::Cpu).integrator(integrator);
            let mut worlds = Worlds::new(scenes, options).expect("valid scenes");
            worlds.set_sleep(sleep).expect("a valid criterion");
            worlds.run(4, 0.005).expect("steps");
            worlds.to_bytes().expect("the CPU backend does not fail")
        };
        let scene = |kind: Kind| kind.generate(6, 1).expect("a scene");
        let small = |spheres| creature(spheres, 1).expect("a creature");
        vec![
            file(vec![small(2)], Integrator::Rk4, Sleep::new()),
            file(vec![scene(Kind::Mixed), small(3)], Integrator::SymplecticEuler, Sleep::new().steps(2).speed(9.0).skip(true)),
            file(vec![scene(Kind::Chain), Scene::new()], Integrator::VelocityVerlet, Sleep::new()),
            file(Vec::new(), Integrator::Rk4, Sleep::new()),
            file(vec![grains(HERTZ), grains(LINEAR)], Integrator::VelocityVerlet, Sleep::new()),
            file(vec![grains(LINEAR)], Integrator::SymplecticEuler, Sleep::new().steps(2).speed(0.5)),
        ]
    })
}

fn changed_file(source: &mut Unstructured<'_>) -> arbitrary::Result<Vec<u8>> {
    let files = files();
    // Files that were added later have the highest bytes.
    let file = match u8::arbitrary(source)? {
        which @ 0..192 => &files[usize::from(which) % FIRST],
        which => &files[FIRST + usize::from(which) % (files.len() - FIRST)],
    };
    changed(file.clone(), source, repair)
}

/// Makes the lengths and checksums of a file and of the checkpoints in it right, as far as its parts can be found.
fn repair(file: &mut [u8]) {
    let _ = repair_parts(file);
    close(file);
}

fn repair_parts(file: &mut [u8]) -> Option<()> {
    let is_old = *file.get(8)? == 1;
    let mut at = repair_part(file, PREFIX)?;
    at += if is_old { 0 } else { 12 };
    let count = number(file, at)?;
    at += 8;
    for _ in 0..count.min(4) {
        at = repair_part(file, at)?;
        at = repair_part(file, at)?;
        let reason = number(file, at + 4)?;
        at = at.checked_add(12 + reason + if is_old { 0 } else { 4 })?;
    }
    Some(())
}

/// Makes the checkpoint behind a length right, and returns where it ends.
fn repair_part(file: &mut [u8], at: usize) -> Option<usize> {
    let (begin, length) = (at + 8, number(file, at)?);
    let end = begin.checked_add(length)?;
    close(file.get_mut(begin..end)?);
    Some(end)
}

fn number(file: &[u8], at: usize) -> Option<usize> {
    let bytes = file.get(at..at.checked_add(8)?)?;
    usize::try_from(u64::from_le_bytes(bytes.try_into().ok()?)).ok().filter(|number| *number <= file.len())
}
