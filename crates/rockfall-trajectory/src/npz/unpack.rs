//! Turns a finished archive into the records of its frames again, so that a run can continue it.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use rockfall::output::{AtomicFile, Mark};
use zip::ZipArchive;

use super::archive::{not_as_before, open_finished};
use super::{Column, HEAD, MOMENTS, STATES, bytes_per_sphere, head, roll};

/// Writes the frames of a finished archive, up to a mark, one after the other to `scratch`.
pub(crate) fn unpack(path: &Path, scratch: &mut AtomicFile, mark: Mark) -> io::Result<()> {
    let mut finished = Finished::open(path)?;
    let (mut written, mut before) = (0, None);
    for frame in 0..finished.frames() {
        if written >= mark.bytes {
            break;
        }
        written += finished.frame(frame, scratch, &mut before)?;
    }
    if written == mark.bytes {
        return Ok(());
    }
    Err(io::Error::new(io::ErrorKind::InvalidData, "it has other frames than were written before"))
}

/// A finished archive.
struct Finished {
    archive: ZipArchive<File>,
    /// Rows of the arrays of states at which the frames begin, and their end.
    offsets: Vec<u64>,
    /// Whether the spheres are the same in all frames.
    is_constant: bool,
}

impl Finished {
    fn open(path: &Path) -> io::Result<Self> {
        let mut archive = open_finished(path)?;
        let is_constant = archive.index_for_name("offsets.npy").is_none();
        let offsets = match is_constant {
            true => {
                let (frames, spheres) = (length(&mut archive, "step")?, length(&mut archive, "radius")?);
                (0..=frames).map(|frame| frame * spheres).collect()
            }
            false => {
                let count = length(&mut archive, "offsets")?;
                let bytes = part(&mut archive, "offsets", 0, 8 * count)?;
                bytes.chunks_exact(8).map(|word| u64::from_le_bytes(std::array::from_fn(|k| word[k]))).collect()
            }
        };
        Ok(Self { archive, offsets, is_constant })
    }

    fn frames(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Writes the record of a frame and returns its length. `before` are the ids of the previous frame.
    fn frame(&mut self, frame: usize, scratch: &mut AtomicFile, before: &mut Option<Vec<u8>>) -> io::Result<u64> {
        let first = self.offsets[frame];
        let spheres = self.offsets[frame + 1].checked_sub(first).ok_or_else(not_as_before)?;
        let [mut step, mut time] = [[0; 8]; 2];
        for ((name, _), number) in MOMENTS.into_iter().zip([&mut step, &mut time]) {
            number.copy_from_slice(&part(&mut self.archive, name, 8 * frame as u64, 8)?);
        }
        let ids = match self.is_constant {
            true => (0..spheres as u32).flat_map(u32::to_le_bytes).collect(),
            false => part(&mut self.archive, roll::ID.name, first * roll::ID.bytes, spheres * roll::ID.bytes)?,
        };
        let has_roll = before.as_ref() != Some(&ids);
        scratch.write_all(&head(step, time, spheres, has_roll))?;
        self.columns(&STATES, first, spheres, scratch)?;
        if has_roll {
            scratch.write_all(&ids)?;
            let first = if self.is_constant { 0 } else { first };
            self.columns(&roll::COLUMNS[1..], first, spheres, scratch)?;
        }
        *before = Some(ids);
        let roll = if has_roll { bytes_per_sphere(&roll::COLUMNS) } else { 0 };
        Ok(HEAD + spheres * (bytes_per_sphere(&STATES) + roll))
    }

    fn columns(&mut self, columns: &[Column], first: u64, spheres: u64, scratch: &mut AtomicFile) -> io::Result<()> {
        columns.iter().try_for_each(|column| {
            scratch.write_all(&part(&mut self.archive, column.name, first * column.bytes, spheres * column.bytes)?)
        })
    }
}

/// Bytes of an array, from `at` on.
fn part(archive: &mut ZipArchive<File>, name: &str, at: u64, bytes: u64) -> io::Result<Vec<u8>> {
    let mut entry = archive.by_name_seek(&format!("{name}.npy")).map_err(|_| not_as_before())?;
    let mut start = [0; 10];
    entry.read_exact(&mut start)?;
    // The length of the rest of the header is at byte 8.
    let header = 10 + u64::from(u16::from_le_bytes([start[8], start[9]]));
    entry.seek(SeekFrom::Start(header + at))?;
    let mut found = Vec::new();
    entry.take(bytes).read_to_end(&mut found)?;
    if found.len() as u64 == bytes { Ok(found) } else { Err(not_as_before()) }
}

/// Length of an array along its first axis.
fn length(archive: &mut ZipArchive<File>, name: &str) -> io::Result<u64> {
    let mut entry = archive.by_name(&format!("{name}.npy")).map_err(|_| not_as_before())?;
    let mut start = [0; 128];
    let length = entry.read(&mut start)?;
    let text = String::from_utf8_lossy(&start[..length]);
    let shape = text.split_once("'shape': (").and_then(|(_, rest)| rest.split_once(','));
    shape.and_then(|(length, _)| length.trim().parse().ok()).ok_or_else(not_as_before)
}
