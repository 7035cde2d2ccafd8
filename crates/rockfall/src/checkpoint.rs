//! Checkpoints: everything that determines how a simulation continues, in memory or in a file.
//!
//! A simulation that is resumed from a checkpoint on the same device takes bitwise identical steps to the original one. Pair
//! lists, AABBs and the order of memory are not stored, because no result depends on them.
//!
//! # The file
//! All numbers are little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `\x89RKF\r\n\x1a\n`; a transfer as text changes these bytes, so it is detected |
//! | 4 | version of the format |
//! | 8 | length of the whole file in bytes |
//! | ... | the head: program, device, note, constants, options, time step, counters, the time of muscles and motions, numbers of objects, materials, pairs, motions, periods; gauges; how the scene is meant to be run; names, parameters and hashes of force laws; the contact law of the program; the springs of contacts; the number of spheres and bodies with an acceleration and a torque, 0 or all, with 6 floats for each; the number of spheres and bodies with residues, 0 or all, with 4 words for each; the number of spheres whose position has a low part, 0 or all, with 3 floats for each; names, colours, looks and labels; inlets and outlets, and what they have done; shapes and rigid bodies; implied bodies; joints; groups; sensors |
//! | ... | spheres, rods, capsules, springs, tethers, boxes, polygons, each in order of addition, as 32-bit words |
//! | ... | the reference of every sphere as a 64-bit number, -1 for none; left out if no sphere has one |
//! | 4 | CRC-32 of all bytes before |

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::Vec3;

use crate::error::{Error, Result};
use crate::model::muscles::MuscleClock;
use crate::model::residue::is_residue;
use crate::options::Options;
use crate::output::AtomicFile;
use crate::report::Report;
use crate::scene::{AnyId, FlowState, Front, Scene};

mod bodies;
mod digest;
mod flow;
mod gauges;
mod groups;
mod head;
mod implied;
mod joints;
mod laws;
mod motions;
mod objects;
mod periods;
mod run;
mod sensors;
mod springs;
mod tags;
pub(crate) mod words;

pub use digest::Digest;
use laws::{KeptContactLaw, KeptLaw};
use words::{Damage, Words};

/// The first bytes of every checkpoint.
const MAGIC: [u8; 8] = *b"\x89RKF\r\n\x1a\n";
/// Version of the format. Files of other versions are refused.
const VERSION: u32 = 27;
/// Bytes of magic, version and length.
pub(crate) const PREFIX: usize = MAGIC.len() + 4 + 8;
/// Bytes of the checksum at the end.
pub(crate) const SUFFIX: usize = 4;

/// The state of a simulation between two steps. [`Simulation::checkpoint`](crate::Simulation::checkpoint) takes it, and
/// [`Simulation::resume`](crate::Simulation::resume) continues from it.
///
/// Handles of the original simulation stay valid in one resumed from the checkpoint in memory. After loading from a file,
/// objects have new handles, in the same order ([`Scene::sphere_ids`]).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Checkpoint {
    /// The objects, with the state of every sphere, and the constants. The resumed simulation starts with any changes made
    /// here.
    pub scene: Scene,
    /// The options of the simulation. `backend` is the one that it ran on, because another one rounds differently.
    pub options: Options,
    /// Time step of the last step, in s.
    pub time_step: f32,
    /// The report on all steps so far.
    pub report: Report,
    /// Arbitrary text of the caller.
    pub note: String,
    /// The device that the simulation ran on.
    pub device: String,
    /// The version of rockfall that took the checkpoint. A later version may round differently.
    pub program: String,
    pub(crate) history: History,
    /// What inlets and outlets have done.
    pub(crate) flow: FlowState,
    /// The tangential springs of contacts, for laws with history.
    pub(crate) springs: Vec<KeptSpring>,
    /// For every gauge, what was in front of its plane at the start, changed by edits since.
    pub(crate) fronts: Vec<Front>,
    /// The force laws, for a checkpoint from a file.
    pub(crate) kept_laws: Vec<KeptLaw>,
    /// The contact law of the program, for a checkpoint from a file.
    pub(crate) kept_contact_law: Option<KeptContactLaw>,
    /// Velocity Verlet: acceleration and torque of every sphere in the last force evaluation. Empty for other integrators, and where
    /// the next step evaluates the forces again. It does so if another number of spheres is found here.
    pub(crate) rates: Vec<[f32; 6]>,
    /// Residues of velocities (docs/physics section 5.10) of all spheres in insertion order, then of all rigid bodies. Empty where
    /// steps are not short.
    pub(crate) residues: Vec<[u32; 4]>,
    /// What the law `rigid` keeps of its bodies and contacts.
    pub(crate) frames: Vec<u32>,
}

