//! Checkpoints: everything that decides how a simulation goes on, in memory or in a file.
//!
//! A simulation that is made of a checkpoint takes the same steps, bit for bit, as the one that it was taken of, on the same
//! device. Pair lists and AABBs are not kept, nor is the order of memory: no result depends on them.
//!
//! # The file
//! All numbers are little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `\x89RKF\r\n\x1a\n`, which shows a transfer as text |
//! | 4 | version of the format |
//! | 8 | length of the whole file in bytes |
//! | ... | the head: program, device, note, constants, options, counters, numbers of objects |
//! | ... | spheres, rods, capsules, springs, tethers, boxes, polygons, in order of addition, 32-bit words each |
//! | 4 | CRC-32 of all that comes before |

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};
use crate::options::Options;
use crate::output::AtomicFile;
use crate::report::Report;
use crate::scene::Scene;

mod head;
mod objects;
mod words;

use words::{Damage, Words};

/// The first bytes of every checkpoint.
const MAGIC: [u8; 8] = *b"\x89RKF\r\n\x1a\n";
/// Version of the format; older ones are still read.
const VERSION: u32 = 1;
/// Magic, version, length.
const PREFIX: usize = MAGIC.len() + 4 + 8;
/// The checksum at the end.
const SUFFIX: usize = 4;

/// The state of a simulation between two steps: [`Simulation::checkpoint`](crate::Simulation::checkpoint) takes it,
/// [`Simulation::resume`](crate::Simulation::resume) goes on from it.
///
/// Handles of the simulation that it was taken of stay valid in one that is made of it. In one that comes from a file,
/// objects have new handles, in the same order ([`Scene::sphere_ids`]).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Checkpoint {
    /// Objects, with the state of every sphere, and constants. What is changed here, the resumed simulation begins with.
    pub scene: Scene,
    /// How the simulation runs. `backend` is the one that it ran on: another one rounds differently.
    pub options: Options,
    /// Time step in s of the last step.
    pub time_step: f32,
    /// What happened up to now.
    pub report: Report,
    /// What the caller wants to find again, whatever it is.
    pub note: String,
    /// The device that the simulation ran on.
    pub device: String,
    /// The version of rockfall that took it; a later one may round differently.
    pub program: String,
    pub(crate) history: History,
}

/// What is left of the steps before, beyond the state of the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct History {
    /// Rod lengths may be off before the next integration: decides bits.
    pub(crate) lengths_due: bool,
    /// How far AABBs are grown, and for how many steps; results do not depend on them.
    pub(crate) margin_scale: f32,
    pub(crate) lookahead: f32,
}

impl Checkpoint {
    /// Writes the checkpoint to a file, which appears complete or not at all, and is on the disk when this returns.
    ///
    /// # Errors
    /// [`Error::File`].
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let write = || {
            let mut file = AtomicFile::create(path)?;
            self.write(&mut file)?;
            file.commit()
        };
        write().map_err(|source| Error::File { file: path.to_owned(), source })
    }

    /// Reads a checkpoint from a file.
    ///
    /// # Errors
    /// [`Error::File`]; [`Error::Checkpoint`] for what is damaged, no checkpoint at all, or of a later version.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let failed = |source| Error::File { file: path.to_owned(), source };
        let file = File::open(path).map_err(failed)?;
        let mut bytes = Vec::new();
        // No folder, device or pipe: those may have no end.
        if !file.metadata().map_err(failed)?.is_file() {
            return Err(Error::Checkpoint { file: path.to_owned(), reason: "it is no regular file".to_owned() });
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

    /// Reads a checkpoint from the bytes of a file; `name` is for messages.
    ///
    /// # Errors
    /// [`Error::Checkpoint`] for what is damaged, no checkpoint at all, or of a later version.
    pub fn from_bytes(bytes: &[u8], name: impl Into<PathBuf>) -> Result<Self> {
        let read = || -> Result<Self, Damage> {
            let mut words = Words::new(content(bytes)?);
            let (mut checkpoint, counts) = head::read(&mut words)?;
            objects::read(&mut words, &counts, &mut checkpoint.scene)?;
            words.end()?;
            Ok(checkpoint)
        };
        read().map_err(|Damage(reason)| Error::Checkpoint { file: name.into(), reason })
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let head = head::bytes(self);
        let length = PREFIX + head.len() + objects::length(&self.scene.counts()) + SUFFIX;
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

/// What lies between prefix and checksum, when all of it is as it was written.
fn content(bytes: &[u8]) -> Result<&[u8], Damage> {
    if bytes.is_empty() {
        return Err(Damage::new("it is empty"));
    }
    if !bytes.starts_with(&MAGIC[..MAGIC.len().min(bytes.len())]) {
        return Err(Damage::new("it does not begin as a checkpoint of rockfall does"));
    }
    let Some((prefix, rest)) = bytes.split_at_checked(PREFIX) else {
        return Err(Damage::new(format!("it is cut off after {} bytes", bytes.len())));
    };
    let mut numbers = Words::new(&prefix[MAGIC.len()..]);
    let (version, length) = (numbers.u32()?, numbers.u64()?);
    if !(1..=VERSION).contains(&version) {
        return Err(Damage::new(format!("it has version {version}, this rockfall reads version {VERSION}")));
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

/// A writer that hashes what goes through it.
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
