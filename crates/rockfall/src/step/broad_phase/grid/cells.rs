//! The grid on the CPU: which cell an object is in, and which objects a mover finds in the cells around it.
//!
//! The grid has levels of cells. The cells of a level are twice as large as those of the level below. An object is in one
//! cell: the cell of its centre on the lowest level, from `least_level` on, whose cells are not smaller than the object. So
//! an object that overlaps an AABB has its centre within half a cell of that AABB, or within half the largest edge on the
//! level. Spheres of all radii, long rods and large boxes are found in a few rows of cells per level. The cells are in a hash
//! table, so that the extent of the scene costs nothing.

use std::ops::Range;

use glam::{IVec3, Vec3, Vec4};

use crate::model::lanes::{LANES, Vec3x4};
use crate::model::layout::{
    CELLS_AT, EDGES_AT, FARTHEST_AT, FEW_STATICS, FLAG_GROUPS, LEVEL_BIAS, LEVELS, LONG_LEVEL, MASK_AT, ROW_LEVEL, ROW_Y,
    ROW_Z, SLICE, TOP_LEVEL,
};
use crate::model::period::Periods;
use crate::model::step::{Aabb, Step};
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::rigid::never_meet;
use crate::step::broad_phase::meet::{entries, may_meet, same_group};

/// The most movers that search the grid together.
const MAX_GROUP: usize = 16;
/// The greatest edge of the hull of the AABBs of such movers, in units of the largest edge of the smallest of these AABBs.
const MAX_HULL_RATIO: f32 = 5.0;

/// Edges of a cell, in units of the cell size of its level. Cells are half as wide along x as along y and z. A row of cells
/// along x is one span of memory, and narrower cells make the ends of the span fit more closely.
const CELL_SHAPE: Vec4 = Vec4::new(0.5, 1.0, 1.0, 1.0);

/// A level of the grid: cells of one size.
#[derive(Clone, Copy, Debug)]
struct Level {
    number: u32,
    size: f32,
    /// Largest edge of the AABBs on this level.
    edge: f32,
    /// Greatest absolute coordinate of a centre on this level.
    farthest: f32,
}

/// Returns the place of a cell in the table. Cells that are neighbours along x are neighbours in the table. Rows are
/// scattered over it.
fn key(step: &Step, x: i32, y: i32, z: i32, level: u32) -> u32 {
    let row =
        (y as u32).wrapping_mul(ROW_Y).wrapping_add((z as u32).wrapping_mul(ROW_Z)).wrapping_add(level.wrapping_mul(ROW_LEVEL));
    row.wrapping_add(x as u32) & (step.layout.cells - 1)
}

/// Returns the place in the table of the cell of an object, the number of the level of the cell, and the largest edge of the object.
pub(crate) fn key_of(step: &Step, aabb: &Aabb) -> (u32, u32, f32) {
    let largest = largest_edge(aabb);
    let mut levels = (step.layout.least_level..TOP_LEVEL).map(|level| Level::new(step, level));
    let level = levels.find(|level| largest <= level.size).unwrap_or(Level::new(step, TOP_LEVEL));
    let [min, max] = [aabb.min, aabb.max].map(|bound| Vec3::from_array(bound).extend(0.0));
    let IVec3 { x, y, z } = level.cell(0.5 * min + 0.5 * max);
    (key(step, x, y, z, level.number), level.number, largest)
}

/// Returns the greatest absolute coordinate of the centre of an AABB.
pub(crate) fn greatest_coordinate(aabb: &Aabb) -> f32 {
    extent(aabb).truncate().abs().max_element()
}

/// Returns whether an object is a box or polygon and these are few. Every mover then tests them one by one, because levels of
/// their own would cost more.
pub(crate) fn is_tested_apart(step: &Step, object: u32) -> bool {
    object >= step.layout.spheres + step.layout.rods && step.layout.boxes + step.layout.polygons <= FEW_STATICS
}

/// Returns whether a mover with this AABB is long: it is on `LONG_LEVEL` or above, so that it has to test hundreds of objects.
pub(crate) fn is_long(step: &Step, aabb: &Aabb) -> bool {
    step.layout.long_at != 0 && largest_edge(aabb) > Level::new(step, LONG_LEVEL - 1).size
}

