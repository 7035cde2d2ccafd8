//! Arrays for NumPy: `numpy.load("run.npz")`. They are uncompressed and little-endian. For F frames of N spheres in insertion
//! order:
//!
//! | array | shape | type | contents |
//! |---|---|---|---|
//! | `step` | F | u8 | number of steps done |
//! | `time` | F | f8 | simulated time, in s |
//! | `position`, `velocity`, `angular_momentum` | F, N, 3 | f4 | |
//! | `orientation` | F, N, 4 | f4 | unit quaternions w, x, y, z |
//! | `contacts` | F, N | u4 | number of contacts of each sphere, without those of its rods |
//! | `radius`, `mass` | N | f4 | |
//! | `fixed` | N | b1 | |
//! | `reference` | N | i8 | number of the sphere in the scene file, -1 for none |
//! | `rods`, `springs` | R, 2 and S, 2 | u4 | indices of the two spheres |
//! | `rod_radius` | R | f4 | |
//! | `tethers` | T | u4 | index of the sphere |
//! | `tether_point` | T, 3 | f4 | |
//! | `boxes` | B, 4, 3 | f4 | corner and three edges |
//! | `polygons` | P, 3, 3 | f4 | corner and two edges |
//! | `is_triangle` | P | u1 | 1 for a triangle, 0 for a parallelogram |
//! | `scene` | | S | the scene text of the last state, with all objects and settings: `run["scene"].item().decode()` |
//!
//! The types are NumPy's, with sizes in bytes. In the archive, each array is contiguous over all frames. Frames are therefore
//! written to `.NAME.frames.part` first and rearranged when the trajectory is finished, which needs twice the disk space.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use rockfall::Scene;
use rockfall::output::{AtomicFile, Mark};
use zip::{ZipArchive, ZipWriter};

use crate::Frame;
use crate::frame::{Indices, bytes_of};

pub(crate) mod archive;

use archive::{Archive, header, not_as_before, open_finished, start_array};

/// Arrays that have a part in every frame.
const FRAME_ARRAYS: [FrameArray; 7] = [
    FrameArray { name: "step", kind: "<u8", bytes: 8, shape: None },
    FrameArray { name: "time", kind: "<f8", bytes: 8, shape: None },
    FrameArray { name: "position", kind: "<f4", bytes: 12, shape: Some(&[3]) },
    FrameArray { name: "velocity", kind: "<f4", bytes: 12, shape: Some(&[3]) },
    FrameArray { name: "orientation", kind: "<f4", bytes: 16, shape: Some(&[4]) },
    FrameArray { name: "angular_momentum", kind: "<f4", bytes: 12, shape: Some(&[3]) },
    FrameArray { name: "contacts", kind: "<u4", bytes: 4, shape: Some(&[]) },
];

struct FrameArray {
    name: &'static str,
    kind: &'static str,
    /// Size of one item in bytes. An item is the data of one sphere, or of the whole frame if `shape` is `None`.
    bytes: u64,
    /// Shape of the data of one sphere; `None` if the array has one number per frame.
    shape: Option<&'static [u64]>,
}

impl FrameArray {
    /// Size of the part of one frame in bytes.
    fn bytes(&self, spheres: u64) -> u64 {
        self.bytes * if self.shape.is_some() { spheres } else { 1 }
    }
}

fn frame_bytes(spheres: u64) -> u64 {
    FRAME_ARRAYS.iter().map(|array| array.bytes(spheres)).sum()
}

/// State of an unfinished file. Its scratch file has the frames one after the other, each with its part of every array.
#[derive(Debug)]
pub(crate) struct Frames {
    /// Number of bytes in the scratch file.
    bytes: u64,
    /// Number of spheres in the previous frames; `None` before the first frame after opening.
    spheres: Option<usize>,
}

impl Frames {
    pub(crate) fn new(bytes: u64) -> Self {
        Self { bytes, spheres: None }
    }

    pub(crate) fn frame(&mut self, scratch: &mut AtomicFile, frame: &Frame) -> io::Result<()> {
        let spheres = &frame.spheres;
        let whole = self.bytes.is_multiple_of(frame_bytes(spheres.len() as u64));
        if !whole || self.spheres.is_some_and(|previous| previous != spheres.len()) {
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
            scratch.write_all(&part)?;
            self.bytes += part.len() as u64;
        }
        Ok(())
    }

    pub(crate) fn finish(self, archive: Archive, scene: &Scene) -> io::Result<()> {
        let spheres = scene.counts().spheres as u64;
        let whole = frame_bytes(spheres);
        if !self.bytes.is_multiple_of(whole) {
            return Err(changed());
        }
        let count = self.bytes / whole;
        archive.finish(|zip, scratch| {
            let frames = scratch.reader()?;
            let mut at = 0;
            for array in &FRAME_ARRAYS {
                let part = array.bytes(spheres);
                let mut shape = vec![count];
                if let Some(of_sphere) = array.shape {
                    shape.push(spheres);
                    shape.extend(of_sphere);
                }
                start_array(zip, array.name, array.kind, &shape, count * part)?;
                for frame in 0..count {
                    frames.seek(SeekFrom::Start(frame * whole + at))?;
                    let copied = io::copy(&mut (&*frames).take(part), zip)?;
                    if copied != part {
                        return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the frames written so far are incomplete"));
                    }
                }
                at += part;
            }
            constants(zip, scene)
        })
    }
}

