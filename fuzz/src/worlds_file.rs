//! The target `worlds_file`: files of worlds with changed bytes, whose lengths and checksums are made right again.

use std::sync::OnceLock;

use arbitrary::{Arbitrary, Unstructured};
use rockfall::generate::{Kind, creature};
use rockfall::{Backend, Error, Integrator, Options, Scene, Sleep, Worlds};

/// Upper bound of the length of an error message, in bytes.
const LONGEST_MESSAGE: usize = 600;
/// Bytes before the content of a file: the magic number, the version and the length.
const PREFIX: usize = 20;
/// Most changes of a file.
const CHANGES: usize = 32;

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
        Err(error) => return is_short(&error),
    };
    goes_on(&mut worlds);
    let written = worlds.to_bytes().expect("the CPU backend does not fail");
    let again = Worlds::from_bytes(&written, "again.ckpt", Some(Backend::Cpu));
    let mut again = again.unwrap_or_else(|error| panic!("the written file cannot be read: {error}"));
    assert!(again.to_bytes().expect("the CPU backend does not fail") == written, "the bytes differ");
    // The counts of list builds may differ.
    assert_eq!(goes_on(&mut worlds), goes_on(&mut again), "they go on differently");
}

fn is_short(error: &Error) {
    let message = error.to_string();
    assert!(message.len() < LONGEST_MESSAGE, "{} bytes: {message}", message.len());
    assert!(!message.contains(char::is_control), "{message:?}");
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
    if !worlds.is_empty() {
        worlds.reset(&[0]).expect("the world exists");
    }
    seen
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
        ]
    })
}

fn changed_file(source: &mut Unstructured<'_>) -> arbitrary::Result<Vec<u8>> {
    let files = files();
    let mut file = files[usize::from(u8::arbitrary(source)?) % files.len()].clone();
    for _ in 0..CHANGES {
        if source.is_empty() || file.is_empty() {
            break;
        }
        let (kind, at, value) = (u8::arbitrary(source)?, u32::arbitrary(source)? as usize, u32::arbitrary(source)?);
        let place = at % file.len();
        let end = (place + 4).min(file.len());
        match kind % 6 {
            0 => file[place] ^= value as u8,
            1 => file[place..end].copy_from_slice(&value.to_le_bytes()[..end - place]),
            2 => file[place / 4 * 4..end].fill(0),
            3 => drop(file.drain(place..(place + value as usize % 64).min(file.len()))),
            4 => drop(file.splice(place..place, value.to_le_bytes())),
            _ => file.truncate(place),
        }
    }
    // The last bit decides whether a reader sees the changes or wrong checksums.
    if source.is_empty() || bool::arbitrary(source)? {
        repair(&mut file);
    }
    Ok(file)
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

/// Writes the length and the checksum of a file into it.
fn close(file: &mut [u8]) {
    let length = file.len();
    if length < PREFIX + 4 {
        return;
    }
    file[PREFIX - 8..PREFIX].copy_from_slice(&(length as u64).to_le_bytes());
    let (content, sum) = file.split_at_mut(length - 4);
    sum.copy_from_slice(&crc32(content).to_le_bytes());
}

/// The CRC-32 of zip files, bit by bit: files are short.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & 0_u32.wrapping_sub(crc & 1)))
    };
    !bytes.iter().fold(!0, step)
}