/// Returns the extent of a sorted object. The sign of its size distinguishes spheres from other objects.
pub(crate) fn sorted_extent(step: &Step, object: u32, aabb: &Aabb) -> Vec4 {
    let extent = extent(aabb);
    if object < step.layout.spheres { extent } else { extent.truncate().extend(-extent.w) }
}

/// Returns the centre and the largest half extent of an AABB. The half extent is slightly enlarged, so that rounding cannot
/// make it too small.
fn extent(aabb: &Aabb) -> Vec4 {
    let (min, max) = (0.5 * Vec3::from_array(aabb.min), 0.5 * Vec3::from_array(aabb.max));
    (min + max).extend(1.000001 * (max - min).max_element())
}

/// The grid with its sorted objects, in which movers find their neighbours.
#[derive(Clone)]
pub(crate) struct Grid<'a> {
    step: &'a Step,
    view: View<'a>,
    aabbs: &'a [Aabb],
    /// Levels that have objects.
    levels: Vec<Level>,
    /// End of every cell among the sorted objects.
    ends: &'a [u32],
    sorted: &'a [u32],
    long_movers: &'a [u32],
    /// Extents of the sorted objects.
    extents: &'a [Vec4],
}

/// The objects that a group of movers close together may meet, and other buffers of a search.
#[derive(Default)]
pub(crate) struct Around {
    /// Start and end of each range of sorted objects to search.
    spans: Vec<(u32, u32)>,
    /// Extents of the spheres.
    extents: Vec<Vec4>,
    /// Ids of the spheres.
    ids: Vec<u32>,
    /// The extents of the spheres in lanes of four: centres and half sizes.
    lanes: Vec<(Vec3x4, Vec4)>,
    /// Ids of the rods, boxes and polygons.
    others: Vec<u32>,
    /// List entries of one mover.
    entries: Vec<u32>,
    /// Number of pairs compared so far.
    tests: u64,
}

impl<'a> Grid<'a> {
    pub(crate) fn new(view: View<'a>, aabbs: &'a [Aabb], cells: &'a [u32], extents: &'a [Vec4]) -> Self {
        let step = view.step;
        let has_objects = |number: &u32| cells[MASK_AT as usize] >> number & 1 == 1;
        let levels = (0..LEVELS).filter(has_objects);
        Self {
            step,
            view,
            aabbs,
            levels: levels.map(|level| Level::new(step, level).with_data(cells)).collect(),
            ends: &cells[CELLS_AT as usize..][..step.layout.cells as usize],
            sorted: &cells[step.layout.sorted_at as usize..][..aabbs.len()],
            long_movers: long_movers(step, cells),
            extents: &extents[..aabbs.len()],
        }
    }

    /// Calls `take` with the entries of each mover of a range, in any order within a list. Lists of long movers are empty.
    /// Movers that are adjacent in memory, and so close in space if memory is ordered, search together.
    pub(crate) fn for_each_list(&self, movers: Range<u32>, around: &mut Around, take: &mut impl FnMut(&mut Vec<u32>)) {
        let aabbs = &self.aabbs[movers.start as usize..movers.end as usize];
        let Some(hull) = aabbs.iter().copied().reduce(hull) else {
            return;
        };
        let smallest = aabbs.iter().map(largest_edge).fold(f32::INFINITY, f32::min);
        let is_narrow = largest_edge(&hull) <= MAX_HULL_RATIO * smallest;
        if aabbs.len() > MAX_GROUP || (aabbs.len() > 1 && !is_narrow) {
            let middle = movers.start + (movers.end - movers.start) / 2;
            self.for_each_list(movers.start..middle, around, take);
            return self.for_each_list(middle..movers.end, around, take);
        }
        around.entries.clear();
        if aabbs.iter().all(|aabb| self.is_long(aabb)) {
            return movers.for_each(|_| take(&mut around.entries));
        }
        self.spans(&hull, &mut around.spans);
        around.gather(self, &hull);
        for (mover, aabb) in movers.zip(aabbs) {
            if self.is_long(aabb) {
                around.entries.clear();
            } else {
                around.find(self, mover);
            }
            take(&mut around.entries);
        }
    }

