//! The spheres of a trajectory in which spheres come and go.

use std::fs::File;
use std::io::{self, BufReader, Read};

use zip::ZipArchive;

use super::{Header, broken, check, entry_name, expect, header, unusable, whole};

/// All spheres that ever were there.
#[derive(Debug)]
pub(crate) struct Cast {
    /// Position of the data of `id` in its file.
    start: u64,
    /// Ids of the spheres of the scene, in insertion order.
    pub(crate) scene: Vec<u32>,
    /// The spheres that are not in the scene, by id.
    pub(crate) gone: Vec<(u32, Gone)>,
}

/// A sphere that some frames have, and the scene has not.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gone {
    pub(crate) radius: f32,
    pub(crate) mass: f32,
    pub(crate) is_fixed: bool,
}

impl Cast {
    pub(super) fn read(archive: &mut ZipArchive<File>, offsets: &[u64]) -> io::Result<Self> {
        let total = offsets.last().copied().unwrap_or(0);
        let Header { kind, shape, start } = check(archive, "id")?;
        expect("id", &kind, &shape, "<u4", &[total])?;
        let first_rows = first_rows(archive, offsets)?;
        let (bytes, kind, shape) = whole(archive, "scene_id")?;
        expect("scene_id", &kind, &shape, "<u4", &[bytes.len() as u64 / 4])?;
        let scene: Vec<u32> = bytes.as_chunks::<4>().0.iter().map(|id| u32::from_le_bytes(*id)).collect();
        let mut is_in_scene = vec![false; first_rows.len()];
        for id in &scene {
            // A sphere that no frame has is numbered after all others.
            let place = *id as usize;
            if place > is_in_scene.len() || is_in_scene.get(place) == Some(&true) {
                return Err(unusable(&format!("array scene_id: {id} is there twice, or not the next number")));
            }
            is_in_scene.resize(is_in_scene.len().max(place + 1), false);
            is_in_scene[place] = true;
        }
        let wanted = (0..).zip(first_rows).filter(|(id, _)| !is_in_scene[*id as usize]);
        let mut gone: Vec<(u32, u64, Gone)> = wanted.map(|(id, row)| (id, row, Gone::default())).collect();
        pick(archive, ("radius", "<f4"), total, &mut gone, |gone, bytes: [u8; 4]| gone.radius = f32::from_le_bytes(bytes))?;
        pick(archive, ("mass", "<f4"), total, &mut gone, |gone, bytes: [u8; 4]| gone.mass = f32::from_le_bytes(bytes))?;
        pick(archive, ("fixed", "|b1"), total, &mut gone, |gone, [byte]: [u8; 1]| gone.is_fixed = byte != 0)?;
        Ok(Self { start, scene, gone: gone.into_iter().map(|(id, _, gone)| (id, gone)).collect() })
    }

    pub(super) fn start(&self) -> u64 {
        self.start
    }
}

/// The row of the first frame with each sphere, by id.
fn first_rows(archive: &mut ZipArchive<File>, offsets: &[u64]) -> io::Result<Vec<u64>> {
    let mut found: Vec<(u64, usize)> = Vec::new();
    let mut frame = 0;
    each_item(archive, "id", |row, bytes: [u8; 4]| {
        while row >= offsets[frame + 1] {
            frame += 1;
        }
        let id = u32::from_le_bytes(bytes);
        let is_new = id as usize == found.len();
        match found.get_mut(id as usize) {
            None if is_new => found.push((row, frame)),
            Some((_, last)) if *last < frame => *last = frame,
            _ => return Err(unusable(&format!("frame {frame}: the id {id} is there twice, or not the next number"))),
        }
        Ok(())
    })?;
    Ok(found.into_iter().map(|(row, _)| row).collect())
}

/// Reads the items of spheres, which are in order of their rows.
fn pick<const N: usize>(
    archive: &mut ZipArchive<File>,
    (name, kind): (&str, &str),
    total: u64,
    spheres: &mut [(u32, u64, Gone)],
    put: impl Fn(&mut Gone, [u8; N]),
) -> io::Result<()> {
    let Header { kind: found, shape, .. } = check(archive, name)?;
    expect(name, &found, &shape, kind, &[total])?;
    let mut rest = spheres.iter_mut().peekable();
    each_item(archive, name, |row, bytes| {
        if let Some((_, _, gone)) = rest.next_if(|(_, wanted, _)| *wanted == row) {
            put(gone, bytes);
        }
        Ok(())
    })
}

/// Goes through an array that was checked.
fn each_item<const N: usize>(
    archive: &mut ZipArchive<File>,
    name: &str,
    mut visit: impl FnMut(u64, [u8; N]) -> io::Result<()>,
) -> io::Result<()> {
    let mut entry = archive.by_name(&entry_name(name)).map_err(broken(name))?;
    let rows = header(&mut entry, name)?.shape.iter().product();
    let mut entry = BufReader::with_capacity(1 << 16, entry);
    for row in 0..rows {
        let mut item = [0; N];
        entry.read_exact(&mut item)?;
        visit(row, item)?;
    }
    Ok(())
}
