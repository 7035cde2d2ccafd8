//! Contacts as arrays for NumPy.
//!
//! Frames are written to `.NAME.frames.part` first, as records of equal size: one that begins a frame, then one per contact. When
//! the file is finished, they are rearranged into arrays.

use std::io::{self, BufReader, Read, Write};
use std::path::Path;

use rockfall::output::{AtomicFile, Mark};

use super::{Contacts, Row};
use crate::frame::bytes_of;
use crate::npz::archive::{Archive, not_as_before, open_finished, start_array};

/// An array with one item per contact.
struct Column {
    name: &'static str,
    kind: &'static str,
    /// Size of an item in bytes.
    bytes: usize,
    /// Shape of an item.
    shape: &'static [u64],
}

const fn column(name: &'static str, kind: &'static str, bytes: usize, shape: &'static [u64]) -> Column {
    Column { name, kind, bytes, shape }
}

const COLUMNS: [Column; 16] = [
    column("frame", "<u8", 8, &[]),
    column("a_kind", "|u1", 1, &[]),
    column("b_kind", "|u1", 1, &[]),
    column("a", "<u4", 4, &[]),
    column("b", "<u4", 4, &[]),
    column("a_reference", "<i8", 8, &[]),
    column("b_reference", "<i8", 8, &[]),
    column("point", "<f4", 12, &[3]),
    column("normal", "<f4", 12, &[3]),
    column("overlap", "<f4", 4, &[]),
    column("force", "<f4", 12, &[3]),
    column("impulse", "<f4", 12, &[3]),
    column("normal_force", "<f4", 4, &[]),
    column("tangential_force", "<f4", 12, &[3]),
    column("slip", "|i1", 1, &[]),
    column("displacement", "<f4", 12, &[3]),
];

/// Arrays with one item per frame. The record that begins a frame has them after `frame` and `a_kind`.
const FRAME_ARRAYS: [(&str, &str); 3] = [("step", "<u8"), ("time", "<f8"), ("count", "<u8")];

/// Size of a record in bytes.
const RECORD: usize = 115;
/// Place of `a_kind` in a record, and its value in a record that begins a frame.
const KIND: (usize, u8) = (8, u8::MAX);

/// State of an unfinished file.
#[derive(Debug)]
pub(crate) struct Records {
    /// Number of frames in the scratch file.
    frames: u64,
}

impl Records {
    pub(super) fn new(scratch: &mut AtomicFile, bytes: u64) -> io::Result<Self> {
        let frames = if bytes == 0 { 0 } else { beginnings(scratch)?.len() as u64 };
        Ok(Self { frames })
    }

    pub(super) fn frame(&mut self, scratch: &mut AtomicFile, contacts: &Contacts) -> io::Result<()> {
        let (frame, count) = (self.frames, contacts.rows.len() as u64);
        scratch.write_all(&beginning(frame, contacts.step.to_le_bytes(), contacts.time.to_le_bytes(), count.to_le_bytes()))?;
        self.frames += 1;
        contacts.rows.iter().try_for_each(|row| scratch.write_all(&record(frame, row)))
    }
}

pub(super) fn finish(archive: Archive) -> io::Result<()> {
    archive.finish(|zip, scratch| {
        let frames = beginnings(scratch)?;
        let count: u64 = frames.iter().map(|[_, _, count]| u64::from_le_bytes(*count)).sum();
        for (place, (name, kind)) in FRAME_ARRAYS.into_iter().enumerate() {
            let bytes: Vec<u8> = frames.iter().flat_map(|frame| frame[place]).collect();
            start_array(zip, name, kind, &[frames.len() as u64], bytes.len() as u64)?;
            zip.write_all(&bytes)?;
        }
        let mut at = 0;
        for column in &COLUMNS {
            let shape = [&[count], column.shape].concat();
            start_array(zip, column.name, column.kind, &shape, count * column.bytes as u64)?;
            each_record(scratch, |record| match record[KIND.0] {
                kind if kind == KIND.1 => Ok(()),
                _ => zip.write_all(&record[at..at + column.bytes]),
            })?;
            at += column.bytes;
        }
        Ok(())
    })
}