    /// Returns the long movers, in any order.
    pub(crate) fn long_movers(&self) -> &'a [u32] {
        self.long_movers
    }

    /// Returns whether a mover with this AABB is long.
    pub(crate) fn is_long(&self, aabb: &Aabb) -> bool {
        is_long(self.step, aabb)
    }

    /// Returns the entries of a long mover, in any order.
    pub(crate) fn long_list<'b>(&self, mover: u32, around: &'b mut Around) -> &'b mut [u32] {
        let own = &self.aabbs[mover as usize];
        self.spans(own, &mut around.spans);
        around.gather(self, own);
        around.find(self, mover);
        &mut around.entries
    }

    /// Returns an upper bound of the number of entries of a long mover. If rows of cells share places of the table, an object
    /// counts once for each row in which it is found.
    pub(crate) fn count_long(&self, mover: u32, around: &mut Around) -> u32 {
        let own = &self.aabbs[mover as usize];
        self.rows(own, &mut around.spans);
        around.gather(self, own);
        around.find(self, mover);
        around.entries.iter().filter(|entry| *entry & self.step.entry_id_mask() != mover).count() as u32
    }

    /// Writes the ranges of sorted objects in the cells around an AABB to `spans`. Each object is in one range only.
    fn spans(&self, aabb: &Aabb, spans: &mut Vec<(u32, u32)>) {
        self.rows(aabb, spans);
        spans.sort_unstable();
        let mut done = 0;
        for (start, end) in spans {
            *start = done.max(*start);
            *end = (*end).max(*start);
            done = *end;
        }
    }

    /// Writes the range of sorted objects in every row of cells around an AABB and its images to `spans`. Rows may share places of the
    /// table.
    fn rows(&self, aabb: &Aabb, spans: &mut Vec<(u32, u32)>) {
        spans.clear();
        match Periods::of(self.step) {
            None => self.rows_around(aabb, spans),
            Some(periods) => {
                let images = periods.images().map(|way| aabb.moved(way));
                images
                    .filter(|image| periods.reaches(image, self.largest_edge()))
                    .for_each(|image| self.rows_around(&image, spans));
            }
        }
    }

    /// Largest edge of all objects.
    fn largest_edge(&self) -> f32 {
        self.levels.iter().map(|level| level.edge).fold(0.0, f32::max)
    }

    /// Adds the rows of cells around one AABB to `spans`.
    fn rows_around(&self, aabb: &Aabb, spans: &mut Vec<(u32, u32)>) {
        let all = self.sorted.len() as u32;
        for level in &self.levels {
            let block = level.around(aabb);
            if block.covers_too_much(all, self.step.layout.cells) {
                if level.is_within(aabb) {
                    continue;
                }
                spans.clear();
                return spans.push((0, all));
            }
            let Block { low, high } = block;
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    let (first, last) = (key(self.step, low.x, y, z, level.number), key(self.step, high.x, y, z, level.number));
                    let start = if first == 0 { 0 } else { self.ends[first as usize - 1] };
                    let end = self.ends[last as usize];
                    if first <= last {
                        spans.push((start, end));
                    } else {
                        // The row wraps around the end of the table.
                        spans.extend([(start, all), (0, end)]);
                    }
                }
            }
        }
    }
}

