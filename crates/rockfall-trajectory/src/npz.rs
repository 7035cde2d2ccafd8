//! Arrays for NumPy: `numpy.load("run.npz")`, uncompressed, little-endian. With F frames of N spheres in order of addition:
//!
//! | array | shape | type | what |
//! |---|---|---|---|
//! | `step` | F | u8 | steps done |
//! | `time` | F | f8 | in s |
//! | `position`, `velocity`, `angular_momentum` | F, N, 3 | f4 | |
//! | `orientation` | F, N, 4 | f4 | unit quaternions w, x, y, z |
//! | `contacts` | F, N | u4 | contacts of each sphere's own |
//! | `radius`, `mass` | N | f4 | |
//! | `fixed` | N | b1 | |
//! | `rods`, `springs` | R, 2 and S, 2 | u4 | the two spheres, by index |
//! | `rod_radius` | R | f4 | |
//! | `tethers` | T | u4 | the sphere, by index |
//! | `tether_point` | T, 3 | f4 | |
//! | `boxes` | B, 4, 3 | f4 | corner and three edges |
//! | `polygons` | P, 3, 3 | f4 | corner and two edges |
//!
//! An array of an archive is one piece, over all frames; so frames are kept one after the other in `.NAME.frames.part` until
//! the trajectory is finished, which needs room on the disk twice.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use rockfall::Scene;
use rockfall::output::{AtomicFile, Mark};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::Frame;
use crate::frame::{Places, bytes_of};

/// Arrays of which every frame holds a part: name, type, bytes and shape for each of `per` items.
const FRAMED: [Framed; 7] = [
    Framed { name: "step", kind: "<u8", bytes: 8, shape: None },
    Framed { name: "time", kind: "<f8", bytes: 8, shape: None },
    Framed { name: "position", kind: "<f4", bytes: 12, shape: Some(&[3]) },
    Framed { name: "velocity", kind: "<f4", bytes: 12, shape: Some(&[3]) },
    Framed { name: "orientation", kind: "<f4", bytes: 16, shape: Some(&[4]) },
    Framed { name: "angular_momentum", kind: "<f4", bytes: 12, shape: Some(&[3]) },
    Framed { name: "contacts", kind: "<u4", bytes: 4, shape: Some(&[]) },
];

struct Framed {
    name: &'static str,
    kind: &'static str,
    /// Bytes of one item.
    bytes: u64,
    /// Of one sphere; `None` for one item a frame.
    shape: Option<&'static [u64]>,
}

impl Framed {
    /// Bytes of one frame.
    fn bytes(&self, spheres: u64) -> u64 {
        self.bytes * if self.shape.is_some() { spheres } else { 1 }
    }
}

fn frame_bytes(spheres: u64) -> u64 {
    FRAMED.iter().map(|array| array.bytes(spheres)).sum()
}

#[derive(Debug)]
pub(crate) struct Series {
    /// Opened at the start, so that a bad path shows there.
    archive: AtomicFile,
    /// Frame after frame, each with its part of every array.
    frames: AtomicFile,
    bytes: u64,
    /// Of the frames before.
    spheres: Option<usize>,
}