/// The record that begins a frame.
fn beginning(frame: u64, step: [u8; 8], time: [u8; 8], count: [u8; 8]) -> [u8; RECORD] {
    let mut bytes = [0; RECORD];
    bytes[..8].copy_from_slice(&frame.to_le_bytes());
    bytes[KIND.0] = KIND.1;
    for (place, value) in [step, time, count].iter().enumerate() {
        bytes[10 + 8 * place..][..8].copy_from_slice(value);
    }
    bytes
}

/// The record of a contact: one item of every column.
fn record(frame: u64, row: &Row) -> Vec<u8> {
    let mut bytes = bytes_of([frame]);
    bytes.extend(row.sides.map(|side| side.kind()));
    bytes.extend(bytes_of(row.sides.map(|side| side.index)));
    bytes.extend(bytes_of(row.sides.map(|side| side.reference.map_or(-1, i64::from))));
    bytes.extend(bytes_of([row.point, row.normal].map(|vector| vector.to_array())));
    bytes.extend(bytes_of([row.overlap]));
    bytes.extend(bytes_of([row.force, row.impulse].map(|vector| vector.to_array())));
    bytes.extend(bytes_of([row.normal_force]));
    bytes.extend(bytes_of([row.tangential_force.to_array()]));
    bytes.extend(bytes_of([row.slip()]));
    bytes.extend(bytes_of([row.displacement().to_array()]));
    debug_assert_eq!(bytes.len(), RECORD);
    bytes
}

fn each_record(records: &mut AtomicFile, mut visit: impl FnMut(&[u8; RECORD]) -> io::Result<()>) -> io::Result<()> {
    let mut reader = BufReader::with_capacity(1 << 16, records.reader()?);
    let mut record = [0; RECORD];
    loop {
        match reader.read_exact(&mut record) {
            Ok(()) => visit(&record)?,
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(()),
            Err(error) => return Err(error),
        }
    }
}

/// Step, time and number of contacts of every frame.
fn beginnings(records: &mut AtomicFile) -> io::Result<Vec<[[u8; 8]; 3]>> {
    let mut found = Vec::new();
    each_record(records, |record| {
        if record[KIND.0] == KIND.1 {
            found.push([10, 18, 26].map(|at| std::array::from_fn(|byte| record[at + byte])));
        }
        Ok(())
    })?;
    Ok(found)
}

/// Writes the records of a finished archive, up to a mark, to `scratch`.
pub(super) fn unpack(path: &Path, scratch: &mut AtomicFile, mark: Mark) -> io::Result<()> {
    let mut archive = open_finished(path)?;
    let mut array = |name: &str| -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        archive.by_name(&format!("{name}.npy")).map_err(|_| not_as_before())?.read_to_end(&mut bytes)?;
        // The length of the rest of the header is at byte 8.
        let header = bytes.get(8..10).map(|length| 10 + usize::from(u16::from_le_bytes([length[0], length[1]])));
        header.filter(|header| *header <= bytes.len()).map(|header| bytes.split_off(header)).ok_or_else(not_as_before)
    };
    let [steps, times, counts] = [array("step")?, array("time")?, array("count")?];
    let columns = COLUMNS.iter().map(|column| array(column.name)).collect::<io::Result<Vec<_>>>()?;
    let eight = |bytes: &[u8], index: usize| -> io::Result<[u8; 8]> {
        bytes.get(8 * index..8 * index + 8).and_then(|bytes| bytes.try_into().ok()).ok_or_else(not_as_before)
    };
    let (mut written, mut contact) = (0, 0);
    for frame in 0..steps.len() / 8 {
        if written >= mark.bytes {
            break;
        }
        let count = eight(&counts, frame)?;
        scratch.write_all(&beginning(frame as u64, eight(&steps, frame)?, eight(&times, frame)?, count))?;
        for _ in 0..u64::from_le_bytes(count) {
            for (column, bytes) in COLUMNS.iter().zip(&columns) {
                scratch
                    .write_all(bytes.get(contact * column.bytes..(contact + 1) * column.bytes).ok_or_else(not_as_before)?)?;
            }
            contact += 1;
        }
        written += RECORD as u64 * (1 + u64::from_le_bytes(count));
    }
    Ok(())
}