/// The tangential spring of a contact between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KeptSpring {
    /// The object that was added first, and the other one.
    pub(crate) a: AnyId,
    pub(crate) b: AnyId,
    pub(crate) feature: u32,
    pub(crate) shift: Vec3,
    pub(crate) overlap: f32,
    pub(crate) moment: Vec3,
}

/// The effects of earlier steps beyond the state of the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct History {
    /// Whether rod lengths may be wrong before the next integration. This changes results.
    pub(crate) lengths_due: bool,
    /// How far AABBs are grown, in units of 0.02 r. Results do not depend on it.
    pub(crate) margin_scale: f32,
    /// For how many steps AABBs are grown. Results do not depend on it.
    pub(crate) lookahead: f32,
    /// The time of the muscles.
    pub(crate) clock: MuscleClock,
}

impl Checkpoint {
    /// Writes the checkpoint to a file. The file appears complete or not at all, and is on the disk when this returns. An earlier file
    /// stays until the new one has been read back.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be written or read back.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let file = AtomicFile::create(path).map_err(|source| Error::File { file: path.to_owned(), source })?;
        self.save_to(file)
    }

    /// Like [`Checkpoint::save`], to a file that has been opened.
    ///
    /// # Errors
    /// As for [`Checkpoint::save`].
    pub fn save_to(&self, mut file: AtomicFile) -> Result<()> {
        let path = file.path().to_owned();
        let saved = self.write(&mut file).and_then(|()| read_back(&mut file)).and_then(|()| file.commit());
        saved.map_err(|source| Error::File { file: path, source })
    }

    /// Reads a checkpoint from a file.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be read, [`Error::Checkpoint`] when it is damaged, not a checkpoint, or of another
    /// version of the format.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let failed = |source| Error::File { file: path.to_owned(), source };
        let file = File::open(path).map_err(failed)?;
        let mut bytes = Vec::new();
        // Folders, devices and pipes are refused, because they may have no end.
        if !file.metadata().map_err(failed)?.is_file() {
            return Err(Error::Checkpoint { file: path.to_owned(), reason: "it is not a regular file".to_owned() });
        }
        io::Read::read_to_end(&mut &file, &mut bytes).map_err(failed)?;
        Self::from_bytes(&bytes, path)
    }

    /// The checkpoint as the bytes of a file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        // Writing to memory cannot fail.
        let _ = self.write(&mut bytes);
        bytes
    }

    /// Reads a checkpoint from the bytes of a file. `name` names the source in messages.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] when the bytes are damaged, not a checkpoint, or of another version of the format.
    pub fn from_bytes(bytes: &[u8], name: impl Into<PathBuf>) -> Result<Self> {
        let read = || -> Result<Self, Damage> {
            let mut words = Words::new(content(bytes, &MAGIC, VERSION)?);
            let (mut checkpoint, counts) = head::read(&mut words)?;
            let springs = springs::read(&mut words)?;
            checkpoint.rates = read_rates(&mut words)?;
            checkpoint.residues = read_residues(&mut words)?;
            checkpoint.frames = read_frames(&mut words)?;
            let lows = read_lows(&mut words, counts.spheres)?;
            let [tags, flow, bodies, implied] = [words.block()?, words.block()?, words.block()?, words.block()?];
            let [joints, groups, sensors] = [words.block()?, words.block()?, words.block()?];
            objects::read(&mut words, &counts, &mut checkpoint.scene)?;
            put_lows(&mut checkpoint.scene, &lows);
            bodies::put(bodies, &mut checkpoint.scene)?;
            implied::put(implied, &mut checkpoint.scene)?;
            joints::put(joints, &mut checkpoint.scene)?;
            groups::put(groups, &mut checkpoint.scene)?;
            sensors::put(sensors, &mut checkpoint.scene)?;
            check_rates(&checkpoint)?;
            checkpoint.flow = flow::put(flow, &mut checkpoint.scene)?;
            tags::put(tags, &mut checkpoint.scene)?;
            checkpoint.springs = springs::named(&springs, &checkpoint.scene)?;
            words.end()?;
            Ok(checkpoint)
        };
        read().map_err(|Damage(reason)| Error::Checkpoint { file: name.into(), reason })
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let mut head = head::bytes(self);
        head.extend(springs::bytes(self));
        head.extend(rates(&self.rates));
        head.extend(residues(&self.residues));
        head.extend(frames(&self.frames));
        head.extend(lows(&self.scene));
        head.extend(tags::bytes(&self.scene));
        head.extend(flow::bytes(self));
        head.extend(bodies::bytes(&self.scene));
        head.extend(implied::bytes(&self.scene));
        head.extend(joints::bytes(&self.scene));
        head.extend(groups::bytes(&self.scene));
        head.extend(sensors::bytes(&self.scene));
        let length = PREFIX + head.len() + objects::length(&self.scene) + SUFFIX;
        let mut out = Hashed { out, crc32: crc32fast::Hasher::new() };
        out.write_all(&MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(length as u64).to_le_bytes())?;
        out.write_all(&head)?;
        objects::write(&self.scene, &mut out)?;
        let crc32 = out.crc32.finalize();
        out.out.write_all(&crc32.to_le_bytes())
    }
}

