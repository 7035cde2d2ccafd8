//! How many workgroups a stage has.

use crate::model::layout::{CELL_BLOCK, DIGIT_BLOCK, MOST_ACROSS, SIZE_WORDS, WIDE, WORKGROUP};
use crate::model::step::Step;

/// Workgroups that take turns, at most: as many as a large device runs side by side.
const MOST_TURNING: u32 = 1024;

/// The same over listed collisions, each of which is little work.
const MOST_AT_COLLISIONS: u32 = 4096;

/// In smaller scenes one for so many movers, of which few are long.
const MOVERS_A_TURN: u32 = 256;

/// What a stage has a thread for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threads {
    /// A thread per object.
    Objects,
    /// The same in workgroups of [`WIDE`]: where threads have little to do, it is workgroups that take the time.
    WideObjects,
    /// A thread per mover (sphere or rod).
    Movers,
    /// A thread per sphere.
    Spheres,
    /// A thread per sphere, but a workgroup for each of the large ones.
    SharedSpheres,
    /// A thread per mover, but a workgroup for each of the large spheres.
    SharedMovers,
    /// The same in workgroups of [`WIDE`].
    WideSpheres,
    /// A thread per rod.
    Rods,
    /// A workgroup per batch of fixed-length rods.
    Batches,
    /// A workgroup per network of fixed-length rods.
    Networks,
    /// A workgroup per large sphere.
    LargeSpheres,
    /// Workgroups that take turns over the listed collisions, of which the device alone knows how many there are.
    Collisions,
    /// A workgroup per block of the grid's cells.
    Blocks,
    /// A workgroup per block of spheres that are sorted.
    DigitBlocks,
    /// A workgroup per so many movers: they take turns over the long ones, of which the device alone knows how many there are.
    LongMovers,
    /// One workgroup.
    One,
}

impl Threads {
    /// Those of the stages that make lists in large scenes.
    pub const PLANNED: [Self; SIZE_WORDS as usize / 3] = [Self::WideObjects, Self::Blocks, Self::Movers, Self::LongMovers];

    /// Where the size of a dispatch of such a stage stands among [`Buffer::DispatchSizes`], in bytes.
    pub fn size_at(self) -> Option<u64> {
        Self::PLANNED.iter().position(|threads| *threads == self).map(|place| 12 * place as u64)
    }

    /// Workgroups that a stage has in a world of these counts; 0: it has nothing to do.
    pub fn workgroups(self, step: &Step) -> u32 {
        let movers = step.movers();
        match self {
            Self::Objects => step.objects().div_ceil(WORKGROUP),
            Self::WideObjects => step.objects().div_ceil(WIDE),
            Self::Movers => movers.div_ceil(WORKGROUP),
            Self::Spheres => step.spheres.div_ceil(WORKGROUP),
            Self::SharedSpheres => step.large + (step.spheres - step.large).div_ceil(WORKGROUP),
            Self::SharedMovers => step.large + (movers - step.large).div_ceil(WORKGROUP),
            Self::WideSpheres => step.spheres.div_ceil(WIDE),
            Self::Rods => step.rods.div_ceil(WORKGROUP),
            Self::Batches => step.batches,
            Self::Networks => step.networks,
            Self::LargeSpheres => step.large,
            Self::Collisions => step.collision_room.div_ceil(WORKGROUP).min(MOST_AT_COLLISIONS),
            Self::Blocks => step.cells / CELL_BLOCK,
            Self::DigitBlocks => step.spheres.div_ceil(DIGIT_BLOCK),
            Self::LongMovers => movers.div_ceil(MOVERS_A_TURN).min(MOST_TURNING),
            Self::One => 1,
        }
    }
}

/// So many workgroups as rows of nearly the same length, of at most `across`: what is too much in the last one is begun, too.
pub fn rows(workgroups: u32, across: u32) -> [u32; 3] {
    let rows = workgroups.div_ceil(across).max(1);
    [workgroups.div_ceil(rows), rows, 1]
}

/// Workgroups of the dispatches that make lists, in rows that every device allows.
pub(crate) fn sizes(step: &Step) -> Vec<u32> {
    Threads::PLANNED.iter().flat_map(|threads| rows(threads.workgroups(step), MOST_ACROSS)).collect()
}
