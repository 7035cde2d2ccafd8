//! The grid: which cell an object is in, and which cells it may find others in.
//!
//! Levels of cells, each twice as large as the one below. An object is in one cell: that of its centre, on the lowest level
//! whose cells are not smaller than it. So what overlaps an AABB has its centre within half a cell of it, on every level:
//! radii of all sizes, long rods and large boxes are found with a few rows of cells a level. Cells live in a hashed table,
//! so that the extent of the scene costs nothing.

use glam::Vec3;

use crate::cpu::broad::{entries, may_meet};
use crate::layout::{Aabb, CELLS_AT, LEVEL_BIAS, ROW_LEVEL, ROW_Y, ROW_Z, Step, TOP_LEVEL};

fn cell_size(step: &Step, level: u32) -> f32 {
    step.cell_size * 2f32.powi(level as i32 - LEVEL_BIAS as i32)
}

fn level_of(step: &Step, aabb: &Aabb) -> u32 {
    let largest = (Vec3::from_array(aabb.max) - Vec3::from_array(aabb.min)).max_element();
    (0..TOP_LEVEL).find(|level| largest <= cell_size(step, *level)).unwrap_or(TOP_LEVEL)
}

/// The cell of a place, along one axis. Casting clamps what is far out, which keeps the order of coordinates.
fn coordinate(step: &Step, place: f32, level: u32) -> i32 {
    if level == TOP_LEVEL { 0 } else { ((place / cell_size(step, level)).floor() as i32).clamp(-(1 << 30), 1 << 30) }
}

/// Along x cells are neighbours in the table; rows are scattered.
fn key(step: &Step, x: i32, y: i32, z: i32, level: u32) -> u32 {
    let row =
        (y as u32).wrapping_mul(ROW_Y).wrapping_add((z as u32).wrapping_mul(ROW_Z)).wrapping_add(level.wrapping_mul(ROW_LEVEL));
    row.wrapping_add(x as u32) & (step.cells - 1)
}

/// Whether the balls that the AABBs of two spheres enclose meet, with room for rounding.
fn balls_meet(a: &Aabb, b: &Aabb) -> bool {
    let [a, b] = [a, b].map(|aabb| (Vec3::from_array(aabb.min) * 0.5, Vec3::from_array(aabb.max) * 0.5));
    let middles = [a.0 + a.1, b.0 + b.1];
    let slack = 1e-6 * (middles[0].abs().max_element() + middles[1].abs().max_element());
    let reach = (a.1 - a.0).max_element() + (b.1 - b.0).max_element();
    // Not the other way round: what has no bounds meets all.
    let apart = middles[0].distance(middles[1]) > reach * 1.000_001 + slack;
    !apart
}

/// The cell of an object in the table, and its level.
pub(crate) fn key_of(step: &Step, aabb: &Aabb) -> (u32, u32) {
    let level = level_of(step, aabb);
    let [x, y, z] = std::array::from_fn(|axis| coordinate(step, 0.5 * aabb.min[axis] + 0.5 * aabb.max[axis], level));
    (key(step, x, y, z, level), level)
}

/// The sorted objects, for finding neighbours.
#[derive(Clone, Copy)]
pub(crate) struct Grid<'a> {
    step: &'a Step,
    aabbs: &'a [Aabb],
    levels: u32,
    /// Where every cell ends.
    ends: &'a [u32],
    sorted: &'a [u32],
}

impl<'a> Grid<'a> {
    pub(crate) fn new(step: &'a Step, aabbs: &'a [Aabb], cells: &'a [u32]) -> Self {
        Self {
            step,
            aabbs,
            levels: cells[0],
            ends: &cells[CELLS_AT as usize..][..step.cells as usize],
            sorted: &cells[step.sorted_at as usize..][..aabbs.len()],
        }
    }

    /// The list entries of a mover, in any order; one may come twice, where two rows share places of the table.
    pub(crate) fn for_each_pair(&self, mover: u32, mut take: impl FnMut(u32)) {
        let own = &self.aabbs[mover as usize];
        let levels = (0..=TOP_LEVEL).filter(|level| self.levels >> level & 1 == 1);
        let ranges = levels.map(|level| (level, [0, 1, 2].map(|axis| self.around(own, axis, level))));
        let too_many = |(_, [x, y, z]): (u32, [(i32, i32); 3])| {
            let size = |(low, high): (i32, i32)| i64::from(high) - i64::from(low) + 1;
            size(y) * size(z) > self.aabbs.len() as i64 || size(x) >= i64::from(self.step.cells)
        };
        if ranges.clone().any(too_many) {
            return self.test(mover, 0, self.sorted.len() as u32, &mut take);
        }
        for (level, [x, y, z]) in ranges {
            for z in z.0..=z.1 {
                for y in y.0..=y.1 {
                    let (first, last) = (key(self.step, x.0, y, z, level), key(self.step, x.1, y, z, level));
                    let (start, end) = (if first == 0 { 0 } else { self.ends[first as usize - 1] }, self.ends[last as usize]);
                    if first <= last {
                        self.test(mover, start, end, &mut take);
                    } else {
                        // Around the end of the table.
                        self.test(mover, start, self.sorted.len() as u32, &mut take);
                        self.test(mover, 0, end, &mut take);
                    }
                }
            }
        }
    }

    /// The cells of a level that the centre of an overlapping object may be in, along one axis. The slack covers rounding.
    fn around(&self, own: &Aabb, axis: usize, level: u32) -> (i32, i32) {
        let (min, max) = (own.min[axis], own.max[axis]);
        let slack = 0.5005 * cell_size(self.step, level) + 1e-6 * min.abs().max(max.abs());
        (coordinate(self.step, min - slack, level), coordinate(self.step, max + slack, level))
    }

    fn test(&self, mover: u32, start: u32, end: u32, take: &mut impl FnMut(u32)) {
        let own = &self.aabbs[mover as usize];
        for id in &self.sorted[start as usize..end as usize] {
            let other = &self.aabbs[*id as usize];
            let spheres = mover.max(*id) < self.step.spheres;
            if may_meet(own, other) && (!spheres || balls_meet(own, other)) {
                entries(self.step, mover, *id, &mut *take);
            }
        }
    }
}
