//! Files from which worlds continue.
//!
//! # The file
//! All numbers are little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `\x89RKW\r\n\x1a\n`; a transfer as text changes these bytes, so it is detected |
//! | 4 | version of the format |
//! | 8 | length of the whole file in bytes |
//! | ... | a checkpoint without objects, which has the options of all worlds, as a length of 8 bytes and the bytes of its file |
//! | 4 | time step in s |
//! | 4 4 4 | [`Sleep`]: speed, steps, and 1 if sleeping worlds stand still, else 0 |
//! | 8 | number of worlds |
//! | ... | per world: the checkpoint of its start and that of its present state; 4 bytes that are 1 if it is stopped, else 0; the reason; 4 bytes with the number of steps without motion |
//! | 4 | CRC-32 of all bytes before |

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use crate::checkpoint::words::{Damage, Head, Words};
use crate::checkpoint::{Checkpoint, PREFIX, SUFFIX, content};
use crate::error::{Error, Result};
use crate::options::{Backend, Options};
use crate::output::AtomicFile;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::worlds::{Sleep, Worlds};

/// The first bytes of every file.
const MAGIC: [u8; 8] = *b"\x89RKW\r\n\x1a\n";
/// Version of the format. Files of other versions are refused.
const VERSION: u32 = 3;

/// A world in a file: the checkpoints of its start and of its present state, why it is stopped, and its steps without motion.
type Stored = (Checkpoint, Checkpoint, Option<String>, u32);

impl Worlds {
    /// Writes everything that determines the following steps, and the starts of all worlds, to a file. The file appears complete or
    /// not at all.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be written, [`Error::Device`] when the GPU fails.
    pub fn save_checkpoint(&mut self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let bytes = self.to_bytes()?;
        let write = || {
            let mut file = AtomicFile::create(path)?;
            file.write_all(&bytes)?;
            file.commit()
        };
        write().map_err(|source| Error::File { file: path.to_owned(), source })
    }

    /// Continues from a file that [`Worlds::save_checkpoint`] wrote. On the same device, the following steps are bitwise
    /// identical to those of a run without interruption. `backend` replaces the backend of the file, and results then differ by
    /// rounding. `None` keeps it.
    ///
    /// # Errors
    /// [`Error::File`] when the file cannot be read, [`Error::Checkpoint`] when it is damaged, not a checkpoint of worlds, or of
    /// another version of the format. Otherwise as for [`Worlds::new`].
    pub fn resume(path: impl AsRef<Path>, backend: Option<Backend>) -> Result<Self> {
        let path = path.as_ref();
        let failed = |source| Error::File { file: path.to_owned(), source };
        // Folders, devices and pipes are refused, because they may have no end.
        if !fs::metadata(path).map_err(failed)?.is_file() {
            return Err(Error::Checkpoint { file: path.to_owned(), reason: "it is not a regular file".to_owned() });
        }
        Self::from_bytes(&fs::read(path).map_err(failed)?, path, backend)
    }

    /// The bytes of the file that [`Worlds::save_checkpoint`] writes.
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU fails.
    pub fn to_bytes(&mut self) -> Result<Vec<u8>> {
        self.refresh()?;
        let mut empty = Simulation::with_options(Scene::new(), Options::new().backend(Backend::Cpu))?.checkpoint()?;
        empty.options = self.options.clone();
        let mut head = Head::default();
        head.bytes.extend(MAGIC);
        head.u32(VERSION);
        // The length, which is not known yet.
        head.u64(0);
        put(&mut head, &empty.to_bytes());
        head.f32(self.dt);
        head.f32(self.sleep.speed);
        head.u32(self.sleep.steps);
        head.u32(u32::from(self.sleep.skip));
        head.u64(self.len() as u64);
        for world in &mut self.worlds {
            put(&mut head, &world.start.to_bytes());
            let mut now = world.simulation.checkpoint()?;
            // How far lists have grown does not change results, and is not restored.
            now.options.pair_capacity = self.options.pair_capacity;
            put(&mut head, &now.to_bytes());
            head.u32(u32::from(world.stopped.is_some()));
            head.text(world.stopped.as_deref().unwrap_or_default());
            head.u32(world.calm);
        }
        let length = (head.bytes.len() + SUFFIX) as u64;
        head.bytes[PREFIX - size_of::<u64>()..PREFIX].copy_from_slice(&length.to_le_bytes());
        head.u32(crc32fast::hash(&head.bytes));
        Ok(head.bytes)
    }

    /// Continues from the bytes of a file, as [`Worlds::resume`] does. Errors call it `name`.
    ///
    /// # Errors
    /// As for [`Worlds::resume`], except for reading the file.
    pub fn from_bytes(bytes: &[u8], name: impl AsRef<Path>, backend: Option<Backend>) -> Result<Self> {
        let (options, dt, sleep, stored) = read(bytes, name.as_ref())?;
        let options = Options { backend: backend.unwrap_or(options.backend), ..options };
        let mut worlds = Self::new(stored.iter().map(|(start, ..)| start.scene.clone()), options)?;
        (worlds.dt, worlds.sleep) = (dt, sleep);
        for (world, (start, now, stopped, calm)) in worlds.worlds.iter_mut().zip(stored) {
            world.simulation.restore(&now)?;
            (world.start, world.stopped, world.calm) = (start, stopped, calm);
        }
        Ok(worlds)
    }
}

fn put(head: &mut Head, checkpoint: &[u8]) {
    head.u64(checkpoint.len() as u64);
    head.bytes.extend(checkpoint);
}

/// The bytes of a checkpoint.
fn take<'a>(words: &mut Words<'a>) -> Result<&'a [u8], Damage> {
    let length = usize::try_from(words.u64()?).map_err(|_| Damage::new("a checkpoint is too long"))?;
    words.take(length)
}

/// The options of all worlds, their time step, when they sleep, and the worlds.
fn read(bytes: &[u8], name: &Path) -> Result<(Options, f32, Sleep, Vec<Stored>)> {
    let damaged = |Damage(reason)| Error::Checkpoint { file: name.to_owned(), reason };
    let parts = || -> Result<_, Damage> {
        let mut words = Words::new(content(bytes, &MAGIC, VERSION)?);
        let empty = take(&mut words)?;
        let dt = words.f32()?;
        if !(dt.is_finite() && dt > 0.0) {
            return Err(Damage::new("the time step is not positive and finite"));
        }
        let sleep = Sleep { speed: words.f32()?, steps: words.u32()?, skip: words.bool()? };
        sleep.validate()?;
        let count = words.u64()?;
        let mut worlds = Vec::new();
        for _ in 0..count {
            let (start, now) = (take(&mut words)?, take(&mut words)?);
            let (is_stopped, reason) = (words.bool()?, words.text()?);
            let calm = words.u32()?;
            worlds.push((start, now, is_stopped.then_some(reason), calm));
        }
        words.end()?;
        Ok((empty, dt, sleep, worlds))
    };
    let (empty, dt, sleep, worlds) = parts().map_err(damaged)?;
    let part = |bytes: &[u8]| Checkpoint::from_bytes(bytes, PathBuf::from(name));
    let stored = worlds.into_par_iter().map(|(start, now, stopped, calm)| Ok((part(start)?, part(now)?, stopped, calm)));
    Ok((part(empty)?.options, dt, sleep, stored.collect::<Result<_>>()?))
}
