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
//!
//! Where spheres come and go, the arrays that have a part for every sphere hold the spheres of all frames one after the other, T in all:
//!
//! | array | shape | type | contents |
//! |---|---|---|---|
//! | `offsets` | F + 1 | u8 | frame k has the rows `offsets[k]` to `offsets[k + 1] - 1` |
//! | `id` | T | u4 | number of the sphere, the same in all frames and of no other sphere; counted from 0 in order of appearance |
//! | `position`, `velocity`, `angular_momentum`, `orientation`, `contacts` | T, 3 or T, 4 or T | | as above |
//! | `radius`, `mass`, `fixed`, `reference` | T | | as above |
//! | `scene_id` | N | u4 | `id` of every sphere of the scene text. It may have spheres that no frame has |
//! | `rods`, `springs`, `tethers` | | u4 | as above, with the `id` of the spheres in place of indices; those of the scene text |

use std::io::{self, Read, Seek, SeekFrom, Write};

use rockfall::Scene;
use rockfall::output::AtomicFile;
use zip::ZipWriter;

use crate::Frame;
use crate::frame::{Indices, bytes_of};

pub(crate) mod archive;
mod roll;
mod unpack;

pub(crate) use unpack::unpack;

use archive::{Archive, start_array};
use roll::{Cast, Roll};

/// Arrays with one number per frame, of 8 bytes.
const MOMENTS: [(&str, &str); 2] = [("step", "<u8"), ("time", "<f8")];

/// Arrays with an item for every sphere of every frame.
const STATES: [Column; 5] = [
    Column { name: "position", kind: "<f4", bytes: 12, shape: &[3] },
    Column { name: "velocity", kind: "<f4", bytes: 12, shape: &[3] },
    Column { name: "orientation", kind: "<f4", bytes: 16, shape: &[4] },
    Column { name: "angular_momentum", kind: "<f4", bytes: 12, shape: &[3] },
    Column { name: "contacts", kind: "<u4", bytes: 4, shape: &[] },
];

/// An array with an item for every sphere.
struct Column {
    name: &'static str,
    kind: &'static str,
    /// Size of an item in bytes.
    bytes: u64,
    /// Shape of an item.
    shape: &'static [u64],
}

/// Size of the items of a sphere in bytes.
fn bytes_per_sphere(columns: &[Column]) -> u64 {
    columns.iter().map(|column| column.bytes).sum()
}

/// Bytes before the states in the record of a frame: step, time, number of spheres, and whether a roll follows the states.
const HEAD: u64 = 32;

/// Place of the record of a frame in the scratch file. A record has a head, the states of the spheres, each array after the other,
/// and where the spheres are others than in the frame before, their [`Roll`].
#[derive(Clone, Copy, Debug)]
struct Place {
    at: u64,
    /// Number of spheres.
    spheres: u64,
    /// Start of the last roll up to this frame.
    roll: u64,
}

impl Place {
    /// The record that begins after `bytes` bytes.
    fn after(previous: Option<&Self>, at: u64, spheres: u64, has_roll: bool) -> Self {
        let own = at + HEAD + spheres * bytes_per_sphere(&STATES);
        Self { at, spheres, roll: previous.filter(|_| !has_roll).map_or(own, |previous| previous.roll) }
    }

    fn has_roll(&self) -> bool {
        self.roll > self.at
    }

    fn end(&self) -> u64 {
        let roll = if self.has_roll() { bytes_per_sphere(&roll::COLUMNS) } else { 0 };
        self.at + HEAD + self.spheres * (bytes_per_sphere(&STATES) + roll)
    }
}

/// State of an unfinished file.
#[derive(Debug)]
pub(crate) struct Frames {
    places: Vec<Place>,
    cast: Cast,
}

impl Frames {
    /// Finds the frames in the first `bytes` bytes of a scratch file.
    pub(crate) fn new(scratch: &mut AtomicFile, bytes: u64) -> io::Result<Self> {
        let mut places: Vec<Place> = Vec::new();
        if bytes == 0 {
            return Ok(Self { places, cast: Cast::default() });
        }
        let file = scratch.reader()?;
        let mut ids = 0;
        let mut last = Roll::default();
        while places.last().map_or(0, Place::end) < bytes {
            let at = places.last().map_or(0, Place::end);
            let mut head = [[0; 8]; 4];
            file.seek(SeekFrom::Start(at))?;
            file.read_exact(head.as_flattened_mut())?;
            let [_, _, spheres, has_roll] = head.map(u64::from_le_bytes);
            let place = Place::after(places.last(), at, spheres, has_roll != 0);
            if place.has_roll() {
                last = Roll::read(file, place.roll, place.spheres)?;
                ids = ids.max(last.next_id());
            }
            places.push(place);
        }
        let positions = match places.last() {
            Some(place) => roll::positions(file, place.at + HEAD, place.spheres)?,
            None => Vec::new(),
        };
        Ok(Self { places, cast: Cast::continued(last, positions, ids) })
    }

