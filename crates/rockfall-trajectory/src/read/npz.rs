//! Reads `.npz` files.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use zip::ZipArchive;
use zip::result::ZipError;

use super::{Moment, States, states, unusable};

mod cast;

pub(super) use cast::{Cast, Gone};

/// An opened archive.
#[derive(Debug)]
pub(super) struct Frames {
    archive: ZipArchive<File>,
    rows: Rows,
    /// Position of the data of the arrays of [`NAMES`] in their files.
    starts: [u64; 4],
    /// Where spheres come and go, all those that ever were there.
    cast: Option<Cast>,
}

/// Where the spheres of a frame are in the arrays.
#[derive(Debug)]
enum Rows {
    /// As many in all frames.
    Constant(u64),
    /// Where each frame begins, and the end.
    Offsets(Vec<u64>),
}

impl Rows {
    /// First row and number of rows.
    fn of(&self, frame: usize) -> (u64, u64) {
        match self {
            Self::Constant(spheres) => (frame as u64 * spheres, *spheres),
            Self::Offsets(offsets) => (offsets[frame], offsets[frame + 1] - offsets[frame]),
        }
    }

    /// Shape of an array with the given number of components.
    fn shape(&self, frames: u64, components: u64) -> Vec<u64> {
        match self {
            Self::Constant(spheres) => vec![frames, *spheres, components],
            Self::Offsets(offsets) => vec![offsets.last().copied().unwrap_or(0), components],
        }
    }
}

/// The arrays with a part in every frame, and the number of components.
const NAMES: [(&str, u64); 4] = [("position", 3), ("velocity", 3), ("orientation", 4), ("angular_momentum", 3)];

/// The header of an array.
struct Header {
    kind: String,
    shape: Vec<u64>,
    /// Number of bytes before the data.
    start: u64,
}

pub(super) fn open(path: &Path) -> io::Result<(Frames, Vec<Moment>, Vec<u8>)> {
    let mut archive = ZipArchive::new(File::open(path)?).map_err(|error| match error {
        ZipError::Io(error) => error,
        other => unusable(&format!("it is not a complete .npz archive ({other})")),
    })?;
    let (steps, kind, shape) = whole(&mut archive, "step")?;
    let frames = shape.first().copied().unwrap_or(0);
    expect("step", &kind, &shape, "<u8", &[frames])?;
    let (times, kind, shape) = whole(&mut archive, "time")?;
    expect("time", &kind, &shape, "<f8", &[frames])?;
    let (text, kind, _) = whole(&mut archive, "scene").map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => unusable("it has no array scene: it was not written by this version of rockfall"),
        _ => error,
    })?;
    if !kind.starts_with("|S") {
        return Err(unusable(&format!("array scene has type {kind}, expected text")));
    }
    let (rows, cast) = if archive.index_for_name(&entry_name("offsets")).is_some() {
        let offsets = offsets(&mut archive, frames)?;
        let cast = Cast::read(&mut archive, &offsets)?;
        (Rows::Offsets(offsets), Some(cast))
    } else {
        let Header { shape, .. } = check(&mut archive, NAMES[0].0)?;
        (Rows::Constant(shape.get(1).copied().unwrap_or(0)), None)
    };
    let mut starts = [0; 4];
    for ((name, components), start) in NAMES.into_iter().zip(&mut starts) {
        let Header { kind, shape, start: found } = check(&mut archive, name)?;
        expect(name, &kind, &shape, "<f4", &rows.shape(frames, components))?;
        *start = found;
    }
    let eight = |bytes: &[u8], k: usize| <[u8; 8]>::try_from(&bytes[8 * k..8 * k + 8]).unwrap_or_default();
    let moment = |k| Moment { step: u64::from_le_bytes(eight(&steps, k)), time: f64::from_le_bytes(eight(&times, k)) };
    let moments = (0..frames as usize).map(moment).collect();
    Ok((Frames { archive, rows, starts, cast }, moments, text))
}

/// Reads where the frames begin.
fn offsets(archive: &mut ZipArchive<File>, frames: u64) -> io::Result<Vec<u64>> {
    let (bytes, kind, shape) = whole(archive, "offsets")?;
    expect("offsets", &kind, &shape, "<u8", &[frames + 1])?;
    let (words, _) = bytes.as_chunks::<8>();
    let offsets: Vec<u64> = words.iter().map(|word| u64::from_le_bytes(*word)).collect();
    if offsets[0] != 0 || offsets.windows(2).any(|pair| pair[0] > pair[1]) {
        return Err(unusable("array offsets: expected numbers that begin with 0 and do not decrease"));
    }
    Ok(offsets)
}

fn expect(name: &str, kind: &str, shape: &[u64], expected_kind: &str, expected_shape: &[u64]) -> io::Result<()> {
    if kind == expected_kind && shape == expected_shape {
        return Ok(());
    }
    Err(unusable(&format!("array {name} has type {kind} and shape {shape:?}, expected {expected_kind} and {expected_shape:?}")))
}

fn entry_name(name: &str) -> String {
    format!("{name}.npy")
}

fn broken(name: &str) -> impl Fn(ZipError) -> io::Error {
    move |error| match error {
        ZipError::FileNotFound => {
            io::Error::new(io::ErrorKind::NotFound, format!("not a usable trajectory: it has no array {name}"))
        }
        other => unusable(&format!("array {name}: {other}")),
    }
}