impl Series {
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let archive = AtomicFile::create(path)?;
        Ok(Self { archive, frames: AtomicFile::create(&frames_path(path)?)?, bytes: 0, spheres: None })
    }

    pub(crate) fn resume(path: &Path, mark: Mark) -> io::Result<Self> {
        let archive = AtomicFile::create(path)?;
        let scratch = frames_path(path)?;
        let frames = match AtomicFile::resume(&scratch, mark) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => unpack(path, &scratch, mark)?,
            result => result?,
        };
        Ok(Self { archive, frames, bytes: mark.bytes, spheres: None })
    }

    pub(crate) fn frame(&mut self, frame: &Frame) -> io::Result<()> {
        let spheres = &frame.spheres;
        let whole = self.bytes.is_multiple_of(frame_bytes(spheres.len() as u64));
        if !whole || self.spheres.is_some_and(|before| before != spheres.len()) {
            return Err(changed());
        }
        self.spheres = Some(spheres.len());
        let parts = [
            bytes_of([frame.step]),
            bytes_of([frame.time]),
            bytes_of(spheres.iter().map(|sphere| sphere.position.to_array())),
            bytes_of(spheres.iter().map(|sphere| sphere.velocity.to_array())),
            bytes_of(spheres.iter().map(|sphere| {
                let q = sphere.orientation;
                [q.w, q.x, q.y, q.z]
            })),
            bytes_of(spheres.iter().map(|sphere| sphere.angular_momentum.to_array())),
            bytes_of(frame.contacts.iter().copied()),
        ];
        for part in parts {
            self.frames.write_all(&part)?;
            self.bytes += part.len() as u64;
        }
        Ok(())
    }

    pub(crate) fn mark(&mut self) -> io::Result<Option<Mark>> {
        self.frames.mark()
    }

    pub(crate) fn finish(mut self, scene: &Scene) -> io::Result<()> {
        let spheres = scene.counts().spheres as u64;
        let whole = frame_bytes(spheres);
        if !self.bytes.is_multiple_of(whole) {
            return Err(changed());
        }
        let count = self.bytes / whole;
        let frames = self.frames.reader()?;
        let mut zip = ZipWriter::new_stream(&mut self.archive);
        let mut at = 0;
        for array in &FRAMED {
            let part = array.bytes(spheres);
            let mut shape = vec![count];
            if let Some(of_sphere) = array.shape {
                shape.push(spheres);
                shape.extend(of_sphere);
            }
            start(&mut zip, array.name, array.kind, &shape, count * part)?;
            for frame in 0..count {
                frames.seek(SeekFrom::Start(frame * whole + at))?;
                let copied = io::copy(&mut (&*frames).take(part), &mut zip)?;
                if copied != part {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
            }
            at += part;
        }
        constants(&mut zip, scene)?;
        zip.finish()?;
        self.archive.commit()?;
        self.frames.discard();
        Ok(())
    }
}

fn changed() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the number of spheres has changed between frames")
}

fn frames_path(path: &Path) -> io::Result<PathBuf> {
    let mut name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?.to_owned();
    name.push(".frames");
    Ok(path.with_file_name(name))
}

/// Begins an array of the archive.
fn start(zip: &mut ZipWriter<impl Write + Seek>, name: &str, kind: &str, shape: &[u64], bytes: u64) -> io::Result<()> {
    let large = bytes > u64::from(u32::MAX) - 1024;
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored).large_file(large);
    zip.start_file(format!("{name}.npy"), options)?;
    zip.write_all(&header(kind, shape))
}

/// Format 1.0 of `.npy`: magic, length, and a description as Python writes it, padded to 64 bytes.
fn header(kind: &str, shape: &[u64]) -> Vec<u8> {
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.trim_end());
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{text:<width$}\n", width = length - 1).as_bytes());
    bytes
}

