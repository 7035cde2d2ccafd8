//! The buffers that stages bind.

/// A buffer that stages bind. `Start` is the state. `Y2`, `Y3` and `Y4` are the stage states of RK4, and also scratch memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Buffer {
    /// The state of all spheres (`World::states[0]`).
    Start,
    /// Stage state 2. Collisions and symplectic Euler write the new state here before it is committed.
    Y2,
    /// Stage state 3. After the integration it holds old positions in region 0 and mean spins in region 2. A region is one
    /// vec4 per sphere; each state has three, and a fourth with the low parts of positions in scenes with double precision.
    Y3,
    /// Stage state 4. Velocity Verlet keeps the new positions and the velocities of the middle of the step here.
    Y4,
    /// AABBs of all objects.
    Aabbs,
    /// Rods, springs, tethers, external forces, boxes, polygons, their motions, tags, pairs of materials, insertion indices, slots, batches,
    /// ends, networks, adjacency.
    Topology,
    /// The grid: levels, cells, block sums, keys, sorted objects, long movers.
    Cells,
    /// Centre and largest half extent of the AABB of every object, in the order of the grid's keys. The half extent is negative
    /// for objects that are not spheres.
    Extents,
    /// The pair lists.
    Lists,
    /// For every list entry, the index of its collision in [`Buffer::Collisions`]. Empty until a step has collisions.
    CollisionIndices,
    /// One record of [`COLLISION_WORDS`](crate::model::layout::COLLISION_WORDS) words per listed collision.
    Collisions,
    /// The loads. Per rod: force and torque on end 1, force and torque on end 2. Then per sphere: force and torque of its contacts and
    /// of what is attached to it. Those of fixed spheres are not computed.
    Wrenches,
    /// Unit quaternions (x, y, z, w) of the spheres' orientations.
    Orientations,
    /// The springs of contacts, for laws with history, in two tables: one with those before the step, one with those after it.
    /// Either has a block of [`HISTORY_BLOCK`](crate::model::layout::HISTORY_BLOCK) records of
    /// [`HISTORY_WORDS`](crate::model::layout::HISTORY_WORDS) words per mover, in insertion order, and a pool of
    /// [`Layout::history_pool`](crate::model::step::Layout::history_pool) blocks for movers with more contacts.
    Histories,
    /// Velocity Verlet: acceleration and torque of every sphere, in insertion order, and of every rigid body, from the last force
    /// evaluation. Each has [`RATE_WORDS`](crate::model::layout::RATE_WORDS) floats. Empty for other integrators.
    Rates,
    /// The poses of bodies with a prescribed motion: for every half step from the step [`Constants::pose_step`](crate::model::step::Constants::pose_step)
    /// on, a record of [`POSE_FLOATS`](crate::model::layout::POSE_FLOATS) for each body.
    Poses,
    /// The state of rigid bodies, and scratch: [`RIGID_ROWS`](crate::model::layout::RIGID_ROWS) vectors for each.
    RigidBodies,
    /// The servos: 4 vectors for each.
    Servos,
    /// What every sphere and rod, in insertion order, contributes to the force and to the stiffness of every servo: 2 floats for each.
    ServoLoads,
    /// The [`Status`](crate::model::status::Status) block.
    Status,
}

impl Buffer {
    /// All buffers.
    pub const ALL: [Self; 20] = [
        Self::Start,
        Self::Y2,
        Self::Y3,
        Self::Y4,
        Self::Aabbs,
        Self::Topology,
        Self::Cells,
        Self::Extents,
        Self::Lists,
        Self::CollisionIndices,
        Self::Collisions,
        Self::Wrenches,
        Self::Orientations,
        Self::Histories,
        Self::Rates,
        Self::Poses,
        Self::RigidBodies,
        Self::Servos,
        Self::ServoLoads,
        Self::Status,
    ];

    /// Describes the contents of the buffer, for messages.
    pub fn label(self) -> &'static str {
        match self {
            Self::Start => "the state",
            Self::Y2 => "stage state 2",
            Self::Y3 => "stage state 3",
            Self::Y4 => "stage state 4",
            Self::Aabbs => "the AABBs",
            Self::Topology => "topology and static objects",
            Self::Cells => "the grid",
            Self::Extents => "the extents of sorted objects",
            Self::Lists => "the pair lists",
            Self::CollisionIndices => "the indices of listed collisions",
            Self::Collisions => "the listed collisions",
            Self::Wrenches => "the loads",
            Self::Orientations => "the orientations",
            Self::Histories => "the springs of contacts",
            Self::Poses => "the poses of moving walls",
            Self::RigidBodies => "the rigid bodies",
            Self::Servos => "the servos",
            Self::ServoLoads => "the loads of servos",
            Self::Rates => "the accelerations of the last force evaluation",
            Self::Status => "the status",
        }
    }
}