/// Reads an array completely: its bytes, type and shape.
fn whole(archive: &mut ZipArchive<File>, name: &str) -> io::Result<(Vec<u8>, String, Vec<u64>)> {
    let mut entry = archive.by_name(&entry_name(name)).map_err(broken(name))?;
    let Header { kind, shape, .. } = header(&mut entry, name)?;
    let mut bytes = Vec::new();
    entry.read_to_end(&mut bytes).map_err(|error| unusable(&format!("array {name}: {error}")))?;
    complete(name, &kind, &shape, bytes.len() as u64)?;
    Ok((bytes, kind, shape))
}

/// Reads an array once, so that its checksum is verified, and returns its header.
fn check(archive: &mut ZipArchive<File>, name: &str) -> io::Result<Header> {
    let mut entry = archive.by_name(&entry_name(name)).map_err(broken(name))?;
    if entry.compression() != zip::CompressionMethod::Stored {
        return Err(unusable(&format!("array {name} is compressed, expected an archive as numpy.savez or rockfall writes it")));
    }
    let header = header(&mut entry, name)?;
    let bytes = io::copy(&mut entry, &mut io::sink()).map_err(|error| unusable(&format!("array {name}: {error}")))?;
    complete(name, &header.kind, &header.shape, bytes)?;
    Ok(header)
}

/// Checks that an array has as many bytes as its type and shape require.
fn complete(name: &str, kind: &str, shape: &[u64], bytes: u64) -> io::Result<()> {
    let size = kind.get(2..).and_then(|size| size.parse::<u64>().ok());
    let expected = shape.iter().try_fold(size.unwrap_or(0), |product, length| product.checked_mul(*length));
    match (size, expected) {
        (Some(_), Some(expected)) if expected == bytes => Ok(()),
        _ => Err(unusable(&format!("array {name} has {bytes} bytes, which does not fit type {kind} and shape {shape:?}"))),
    }
}

/// Reads the header of an array, format 1.0 to 3.0 of `.npy`.
fn header(entry: &mut impl Read, name: &str) -> io::Result<Header> {
    let wrong = || unusable(&format!("array {name} has no valid .npy header"));
    let mut start = [0; 10];
    entry.read_exact(&mut start).map_err(|_| wrong())?;
    if !start.starts_with(b"\x93NUMPY") {
        return Err(wrong());
    }
    let (length, before) = match start[6] {
        1 => (u32::from(u16::from_le_bytes([start[8], start[9]])), 10),
        2 | 3 => {
            let mut rest = [0; 2];
            entry.read_exact(&mut rest).map_err(|_| wrong())?;
            (u32::from_le_bytes([start[8], start[9], rest[0], rest[1]]), 12)
        }
        _ => return Err(wrong()),
    };
    let mut text = Vec::new();
    entry.take(u64::from(length.min(1 << 20))).read_to_end(&mut text)?;
    let text = String::from_utf8_lossy(&text);
    let after = |key: &str| text.split_once(&format!("'{key}':")).map(|(_, rest)| rest.trim_start().to_owned());
    let kind = after("descr").and_then(|rest| rest.split('\'').nth(1).map(str::to_owned)).ok_or_else(wrong)?;
    let shape = after("shape").and_then(|rest| rest.strip_prefix('(')?.split_once(')').map(|(inside, _)| inside.to_owned()));
    let lengths = shape.ok_or_else(wrong)?;
    let lengths = lengths.split(',').map(str::trim).filter(|length| !length.is_empty());
    let shape: Vec<u64> = lengths.map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
    if !after("fortran_order").is_some_and(|rest| rest.starts_with("False")) {
        return Err(unusable(&format!("array {name} is in Fortran order, expected C order")));
    }
    Ok(Header { kind, shape, start: before + u64::from(length) })
}

impl Frames {
    /// Number of spheres in all frames; `None` where spheres come and go.
    pub(super) fn spheres(&self) -> Option<usize> {
        match self.rows {
            Rows::Constant(spheres) => Some(spheres as usize),
            Rows::Offsets(_) => None,
        }
    }

    /// Where spheres come and go, all those that ever were there.
    pub(super) fn cast(&self) -> Option<&Cast> {
        self.cast.as_ref()
    }

    pub(super) fn read(&mut self, index: usize) -> io::Result<States> {
        let (first, spheres) = self.rows.of(index);
        let mut arrays: [Vec<u8>; 4] = Default::default();
        for (k, (name, components)) in NAMES.into_iter().enumerate() {
            arrays[k] = self.part(name, self.starts[k] + 4 * components * first, 4 * components * spheres)?;
        }
        let mut states = states(&arrays)?;
        if let Some(start) = self.cast.as_ref().map(Cast::start) {
            let bytes = self.part("id", start + 4 * first, 4 * spheres)?;
            states.ids = bytes.as_chunks::<4>().0.iter().map(|id| u32::from_le_bytes(*id)).collect();
        }
        Ok(states)
    }

    /// Bytes of an array from a position in its file on.
    fn part(&mut self, name: &str, at: u64, bytes: u64) -> io::Result<Vec<u8>> {
        let mut entry = self.archive.by_name_seek(&entry_name(name)).map_err(broken(name))?;
        entry.seek(SeekFrom::Start(at))?;
        let mut found = vec![0; bytes as usize];
        entry.read_exact(&mut found)?;
        Ok(found)
    }
}