    pub(crate) fn frame(&mut self, scratch: &mut AtomicFile, frame: &Frame, scene: &Scene) -> io::Result<()> {
        let spheres = &frame.spheres;
        let roll = self.cast.roll(scene, !self.places.is_empty());
        let at = self.places.last().map_or(0, Place::end);
        scratch.write_all(&head(frame.step.to_le_bytes(), frame.time.to_le_bytes(), spheres.len() as u64, roll.is_some()))?;
        let states = [
            bytes_of(spheres.iter().map(|sphere| sphere.position.to_array())),
            bytes_of(spheres.iter().map(|sphere| sphere.velocity.to_array())),
            bytes_of(spheres.iter().map(|sphere| {
                let q = sphere.orientation;
                [q.w, q.x, q.y, q.z]
            })),
            bytes_of(spheres.iter().map(|sphere| sphere.angular_momentum.to_array())),
            bytes_of(frame.contacts.iter().copied()),
        ];
        states.iter().try_for_each(|part| scratch.write_all(part))?;
        let place = Place::after(self.places.last(), at, spheres.len() as u64, roll.is_some());
        roll.map_or(Ok(()), |roll| roll.write(scratch))?;
        self.places.push(place);
        Ok(())
    }

    pub(crate) fn finish(mut self, archive: Archive, scene: &Scene) -> io::Result<()> {
        let changed = self.cast.roll(scene, !self.places.is_empty()).is_some();
        let comes_and_goes = !self.places.is_empty() && changed || self.places.iter().skip(1).any(Place::has_roll);
        let Self { places, cast } = self;
        let frames = places.len() as u64;
        archive.finish(|zip, scratch| {
            let scratch = scratch.reader()?;
            for (number, (name, kind)) in MOMENTS.into_iter().enumerate() {
                start_array(zip, name, kind, &[frames], 8 * frames)?;
                places.iter().try_for_each(|place| copy(scratch, place.at + 8 * number as u64, 8, zip))?;
            }
            let total = places.iter().map(|place| place.spheres).sum();
            let rows = match comes_and_goes {
                true => vec![total],
                false => vec![frames, scene.counts().spheres as u64],
            };
            columns(zip, scratch, &places, &STATES, &rows, |place| place.at + HEAD)?;
            if comes_and_goes {
                let ends = places.iter().scan(0, |end, place| {
                    *end += place.spheres;
                    Some(*end)
                });
                array(zip, "offsets", "<u8", &[frames + 1], &bytes_of([0].into_iter().chain(ends)))?;
                columns(zip, scratch, &places, &roll::COLUMNS, &rows, |place| place.roll)?;
                array(zip, "scene_id", "<u4", &[cast.ids().len() as u64], &bytes_of(cast.ids().iter().copied()))?;
            } else {
                Roll::of(scene, cast.ids().to_vec()).constants(zip)?;
            }
            let numbers = comes_and_goes.then_some(cast.ids());
            constants(zip, scene, &Indices::numbered(scene, numbers))
        })
    }
}

/// The head of the record of a frame.
fn head(step: [u8; 8], time: [u8; 8], spheres: u64, has_roll: bool) -> Vec<u8> {
    [step, time, spheres.to_le_bytes(), u64::from(has_roll).to_le_bytes()].concat()
}

/// Writes arrays from the parts that the records of all frames have of them. `start` is where these parts begin.
fn columns(
    zip: &mut ZipWriter<impl Write + Seek>,
    scratch: &mut (impl Read + Seek),
    places: &[Place],
    columns: &[Column],
    rows: &[u64],
    start: impl Fn(&Place) -> u64,
) -> io::Result<()> {
    let mut before = 0;
    for column in columns {
        let shape = [rows, column.shape].concat();
        start_array(zip, column.name, column.kind, &shape, rows.iter().product::<u64>() * column.bytes)?;
        for place in places {
            copy(scratch, start(place) + before * place.spheres, place.spheres * column.bytes, zip)?;
        }
        before += column.bytes;
    }
    Ok(())
}

/// Copies bytes of the scratch file.
fn copy(from: &mut (impl Read + Seek), at: u64, bytes: u64, to: &mut impl Write) -> io::Result<()> {
    from.seek(SeekFrom::Start(at))?;
    match io::copy(&mut from.take(bytes), to)? {
        copied if copied == bytes => Ok(()),
        _ => Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the frames written so far are incomplete")),
    }
}

/// Writes an array.
fn array(zip: &mut ZipWriter<impl Write + Seek>, name: &str, kind: &str, shape: &[u64], bytes: &[u8]) -> io::Result<()> {
    start_array(zip, name, kind, shape, bytes.len() as u64)?;
    zip.write_all(bytes)
}

/// Writes the arrays that are the same in all frames, without those of the spheres.
fn constants(zip: &mut ZipWriter<impl Write + Seek>, scene: &Scene, indices: &Indices) -> io::Result<()> {
    let mut array = |name: &str, kind: &str, count: usize, shape: &[u64], bytes: Vec<u8>| {
        array(zip, name, kind, &[&[count as u64], shape].concat(), &bytes)
    };
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
    let triangles = polygons.iter().map(|polygon| u8::from(polygon.is_triangle()));
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
