//! Broad phase: pairs of AABBs that overlap.
//!
//! Boxes lie in uniform grids, each in the cell of its middle: one grid for each range of sizes from 1 to 2. No box is larger
//! than a cell of its grid, so the boxes that overlap it are in the 27 cells around it, in its own grid and in coarser ones.
//! Infinite boxes, and the few boxes of rare sizes, are tried against all.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// An axis-aligned bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Aabb {
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
}

impl Aabb {
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    fn middle(&self) -> DVec3 {
        (self.min.as_dvec3() + self.max.as_dvec3()) / 2.0
    }

    /// The greatest edge.
    fn size(&self) -> f64 {
        (self.max.as_dvec3() - self.min.as_dvec3()).max_element()
    }
}

/// A grid with fewer boxes is not worth its queries: its boxes are tried against all.
const FEWEST: usize = 8;

/// Bits of a cell's coordinate in a key. Boxes beyond the last cell share it.
const BITS: u32 = 21;

/// Boxes that one task takes.
const CHUNK: usize = 1024;

/// Boxes of about one size.
struct Grid {
    origin: DVec3,
    /// Edge of the cells.
    cell: f64,
    /// Cell, number and bounds of each box, in ascending order of cells and numbers.
    entries: Vec<Entry>,
}

#[derive(Clone, Copy)]
struct Entry {
    key: u64,
    number: u32,
    bounds: Aabb,
}

/// All pairs (a, b), a < b, of boxes that overlap and that `may_touch` allows, in ascending order. Boxes may be infinite.
pub(crate) fn pairs(boxes: &[Aabb], may_touch: impl Fn(usize, usize) -> bool + Sync) -> Vec<(u32, u32)> {
    let (grids, large) = sort(boxes);
    let put = |found: &mut Vec<u64>, a: u32, b: u32| {
        let (a, b) = (a.min(b), a.max(b));
        if may_touch(a as usize, b as usize) {
            found.push((a as u64) << 32 | b as u64);
        }
    };
    let mut found = Vec::new();
    for (level, grid) in grids.iter().enumerate() {
        let count = grid.entries.len();
        let tasks = (0..count.div_ceil(CHUNK)).into_par_iter().map(|task| {
            let mut found = Vec::new();
            let range = task * CHUNK..count.min((task + 1) * CHUNK);
            grid.within(range.clone(), |a, b| put(&mut found, a, b));
            for coarser in &grids[level + 1..] {
                grid.entries[range.clone()].iter().for_each(|entry| coarser.around(entry, |b| put(&mut found, entry.number, b)));
            }
            found
        });
        found.extend(tasks.collect::<Vec<_>>());
    }
    found.extend(with_large(boxes, &large, put));
    let mut keys = found.concat();
    keys.par_sort_unstable();
    keys.into_iter().map(|key| ((key >> 32) as u32, key as u32)).collect()
}

/// Pairs with at least one of the large boxes.
fn with_large(boxes: &[Aabb], large: &[u32], put: impl Fn(&mut Vec<u64>, u32, u32) + Sync) -> Vec<Vec<u64>> {
    if large.is_empty() {
        return Vec::new();
    }
    let task = |(task, part): (usize, &[Aabb])| {
        let mut found = Vec::new();
        for (k, bounds) in part.iter().enumerate() {
            let number = (task * CHUNK + k) as u32;
            let overlaps = |other: &&u32| **other != number && bounds.overlaps(&boxes[**other as usize]);
            // Of two large boxes, only the first one finds the pair.
            let mut is_large = None;
            for other in large.iter().filter(overlaps) {
                let is_large = *is_large.get_or_insert_with(|| large.binary_search(&number).is_ok());
                if !is_large || *other > number {
                    put(&mut found, number, *other);
                }
            }
        }
        found
    };
    boxes.par_chunks(CHUNK).enumerate().map(task).collect()
}

