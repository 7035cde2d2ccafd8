//! Broad phase: pairs of AABBs that overlap.
//!
//! Boxes lie in uniform grids, each in the cell of its middle: one grid for each range of sizes from 1 to 2. No box is larger
//! than a cell of its grid, so the boxes that overlap it are in the 27 cells around it, in its own grid and in coarser ones.
//! Infinite boxes, and the few boxes of rare sizes, are tried against all.

#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

use crate::rigid::periods::Periods;

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

    /// The box elsewhere.
    pub(crate) fn moved(&self, way: Vec3) -> Self {
        Self { min: self.min + way, max: self.max + way }
    }

    /// Whether it reaches into the box of a periodic scene, grown by `room` on all sides.
    pub(crate) fn reaches(&self, periods: &Periods, room: Vec3) -> bool {
        let Periods { lengths, least } = *periods;
        let is_in = self.max.cmpge(least - room) & self.min.cmple(least + lengths + room);
        (is_in | lengths.cmpeq(Vec3::ZERO)).all()
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

/// Boxes that one task takes at least where it does little with each. Fewer are not worth the way to another thread.
const GRAIN: usize = 256;

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
    min: Vec3A,
    max: Vec3A,
}

impl Entry {
    fn overlaps(&self, other: &Self) -> bool {
        (self.min.cmple(other.max) & other.min.cmple(self.max)).all()
    }

    fn middle(&self) -> DVec3 {
        (self.min.as_dvec3() + self.max.as_dvec3()) / 2.0
    }
}

/// All pairs (a, b), a < b, of boxes that overlap and that `may_touch` allows, in ascending order. Boxes may be infinite.
pub(crate) fn pairs(boxes: &[Aabb], may_touch: impl Fn(usize, usize) -> bool + Sync) -> Vec<(u32, u32)> {
    let (grids, large) = sort(boxes);
    let put = |found: &mut Vec<(u32, u32)>, a: u32, b: u32| {
        let (a, b) = (a.min(b), a.max(b));
        if may_touch(a as usize, b as usize) {
            found.push((a, b));
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
                grid.entries[range.clone()]
                    .iter()
                    .for_each(|entry| coarser.around(entry, |b| put(&mut found, entry.number, b)));
            }
            found
        });
        found.extend(tasks.collect::<Vec<_>>());
    }
    found.extend(with_large(boxes, &large, put));
    ascending(boxes.len(), &found)
}

/// The same, in a periodic scene also with images of the boxes for which `has_image` is true. `image`: what moves box b to the image that
/// counts for box a.
pub(crate) fn pairs_of_images(
    boxes: &[Aabb],
    periods: &Periods,
    has_image: impl Fn(usize) -> bool + Sync,
    image: impl Fn(usize, usize) -> Vec3 + Sync,
    may_touch: impl Fn(usize, usize) -> bool + Sync,
) -> Vec<(u32, u32)> {
    if !periods.any() {
        return pairs(boxes, may_touch);
    }
    let movers = || (0..boxes.len()).filter(|k| has_image(*k));
    // Whatever reaches out of the box does so by less than this.
    let reach = movers().map(|k| boxes[k].size() as f32).filter(|size| size.is_finite()).fold(0.0, f32::max);
    let mut all = boxes.to_vec();
    let mut images: Vec<(usize, Vec3)> = Vec::new();
    for k in movers() {
        let ways = periods.images().filter(|way| boxes[k].moved(*way).reaches(periods, Vec3::splat(reach)));
        images.extend(ways.map(|way| (k, way)));
    }
    all.extend(images.iter().map(|(k, way)| boxes[*k].moved(*way)));
    let owner = |k: usize| k.checked_sub(boxes.len()).map_or((k, Vec3::ZERO), |image| images[image]);
    let allowed = |i: usize, j: usize| {
        let ((a, way_a), (b, way_b)) = (owner(i), owner(j));
        // Of a pair and its images one counts: that in which the box with the smaller number is itself.
        a < b && way_a == Vec3::ZERO && way_b == image(a, b) && may_touch(a, b)
    };
    let found = pairs(&all, |i, j| allowed(i, j) || allowed(j, i));
    let numbers = |(i, j): (u32, u32)| [i, j].map(|k| owner(k as usize).0 as u32);
    let mut found: Vec<_> = found.into_iter().map(numbers).map(|[a, b]| (a.min(b), a.max(b))).collect();
    found.sort_unstable();
    found
}