impl Around {
    /// Collects the objects in `spans` that may meet an AABB, judged by their extents.
    fn gather(&mut self, grid: &Grid, aabb: &Aabb) {
        self.others.clear();
        let movers = grid.step.layout.spheres + grid.step.layout.rods;
        if is_tested_apart(grid.step, movers) {
            self.others.extend(movers..grid.aabbs.len() as u32);
        }
        let most: usize = self.spans.iter().map(|(start, end)| (end - start) as usize).sum();
        self.tests += most as u64;
        self.extents.resize(most, Vec4::ZERO);
        self.ids.resize(most, 0);
        let (centre, half) = centre_and_half(aabb);
        let periods = Periods::of(grid.step);
        let mut count = 0;
        for (start, end) in &self.spans {
            let span = *start as usize..*end as usize;
            for (extent, id) in grid.extents[span.clone()].iter().zip(&grid.sorted[span]) {
                if *id >= grid.step.layout.spheres {
                    if !is_tested_apart(grid.step, *id) {
                        self.others.push(*id);
                    }
                    continue;
                }
                // There are no branches here, because processors would often mispredict them. An object without bounds is never
                // apart.
                let mut apart = (*extent - centre).truncate();
                if let Some(periods) = &periods {
                    apart = periods.nearest(apart.as_dvec3()).as_vec3();
                }
                let apart = apart.abs().cmpgt(Vec3::splat(extent.w + half)).any();
                (self.extents[count], self.ids[count]) = (*extent, *id);
                count += usize::from(!apart);
            }
        }
        self.extents.truncate(count);
        self.ids.truncate(count);
        self.lanes.clear();
        let filled = |extents: &[Vec4]| std::array::from_fn(|lane| extents.get(lane).copied().unwrap_or_default());
        self.lanes.extend(self.extents.chunks(LANES).map(|extents| Vec3x4::from_rows(filled(extents))));
    }

    /// Writes the entries of a mover to `entries`.
    fn find(&mut self, grid: &Grid, mover: u32) {
        let Self { ids, lanes, others, entries: found, tests, .. } = self;
        *tests += (ids.len() + others.len()) as u64;
        let own = &grid.aabbs[mover as usize];
        found.clear();
        let is_sphere = mover < grid.step.layout.spheres;
        let periods = Periods::of(grid.step);
        if is_sphere {
            let (centre, half) = centre_and_half(own);
            let (centre, half) = (Vec3x4::splat(centre.truncate()), Vec4::splat(half));
            found.resize(lanes.len() * LANES, 0);
            let mut count = 0;
            for ((centres, halves), ids) in lanes.iter().zip(ids.chunks(LANES)) {
                let (mut d, reach) = (*centres - centre, *halves + half);
                if let Some(periods) = &periods {
                    d = Vec3x4::from_rows(d.to_rows().map(|d| periods.nearest(d.as_dvec3()).as_vec3().extend(0.0))).0;
                }
                let apart = d.dot(d).cmpgt(reach * reach).bitmask();
                for (lane, id) in ids.iter().enumerate() {
                    found[count] = *id;
                    count += usize::from(apart >> lane & 1 == 0);
                }
            }
            found.truncate(count);
            if let Some(own) = found.iter().position(|id| *id == mover) {
                found.swap_remove(own);
            }
            if grid.step.layout.rigid_bodies > 0 {
                found.retain(|id| !never_meet(&grid.view, mover, *id));
            }
            if grid.step.constants.flags & FLAG_GROUPS != 0 {
                found.retain(|id| same_group(own, &grid.aabbs[*id as usize]));
            }
        }
        let spheres: &[u32] = if is_sphere { &[] } else { ids };
        for id in others.iter().chain(spheres) {
            if may_meet(periods.as_ref(), own, &grid.aabbs[*id as usize]) {
                entries(&grid.view, mover, *id, |entry| found.push(entry));
            }
        }
    }
}

/// Returns the long movers of the grid that the lists were built with, in any order.
pub(crate) fn long_movers<'a>(step: &Step, cells: &'a [u32]) -> &'a [u32] {
    let count = if step.layout.long_at == 0 { 0 } else { cells[3].min(step.layout.spheres + step.layout.rods) };
    &cells[step.layout.long_at as usize..][..count as usize]
}

/// Returns the number of pairs of objects that are compared to build the lists of a world whose grid is built.
pub(crate) fn pair_tests(world: &World) -> u64 {
    let grid = Grid::new(View::new(&world.step, &world.topology, &world.states[0]), &world.aabbs, &world.cells, &world.extents);
    let mut around = Around::default();
    for first in (0..world.movers()).step_by(SLICE as usize) {
        grid.for_each_list(first..world.movers().min(first + SLICE), &mut around, &mut |_| {});
    }
    for mover in grid.long_movers() {
        grid.long_list(*mover, &mut around);
    }
    around.tests
}