/// Grids, the finest first, and the boxes that are in none, ascending.
fn sort(boxes: &[Aabb]) -> (Vec<Grid>, Vec<u32>) {
    let sizes: Vec<f64> = boxes.par_iter().map(Aabb::size).collect();
    let mut known: Vec<f64> = sizes.iter().copied().filter(|size| size.is_finite()).collect();
    let mut large: Vec<u32> = Vec::new();
    if known.len() < 2 * FEWEST {
        return (Vec::new(), (0..boxes.len() as u32).collect());
    }
    // Most boxes are of one size. Its range ends a little above, so that few others fall into the next one.
    let rank = known.len() * 9 / 10;
    let base = *known.select_nth_unstable_by(rank, f64::total_cmp).1;
    let mut levels: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    for (number, size) in sizes.iter().enumerate() {
        if size.is_finite() && boxes[number].middle().is_finite() {
            let level = (size / (1.01 * base)).log2().ceil().clamp(-20.0, 200.0);
            levels.entry(if level.is_nan() { 0 } else { level as i32 }).or_default().push(number as u32);
        } else {
            large.push(number as u32);
        }
    }
    let mut grids = Vec::new();
    for numbers in levels.into_values() {
        if numbers.len() < FEWEST {
            large.extend(numbers);
        } else {
            grids.push(Grid::new(boxes, &sizes, &numbers));
        }
    }
    large.sort_unstable();
    (grids, large)
}

impl Grid {
    fn new(boxes: &[Aabb], sizes: &[f64], numbers: &[u32]) -> Self {
        let size = numbers.iter().map(|number| sizes[*number as usize]).fold(0.0, f64::max);
        let low = numbers.iter().map(|number| boxes[*number as usize].middle()).fold(DVec3::INFINITY, DVec3::min);
        // A little larger than the boxes, for rounding.
        let mut grid = Self { origin: low, cell: (size * (1.0 + 1e-6)).max(1e-30), entries: Vec::new() };
        let entry = |number: &u32| {
            let bounds = boxes[*number as usize];
            Entry { key: grid.key(bounds.middle()), number: *number, bounds }
        };
        let mut entries: Vec<Entry> = numbers.par_iter().map(entry).collect();
        entries.par_sort_unstable_by_key(|entry| (entry.key, entry.number));
        grid.entries = entries;
        grid
    }

    /// Key of the cell of a point: coordinates z, y, x from 1, so that all cells have neighbours.
    fn key(&self, point: DVec3) -> u64 {
        let last = ((1u64 << BITS) - 2) as f64;
        let cell = ((point - self.origin) / self.cell).floor() + 1.0;
        let [x, y, z] = [cell.x, cell.y, cell.z].map(|at| at.clamp(1.0, last) as u64);
        z << (2 * BITS) | y << BITS | x
    }

    /// Pairs of some entries with later ones.
    fn within(&self, range: std::ops::Range<usize>, mut put: impl FnMut(u32, u32)) {
        const ROW: i64 = 1 << BITS;
        const LAYER: i64 = 1 << (2 * BITS);
        // The rows of cells with greater keys. Their starts move on with the entry.
        let rows = [ROW, LAYER - ROW, LAYER, LAYER + ROW];
        let first = self.entries[range.start].key as i64;
        let mut starts = rows.map(|row| self.start((first + row - 1) as u64));
        for k in range {
            let entry = &self.entries[k];
            let mut try_all = |candidates: &[Entry], last: u64| {
                for other in candidates.iter().take_while(|other| other.key <= last) {
                    if entry.bounds.overlaps(&other.bounds) {
                        put(entry.number, other.number);
                    }
                }
            };
            try_all(&self.entries[k + 1..], entry.key + 1);
            for (start, row) in starts.iter_mut().zip(rows) {
                let middle = (entry.key as i64 + row) as u64;
                while *start < self.entries.len() && self.entries[*start].key < middle - 1 {
                    *start += 1;
                }
                try_all(&self.entries[*start..], middle + 1);
            }
        }
    }

    /// The boxes that overlap that of a finer grid.
    fn around(&self, entry: &Entry, mut put: impl FnMut(u32)) {
        let key = self.key(entry.bounds.middle()) as i64;
        for row in 0..9 {
            let middle = (key + ((row / 3 - 1) << (2 * BITS)) + ((row % 3 - 1) << BITS)) as u64;
            let start = self.start(middle - 1);
            for other in self.entries[start..].iter().take_while(|other| other.key <= middle + 1) {
                if entry.bounds.overlaps(&other.bounds) {
                    put(other.number);
                }
            }
        }
    }

    /// The first entry whose key is at least this one.
    fn start(&self, key: u64) -> usize {
        self.entries.partition_point(|entry| entry.key < key)
    }
}