/// What is the same in all frames.
fn constants(zip: &mut ZipWriter<impl Write + Seek>, scene: &Scene) -> io::Result<()> {
    let places = Places::of(scene);
    let mut array = |name: &str, kind: &str, count: usize, shape: &[u64], bytes: Vec<u8>| {
        let shape = [&[count as u64], shape].concat();
        start(zip, name, kind, &shape, bytes.len() as u64)?;
        zip.write_all(&bytes)
    };
    let spheres = scene.spheres();
    array("radius", "<f4", spheres.len(), &[], bytes_of(spheres.iter().map(|sphere| sphere.radius)))?;
    array("mass", "<f4", spheres.len(), &[], bytes_of(spheres.iter().map(|sphere| sphere.mass)))?;
    array("fixed", "|b1", spheres.len(), &[], bytes_of(spheres.iter().map(|sphere| u8::from(sphere.fixed))))?;
    let rods = scene.rods();
    array("rods", "<u4", rods.len(), &[2], bytes_of(rods.iter().map(|rod| places.pair(rod.end1, rod.end2))))?;
    array("rod_radius", "<f4", rods.len(), &[], bytes_of(rods.iter().map(|rod| rod.radius)))?;
    let springs = scene.springs();
    array("springs", "<u4", springs.len(), &[2], bytes_of(springs.iter().map(|spring| places.pair(spring.a, spring.b))))?;
    let tethers = scene.tethers();
    let sphere_of = |sphere| places.pair(sphere, sphere)[0];
    array("tethers", "<u4", tethers.len(), &[], bytes_of(tethers.iter().map(|tether| sphere_of(tether.sphere))))?;
    array("tether_point", "<f4", tethers.len(), &[3], bytes_of(tethers.iter().map(|tether| tether.point.to_array())))?;
    let boxes = scene.boxes();
    let corners = boxes.iter().map(|cuboid| {
        let [i, j, k] = cuboid.edges;
        [cuboid.corner, i, j, k].map(|vector| vector.to_array())
    });
    array("boxes", "<f4", boxes.len(), &[4, 3], bytes_of(corners))?;
    let polygons = scene.polygons();
    let corners = polygons.iter().map(|polygon| [polygon.corner, polygon.left, polygon.right].map(|vector| vector.to_array()));
    array("polygons", "<f4", polygons.len(), &[3, 3], bytes_of(corners))
}

/// The frames of a finished archive, one after the other again, up to a mark.
fn unpack(path: &Path, scratch: &Path, mark: Mark) -> io::Result<AtomicFile> {
    let other = |what: &str| io::Error::new(io::ErrorKind::InvalidData, what.to_owned());
    let finished = File::open(path)
        .map_err(|error| io::Error::new(error.kind(), "what was written of it before is not there any more"))?;
    let mut archive = ZipArchive::new(finished).map_err(|_| other("it is not what was written before"))?;
    let spheres = shape_of(&mut archive, "radius")?.first().copied().unwrap_or(0);
    let (whole, have) = (frame_bytes(spheres), shape_of(&mut archive, "step")?.first().copied().unwrap_or(0));
    let count = mark.bytes / whole;
    if !mark.bytes.is_multiple_of(whole) || have < count {
        return Err(other("it has fewer frames than were written before"));
    }
    let mut frames = AtomicFile::create(scratch)?;
    for frame in 0..count {
        for array in &FRAMED {
            let part = array.bytes(spheres);
            let mut entry = archive.by_name_seek(&format!("{}.npy", array.name))?;
            entry.seek(SeekFrom::Start(header_bytes(array, have, spheres) + frame * part))?;
            io::copy(&mut entry.take(part), &mut frames)?;
        }
    }
    match frames.mark()? {
        Some(found) if found == mark => Ok(frames),
        _ => {
            frames.discard();
            Err(other("it is not what was written before"))
        }
    }
}

/// Bytes before the numbers of an array that was written here.
fn header_bytes(array: &Framed, frames: u64, spheres: u64) -> u64 {
    let shape: Vec<u64> = match array.shape {
        Some(of_sphere) => [&[frames, spheres], of_sphere].concat(),
        None => vec![frames],
    };
    header(array.kind, &shape).len() as u64
}

/// The shape of an array that was written here.
fn shape_of(archive: &mut ZipArchive<File>, name: &str) -> io::Result<Vec<u64>> {
    let mut entry = archive.by_name(&format!("{name}.npy"))?;
    let mut start = [0; 128];
    let length = entry.read(&mut start)?;
    let text = String::from_utf8_lossy(&start[..length]);
    let shape = text.split_once("'shape': (").and_then(|(_, rest)| rest.split_once(')'));
    let numbers = shape.map(|(shape, _)| shape.split(',').filter_map(|length| length.trim().parse().ok()).collect());
    numbers.ok_or_else(|| io::Error::new(io::ErrorKind::InvalidData, "it is not what was written before"))
}