fn changed() -> io::Error {
    io::Error::new(
        io::ErrorKind::InvalidData,
        "the number of spheres has changed between frames, expected .csv or .pvd for that",
    )
}

/// Writes the arrays that are the same in all frames.
fn constants(zip: &mut ZipWriter<impl Write + Seek>, scene: &Scene) -> io::Result<()> {
    let indices = Indices::of(scene);
    let mut array = |name: &str, kind: &str, count: usize, shape: &[u64], bytes: Vec<u8>| {
        let shape = [&[count as u64], shape].concat();
        start_array(zip, name, kind, &shape, bytes.len() as u64)?;
        zip.write_all(&bytes)
    };
    let spheres = scene.spheres();
    array("radius", "<f4", spheres.len(), &[], bytes_of(spheres.iter().map(|sphere| sphere.radius)))?;
    array("mass", "<f4", spheres.len(), &[], bytes_of(spheres.iter().map(|sphere| sphere.mass)))?;
    array("fixed", "|b1", spheres.len(), &[], bytes_of(spheres.iter().map(|sphere| u8::from(sphere.fixed))))?;
    let references = scene.sphere_ids().map(|id| scene.reference(id).map_or(-1, i64::from));
    array("reference", "<i8", spheres.len(), &[], bytes_of(references))?;
    let rods = scene.rods();
    array("rods", "<u4", rods.len(), &[2], bytes_of(rods.iter().map(|rod| indices.pair(rod.end1, rod.end2))))?;
    array("rod_radius", "<f4", rods.len(), &[], bytes_of(rods.iter().map(|rod| rod.radius)))?;
    let springs = scene.springs();
    array("springs", "<u4", springs.len(), &[2], bytes_of(springs.iter().map(|spring| indices.pair(spring.a, spring.b))))?;
    let tethers = scene.tethers();
    let sphere_of = |sphere| indices.pair(sphere, sphere)[0];
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
    array("polygons", "<f4", polygons.len(), &[3, 3], bytes_of(corners))?;
    let triangles = polygons.iter().map(|polygon| u8::from(polygon.is_triangle));
    array("is_triangle", "|u1", polygons.len(), &[], triangles.collect())?;
    // The scene also has what no array above has: capsules, rest lengths, groups and settings.
    let mut text = scene.to_text();
    if text.is_empty() {
        // NumPy has no text of length 0.
        text.push('\n');
    }
    start_array(zip, "scene", &format!("|S{}", text.len()), &[], text.len() as u64)?;
    zip.write_all(text.as_bytes())
}

/// Writes the frames of a finished archive, up to a mark, one after the other to `scratch`.
pub(crate) fn unpack(path: &Path, scratch: &mut AtomicFile, mark: Mark) -> io::Result<()> {
    let mut archive = open_finished(path)?;
    let spheres = shape_of(&mut archive, "radius")?.first().copied().unwrap_or(0);
    let (whole, have) = (frame_bytes(spheres), shape_of(&mut archive, "step")?.first().copied().unwrap_or(0));
    let count = mark.bytes / whole;
    if !mark.bytes.is_multiple_of(whole) || have < count {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "it has fewer frames than were written before"));
    }
    for frame in 0..count {
        for array in &FRAME_ARRAYS {
            let part = array.bytes(spheres);
            let mut entry = archive.by_name_seek(&format!("{}.npy", array.name))?;
            entry.seek(SeekFrom::Start(header_bytes(array, have, spheres) + frame * part))?;
            io::copy(&mut entry.take(part), scratch)?;
        }
    }
    Ok(())
}

/// Size in bytes of the header of an array that this module has written.
fn header_bytes(array: &FrameArray, frames: u64, spheres: u64) -> u64 {
    let shape: Vec<u64> = match array.shape {
        Some(of_sphere) => [&[frames, spheres], of_sphere].concat(),
        None => vec![frames],
    };
    header(array.kind, &shape).len() as u64
}

/// Shape of an array that this module has written.
fn shape_of(archive: &mut ZipArchive<File>, name: &str) -> io::Result<Vec<u64>> {
    let mut entry = archive.by_name(&format!("{name}.npy"))?;
    let mut start = [0; 128];
    let length = entry.read(&mut start)?;
    let text = String::from_utf8_lossy(&start[..length]);
    let shape = text.split_once("'shape': (").and_then(|(_, rest)| rest.split_once(')'));
    let numbers = shape.map(|(shape, _)| shape.split(',').filter_map(|length| length.trim().parse().ok()).collect());
    numbers.ok_or_else(not_as_before)
}
