//! The number of workgroups of a stage.

use crate::model::layout::{CELL_BLOCK, DIGIT_BLOCK, WIDE_WORKGROUP, WORKGROUP};
use crate::model::step::Step;

/// Maximum number of workgroups that loop over the long movers: as many as a large device runs at the same time.
const MAX_LONG_MOVER_WORKGROUPS: u32 = 1024;

/// Maximum number of workgroups that loop over the listed collisions, each of which is little work.
const MAX_COLLISION_WORKGROUPS: u32 = 4096;

/// Movers per workgroup that loops over the long movers. Few movers are long.
const MOVERS_PER_WORKGROUP: u32 = 256;

/// The work items of a stage, each of which gets a thread or a workgroup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threads {
    /// A thread per object.
    Objects,
    /// A thread per object, in workgroups of [`WIDE_WORKGROUP`]: where each thread has little to do, launching workgroups takes
    /// most of the time.
    WideObjects,
    /// A thread per mover (sphere or rod).
    Movers,
    /// A thread per sphere.
    Spheres,
    /// A workgroup per large sphere, and a thread per other sphere.
    SharedSpheres,
    /// A workgroup per large sphere, and a thread per other mover.
    SharedMovers,
    /// A thread per sphere, in workgroups of [`WIDE_WORKGROUP`].
    WideSpheres,
    /// A thread per box and polygon.
    Walls,
    /// A workgroup per body with a prescribed motion.
    Motions,
    /// A thread per rod.
    Rods,
    /// A workgroup per batch of fixed-length rods.
    Batches,
    /// A workgroup per network of fixed-length rods.
    Networks,
    /// A workgroup per large sphere.
    Gathered,
    /// Workgroups that loop over the listed collisions. Only the device knows how many collisions there are.
    Collisions,
    /// A workgroup per block of the grid's cells.
    Blocks,
    /// A workgroup per block of spheres, in the sort of memory.
    DigitBlocks,
    /// Workgroups that loop over the long movers. Only the device knows how many long movers there are.
    LongMovers,
    /// A thread per sphere of which other processes have copies.
    Sent,
    /// One workgroup.
    One,
}

impl Threads {
    /// Returns the number of workgroups for the object counts of a world. It is 0 when the stage has nothing to do.
    pub fn workgroups(self, step: &Step) -> u32 {
        let movers = step.movers();
        match self {
            Self::Objects => step.objects().div_ceil(WORKGROUP),
            Self::WideObjects => step.objects().div_ceil(WIDE_WORKGROUP),
            Self::Movers => movers.div_ceil(WORKGROUP),
            Self::Spheres => step.layout.spheres.div_ceil(WORKGROUP),
            Self::SharedSpheres => step.layout.large + (step.layout.spheres - step.layout.large).div_ceil(WORKGROUP),
            Self::SharedMovers => step.layout.large + (movers - step.layout.large).div_ceil(WORKGROUP),
            Self::WideSpheres => step.layout.spheres.div_ceil(WIDE_WORKGROUP),
            Self::Walls => (step.layout.boxes + step.layout.polygons).div_ceil(WORKGROUP),
            Self::Motions => step.layout.bodies,
            Self::Rods => step.layout.rods.div_ceil(WORKGROUP),
            Self::Batches => step.layout.batches,
            Self::Networks => step.layout.networks,
            Self::Gathered => step.layout.large,
            Self::Collisions => step.layout.collision_room.div_ceil(WORKGROUP).min(MAX_COLLISION_WORKGROUPS),
            Self::Blocks => step.layout.cells / CELL_BLOCK,
            Self::DigitBlocks => step.layout.spheres.div_ceil(DIGIT_BLOCK),
            Self::LongMovers => movers.div_ceil(MOVERS_PER_WORKGROUP).min(MAX_LONG_MOVER_WORKGROUPS),
            Self::Sent => step.layout.sent.div_ceil(WORKGROUP),
            Self::One => 1,
        }
    }
}

/// Returns the dispatch size for a number of workgroups, as rows of at most `across` workgroups. All rows are equally long, so
/// a few more workgroups than needed may be launched.
pub fn rows(workgroups: u32, across: u32) -> [u32; 3] {
    let rows = workgroups.div_ceil(across).max(1);
    [workgroups.div_ceil(rows), rows, 1]
}