/// Checks that a file that was written can be read. A device cannot.
fn read_back(file: &mut AtomicFile) -> io::Result<()> {
    let mut bytes = Vec::new();
    match file.reader() {
        Err(error) if error.kind() == io::ErrorKind::Unsupported => return Ok(()),
        reader => io::Read::read_to_end(reader?, &mut bytes)?,
    };
    match Checkpoint::from_bytes(&bytes, file.path()) {
        Err(Error::Checkpoint { reason, .. }) => Err(io::Error::other(format!("it could not be read back: {reason}"))),
        _ => Ok(()),
    }
}

/// The rates of velocity Verlet: the number of spheres that have them, then 6 numbers each.
fn rates(rates: &[[f32; 6]]) -> Vec<u8> {
    let mut head = words::Head::default();
    head.u64(rates.len() as u64);
    rates.iter().flatten().for_each(|number| head.f32(*number));
    head.bytes
}

fn read_rates(words: &mut Words) -> Result<Vec<[f32; 6]>, Damage> {
    let mut rates = Vec::new();
    for _ in 0..words.u64()? {
        let mut one = [0.0; 6];
        for number in &mut one {
            *number = words.f32()?;
        }
        if one.iter().any(|number| !number.is_finite()) {
            return Err(Damage::new("the acceleration of a sphere is not finite"));
        }
        rates.push(one);
    }
    Ok(rates)
}

/// Checks that there are rates and residues of all spheres and bodies, or none.
fn check_rates(Checkpoint { rates, residues, scene, .. }: &Checkpoint) -> Result<(), Damage> {
    let expected = scene.spheres().len() + scene.whole_bodies().count();
    for (what, count) in [("accelerations", rates.len()), ("residues", residues.len())] {
        if count != 0 && count != expected {
            return Err(Damage::new(format!("it has the {what} of {count} spheres and bodies, expected 0 or {expected}")));
        }
    }
    Ok(())
}

/// The residues of velocities: the number of spheres and bodies that have them, then 4 words each.
fn residues(residues: &[[u32; 4]]) -> Vec<u8> {
    let mut head = words::Head::default();
    head.u64(residues.len() as u64);
    residues.iter().flatten().for_each(|word| head.u32(*word));
    head.bytes
}