/// Returns the greatest number of objects in the rows of cells around a mover that is not long.
pub(crate) fn longest_search(world: &World) -> u64 {
    let grid = Grid::new(View::new(&world.step, &world.topology, &world.states[0]), &world.aabbs, &world.cells, &world.extents);
    let mut spans = Vec::new();
    let looked_at = |aabb: &Aabb| {
        grid.rows(aabb, &mut spans);
        spans.iter().map(|(start, end)| u64::from(end - start)).sum()
    };
    let movers = &world.aabbs[..world.movers() as usize];
    let movers = movers.iter().filter(|aabb| !grid.is_long(aabb));
    movers.map(looked_at).max().unwrap_or(0)
}

/// Returns the centre of an AABB, and half its largest edge, enlarged to allow for the rounding of centres.
fn centre_and_half(aabb: &Aabb) -> (Vec4, f32) {
    let extent = extent(aabb);
    (extent, extent.w + 2e-6 * extent.truncate().abs().max_element())
}

fn hull(a: Aabb, b: Aabb) -> Aabb {
    let min = Vec3::from_array(a.min).min(Vec3::from_array(b.min));
    let max = Vec3::from_array(a.max).max(Vec3::from_array(b.max));
    Aabb { min: min.to_array(), max: max.to_array(), ..a }
}

fn largest_edge(aabb: &Aabb) -> f32 {
    (Vec3::from_array(aabb.max) - Vec3::from_array(aabb.min)).max_element()
}

/// A block of cells of one level, from the lowest to the highest along each axis.
struct Block {
    low: IVec3,
    high: IVec3,
}

impl Block {
    /// Returns whether the block has more rows than there are objects, or at least as many cells as the table.
    fn covers_too_much(&self, objects: u32, cells: u32) -> bool {
        let [x, y, z] = [0, 1, 2].map(|axis| f64::from(self.high[axis]) - f64::from(self.low[axis]) + 1.0);
        y * z > f64::from(objects) || x * y * z >= f64::from(cells)
    }
}

impl Level {
    fn new(step: &Step, number: u32) -> Self {
        let size = step.layout.cell_size * 2f32.powi(number as i32 - LEVEL_BIAS as i32);
        Self { number, size, edge: size, farthest: f32::INFINITY }
    }

    /// Adds the data of the level that `count_cells` has written to `cells`.
    fn with_data(self, cells: &[u32]) -> Self {
        let of_level = |first: u32| f32::from_bits(cells[(first + self.number) as usize]);
        Self { edge: of_level(EDGES_AT), farthest: of_level(FARTHEST_AT), ..self }
    }

    /// Returns the cells in which the centre of an overlapping object may lie.
    fn around(&self, aabb: &Aabb) -> Block {
        let [low, high] = self.places_around(aabb);
        Block { low: self.cell(low), high: self.cell(high) }
    }

    /// Returns whether all objects of the level are so near the origin that this AABB cannot overlap them.
    fn is_within(&self, aabb: &Aabb) -> bool {
        let [low, high] = self.places_around(aabb);
        let far = Vec4::splat(self.farthest);
        low.cmpgt(far).any() || high.cmplt(-far).any()
    }

    /// Returns the lowest and the highest place at which the centre of an overlapping object may lie. The slack also covers
    /// rounding.
    fn places_around(&self, aabb: &Aabb) -> [Vec4; 2] {
        let [min, max] = [aabb.min, aabb.max].map(|bound| Vec3::from_array(bound).extend(0.0));
        let slack = 0.5005 * self.edge + 1e-6 * min.abs().max(max.abs());
        [min - slack, max + slack]
    }

    /// Returns the cell of a place. The coordinates are clamped, so that places far out have a cell too. Clamping keeps their
    /// order.
    fn cell(&self, place: Vec4) -> IVec3 {
        if self.number == TOP_LEVEL {
            return IVec3::ZERO;
        }
        let far = Vec4::splat((1 << 30) as f32);
        // This is `f32::floor`, for which not every processor has an instruction.
        let floor = |x: f32| x as i32 - i32::from(x < (x as i32) as f32);
        IVec3::from_array((place / (self.size * CELL_SHAPE)).clamp(-far, far).truncate().to_array().map(floor))
    }
}