/// All pairs in ascending order: counted and placed by their first boxes, then sorted by their second ones.
fn ascending(count: usize, found: &[Vec<(u32, u32)>]) -> Vec<(u32, u32)> {
    let mut ends = vec![0u32; count + 1];
    let all = || found.iter().flatten();
    all().for_each(|(a, _)| ends[*a as usize + 1] += 1);
    for k in 0..count {
        ends[k + 1] += ends[k];
    }
    // Now the start of each box; after the placement its end.
    let mut sorted = vec![(0, 0); ends[count] as usize];
    for pair in all() {
        let place = &mut ends[pair.0 as usize];
        sorted[*place as usize] = *pair;
        *place += 1;
    }
    // Sorted by the first box already, so parts between boxes can be sorted on their own.
    let mut parts = Vec::new();
    let (mut rest, mut taken) = (&mut sorted[..], 0);
    for last in (CHUNK..count + CHUNK).step_by(CHUNK) {
        let end = ends[last.min(count) - 1] as usize;
        let (part, others) = rest.split_at_mut(end - taken);
        parts.push(part);
        (rest, taken) = (others, end);
    }
    parts.into_par_iter().for_each(|part| part.chunk_by_mut(|p, q| p.0 == q.0).for_each(<[(u32, u32)]>::sort_unstable));
    sorted
}

/// Pairs with at least one of the large boxes.
fn with_large(boxes: &[Aabb], large: &[u32], put: impl Fn(&mut Vec<(u32, u32)>, u32, u32) + Sync) -> Vec<Vec<(u32, u32)>> {
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
    let sizes: Vec<f64> = boxes.par_iter().with_min_len(GRAIN).map(Aabb::size).collect();
    let mut known: Vec<f64> = sizes.iter().copied().filter(|size| size.is_finite()).collect();
    let mut large: Vec<u32> = Vec::new();
    if known.len() < 2 * FEWEST {
        return (Vec::new(), (0..boxes.len() as u32).collect());
    }
    // Most boxes are of one size. Its range ends a little above, so that few others fall into the next one.
    let rank = known.len() * 9 / 10;
    let base = *known.select_nth_unstable_by(rank, f64::total_cmp).1;
    let mut levels: BTreeMap<i32, Vec<u32>> = BTreeMap::new();
    let level = |size: &f64| libm::log2(size / (1.01 * base)).ceil().clamp(-20.0, 200.0);
    let places: Vec<f64> = sizes.par_iter().with_min_len(GRAIN).map(level).collect();
    for (number, (size, level)) in sizes.iter().zip(places).enumerate() {
        if size.is_finite() {
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
        let key = |number: &u32| (grid.key(boxes[*number as usize].middle()), *number);
        let mut order: Vec<(u64, u32)> = numbers.par_iter().with_min_len(GRAIN).map(key).collect();
        order.par_sort_unstable();
        let entry = |(key, number): (u64, u32)| {
            let bounds = &boxes[number as usize];
            Entry { key, number, min: bounds.min.into(), max: bounds.max.into() }
        };
        grid.entries = order.into_par_iter().with_min_len(GRAIN).map(entry).collect();
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
                    if entry.overlaps(other) {
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
        let key = self.key(entry.middle()) as i64;
        for row in 0..9 {
            let middle = (key + ((row / 3 - 1) << (2 * BITS)) + ((row % 3 - 1) << BITS)) as u64;
            let start = self.start(middle - 1);
            for other in self.entries[start..].iter().take_while(|other| other.key <= middle + 1) {
                if entry.overlaps(other) {
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