fn read_residues(words: &mut Words) -> Result<Vec<[u32; 4]>, Damage> {
    let mut residues = Vec::new();
    for _ in 0..words.u64()? {
        let mut row = [0; 4];
        for word in &mut row {
            *word = words.u32()?;
        }
        if !row.into_iter().all(is_residue) {
            return Err(Damage::new("the residue of a velocity is not a number"));
        }
        residues.push(row);
    }
    Ok(residues)
}

/// What the law `rigid` keeps: the number of words, then the words.
fn frames(frames: &[u32]) -> Vec<u8> {
    let mut head = words::Head::default();
    head.u64(frames.len() as u64);
    frames.iter().for_each(|word| head.u32(*word));
    head.bytes
}

fn read_frames(words: &mut Words) -> Result<Vec<u32>, Damage> {
    let mut frames = Vec::new();
    for _ in 0..words.u64()? {
        frames.push(words.u32()?);
    }
    Ok(frames)
}

/// The low parts of positions: the number of spheres that have them, which is 0 where all of them are 0, then 3 numbers each.
fn lows(scene: &Scene) -> Vec<u8> {
    let mut head = words::Head::default();
    let has_lows = scene.spheres().iter().any(|sphere| sphere.position_low != Vec3::ZERO);
    let spheres = if has_lows { scene.spheres() } else { &[] };
    head.u64(spheres.len() as u64);
    spheres.iter().flat_map(|sphere| sphere.position_low.to_array()).for_each(|number| head.f32(number));
    head.bytes
}

fn read_lows(words: &mut Words, spheres: usize) -> Result<Vec<Vec3>, Damage> {
    let count = words.u64()?;
    if count != 0 && count != spheres as u64 {
        return Err(Damage::new(format!("it has the low parts of {count} positions, expected 0 or {spheres}")));
    }
    let mut lows = Vec::new();
    for _ in 0..count {
        let low = words.vec3()?;
        if !low.is_finite() {
            return Err(Damage::new("the low part of a position is not finite"));
        }
        lows.push(low);
    }
    Ok(lows)
}

fn put_lows(scene: &mut Scene, lows: &[Vec3]) {
    for (index, low) in lows.iter().enumerate() {
        let id = scene.spheres.handle_at(index);
        if let Ok(sphere) = scene.spheres.get_mut(id) {
            sphere.position_low = *low;
        }
    }
}

/// Returns the bytes between prefix and checksum, if the file begins with `magic`, has the `expected` version and is intact.
pub(crate) fn content<'a>(bytes: &'a [u8], magic: &[u8; 8], expected: u32) -> Result<&'a [u8], Damage> {
    if bytes.is_empty() {
        return Err(Damage::new("it is empty"));
    }
    if !bytes.starts_with(&magic[..magic.len().min(bytes.len())]) {
        return Err(Damage::new("it does not begin as a checkpoint of rockfall does"));
    }
    let Some((prefix, rest)) = bytes.split_at_checked(PREFIX) else {
        return Err(Damage::new(format!("it is cut off after {} bytes", bytes.len())));
    };
    let mut numbers = Words::new(&prefix[magic.len()..]);
    let (version, length) = (numbers.u32()?, numbers.u64()?);
    if version != expected {
        return Err(Damage::new(format!("it has version {version} of the format, this rockfall reads version {expected}")));
    }
    if length != bytes.len() as u64 {
        return Err(Damage::new(format!("it has {} bytes, expected {length}", bytes.len())));
    }
    let Some(end) = rest.len().checked_sub(SUFFIX) else {
        return Err(Damage::new(format!("it is cut off after {} bytes", bytes.len())));
    };
    let (content, suffix) = rest.split_at(end);
    if Words::new(suffix).u32()? != crc32fast::hash(&bytes[..PREFIX + end]) {
        return Err(Damage::new("its checksum is wrong: some of its bytes have changed"));
    }
    Ok(content)
}

/// A writer that hashes all bytes that pass through it.
struct Hashed<'a, W> {
    out: &'a mut W,
    crc32: crc32fast::Hasher,
}

impl<W: Write> Write for Hashed<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.crc32.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
