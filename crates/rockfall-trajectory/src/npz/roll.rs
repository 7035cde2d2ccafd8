//! Which spheres a frame has.

use std::collections::{HashMap, VecDeque};
use std::io::{self, Read, Seek, SeekFrom, Write};

use rockfall::glam::Vec3;
use rockfall::output::AtomicFile;
use rockfall::{Scene, SphereId};
use zip::ZipWriter;

use super::{Column, array, bytes_per_sphere};
use crate::frame::bytes_of;

/// Number of a sphere in the file.
pub(super) const ID: Column = Column { name: "id", kind: "<u4", bytes: 4, shape: &[] };

/// Arrays with what does not change as long as the spheres are the same.
pub(super) const COLUMNS: [Column; 5] = [
    ID,
    Column { name: "radius", kind: "<f4", bytes: 4, shape: &[] },
    Column { name: "mass", kind: "<f4", bytes: 4, shape: &[] },
    Column { name: "fixed", kind: "|b1", bytes: 1, shape: &[] },
    Column { name: "reference", kind: "<i8", bytes: 8, shape: &[] },
];

/// The bytes of [`COLUMNS`] for the spheres of a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Roll([Vec<u8>; 5]);

impl Roll {
    pub(super) fn of(scene: &Scene, ids: Vec<u32>) -> Self {
        let spheres = scene.spheres();
        Self([
            bytes_of(ids),
            bytes_of(spheres.iter().map(|sphere| sphere.radius)),
            bytes_of(spheres.iter().map(|sphere| sphere.mass)),
            bytes_of(spheres.iter().map(|sphere| u8::from(sphere.fixed))),
            bytes_of(scene.sphere_ids().map(|id| scene.reference(id).map_or(-1, i64::from))),
        ])
    }

    /// Reads the roll of as many spheres at a place of the scratch file.
    pub(super) fn read(file: &mut (impl Read + Seek), at: u64, spheres: u64) -> io::Result<Self> {
        file.seek(SeekFrom::Start(at))?;
        let mut bytes = vec![0; (spheres * bytes_per_sphere(&COLUMNS)) as usize];
        file.read_exact(&mut bytes)?;
        let mut rest = bytes.as_slice();
        Ok(Self(std::array::from_fn(|column| {
            let (part, after) = rest.split_at((spheres * COLUMNS[column].bytes) as usize);
            rest = after;
            part.to_vec()
        })))
    }

    pub(super) fn write(&self, scratch: &mut AtomicFile) -> io::Result<()> {
        self.0.iter().try_for_each(|part| scratch.write_all(part))
    }

    /// Writes the arrays of a file in which the spheres are the same in all frames.
    pub(super) fn constants(&self, zip: &mut ZipWriter<impl Write + Seek>) -> io::Result<()> {
        let spheres = (self.0[0].len() / 4) as u64;
        let mut columns = COLUMNS.iter().zip(&self.0).skip(1);
        columns.try_for_each(|(column, part)| array(zip, column.name, column.kind, &[spheres], part))
    }

    fn ids(&self) -> impl Iterator<Item = u32> {
        self.0[0].chunks_exact(4).map(|id| u32::from_le_bytes([id[0], id[1], id[2], id[3]]))
    }

    /// The number after all ids.
    pub(super) fn next_id(&self) -> u32 {
        self.ids().max().map_or(0, |id| id + 1)
    }

    /// What tells the sphere of a row from others, for as long as it exists.
    fn key(&self, row: usize) -> Vec<u8> {
        let of = |column: usize| {
            let bytes = COLUMNS[column].bytes as usize;
            &self.0[column][row * bytes..(row + 1) * bytes]
        };
        (1..COLUMNS.len()).map(of).collect::<Vec<_>>().concat()
    }
}

/// Positions of as many spheres at a place of the scratch file.
pub(super) fn positions(file: &mut (impl Read + Seek), at: u64, spheres: u64) -> io::Result<Vec<[f32; 3]>> {
    file.seek(SeekFrom::Start(at))?;
    let mut bytes = vec![0; (12 * spheres) as usize];
    file.read_exact(&mut bytes)?;
    Ok(crate::read::vectors::<3>(&bytes).collect())
}

/// The spheres of the previous frame, with their ids.
#[derive(Debug, Default)]
pub(super) struct Cast {
    handles: Vec<SphereId>,
    ids: Vec<u32>,
    /// The number after all ids.
    next: u32,
    /// The previous frame, where another program wrote it: its handles are unknown.
    before: Option<(Roll, Vec<[f32; 3]>)>,
}

impl Cast {
    /// The cast of a file that is continued after a frame.
    pub(super) fn continued(last: Roll, positions: Vec<[f32; 3]>, next: u32) -> Self {
        Self { ids: last.ids().collect(), next, before: Some((last, positions)), ..Self::default() }
    }

    /// The ids of the spheres of the last scene, in insertion order.
    pub(super) fn ids(&self) -> &[u32] {
        &self.ids
    }

    /// Takes the spheres of a scene. Returns their roll if they are not those of the previous frame, of which there may be none.
    pub(super) fn roll(&mut self, scene: &Scene, has_previous: bool) -> Option<Roll> {
        if has_previous && self.before.is_none() && scene.sphere_ids().eq(self.handles.iter().copied()) {
            return None;
        }
        let known = match self.before.take() {
            Some((last, positions)) => recognized(&last, &positions, scene),
            None => self.handles.iter().copied().zip(self.ids.iter().copied()).collect(),
        };
        let handles: Vec<SphereId> = scene.sphere_ids().collect();
        let next = &mut self.next;
        let mut new = || {
            *next += 1;
            *next - 1
        };
        let ids: Vec<u32> = handles.iter().map(|handle| known.get(handle).copied().unwrap_or_else(&mut new)).collect();
        self.handles = handles;
        let is_same = has_previous && ids == self.ids;
        self.ids.clone_from(&ids);
        (!is_same).then(|| Roll::of(scene, ids))
    }
}

/// The ids of the spheres of a scene that a frame has, too. The scene is that of the frame, or that of a few steps later. References,
/// radii and masses tell spheres apart. Where some of equal ones have left since, the nearest places count.
fn recognized(last: &Roll, positions: &[[f32; 3]], scene: &Scene) -> HashMap<SphereId, u32> {
    let ids: Vec<u32> = last.ids().collect();
    let mut old: HashMap<Vec<u8>, VecDeque<usize>> = HashMap::new();
    (0..ids.len()).for_each(|row| old.entry(last.key(row)).or_default().push_back(row));
    let roll = Roll::of(scene, vec![0; scene.counts().spheres]);
    let mut present: HashMap<Vec<u8>, usize> = HashMap::new();
    (0..scene.counts().spheres).for_each(|row| *present.entry(roll.key(row)).or_default() += 1);
    let mut known = HashMap::new();
    for (row, (handle, sphere)) in scene.sphere_ids().zip(scene.spheres()).enumerate() {
        let key = roll.key(row);
        let Some(candidates) = old.get_mut(&key) else { continue };
        let left = present.entry(key).or_default();
        let distance = |row: usize| Vec3::from(positions[row]).distance_squared(sphere.position);
        let place = match *left < candidates.len() {
            true => (0..candidates.len()).min_by(|a, b| distance(candidates[*a]).total_cmp(&distance(candidates[*b]))),
            false => Some(0),
        };
        *left -= 1;
        if let Some(row) = place.and_then(|place| candidates.remove(place)) {
            known.insert(handle, ids[row]);
        }
    }
    known
}
