//! The buffers that stages bind.

/// A buffer that stages bind. `Start` is the state; `Y2`, `Y3`, `Y4` are the stage states of RK4, and scratch besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Buffer {
    /// The state of all spheres (`World::states[0]`).
    Start,
    /// Stage state 2; where collisions and symplectic Euler put the state before it is committed.
    Y2,
    /// Stage state 3; after the integration: old positions in region 0 and mean spins in region 2.
    Y3,
    /// Stage state 4.
    Y4,
    /// In small scenes without rods: all four side by side, for `run_steps`.
    States,
    /// AABBs of all objects.
    Aabbs,
    /// Rods, springs, tethers, boxes, polygons, tags, users, slots, batches, ends, adjacency.
    Topology,
    /// The grid: levels, cells, sums of blocks, keys, sorted objects.
    Cells,
    /// Per object, in the order of the grid's keys: centre and largest half extent of its AABB, negative of what is no sphere.
    Extents,
    /// The pair lists.
    Lists,
    /// Where collisions are listed, by list entry: the number of the collision in [`Buffer::Collisions`].
    CollisionIndices,
    /// Where collisions are listed: a record of [`COLLISION_WORDS`](crate::model::layout::COLLISION_WORDS) words each.
    Collisions,
    /// Per rod: force and couple on end 1, force and couple on end 2.
    Wrenches,
    /// Unit quaternions (x, y, z, w) of the spheres' orientations.
    Orientations,
    /// In large scenes: workgroups of the dispatches that make lists, as they are in this step, then as they are when there is
    /// something to do.
    DispatchSizes,
    /// The [`Status`](crate::model::status::Status) block.
    Status,
}

impl Buffer {
    /// All buffers.
    pub const ALL: [Self; 16] = [
        Self::Start,
        Self::Y2,
        Self::Y3,
        Self::Y4,
        Self::States,
        Self::Aabbs,
        Self::Topology,
        Self::Cells,
        Self::Extents,
        Self::Lists,
        Self::CollisionIndices,
        Self::Collisions,
        Self::Wrenches,
        Self::Orientations,
        Self::DispatchSizes,
        Self::Status,
    ];

    /// What it holds, in words.
    pub fn label(self) -> &'static str {
        match self {
            Self::Start => "the state",
            Self::Y2 => "stage state 2",
            Self::Y3 => "stage state 3",
            Self::Y4 => "stage state 4",
            Self::States => "the stage states of a small scene",
            Self::Aabbs => "the AABBs",
            Self::Topology => "topology and static objects",
            Self::Cells => "the grid",
            Self::Extents => "the extents of sorted objects",
            Self::Lists => "the pair lists",
            Self::CollisionIndices => "the numbers of listed collisions",
            Self::Collisions => "the listed collisions",
            Self::Wrenches => "the forces on rods",
            Self::Orientations => "the orientations",
            Self::DispatchSizes => "the sizes of dispatches",
            Self::Status => "the status",
        }
    }
}
