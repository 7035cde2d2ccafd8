//! How much data a stage must move at least.

/// How many times a stage must move the data of each kind.
#[derive(Clone, Copy, Debug)]
pub struct Moves {
    /// Rows of 16 bytes per sphere: position and radius, velocity and inverse mass, angular momentum and inverse inertia,
    /// orientation.
    pub rows: u64,
    /// AABBs of spheres, 32 bytes each.
    pub sphere_aabbs: u64,
    /// AABBs of all objects.
    pub aabbs: u64,
    /// Tags of all objects, 4 bytes each.
    pub tags: u64,
    /// Counts of the pair lists, 4 bytes per mover, and slice offsets.
    pub counts: u64,
    /// Entries of the pair lists, 4 bytes each.
    pub entries: u64,
    /// Cells of the grid, 4 bytes each.
    pub cells: u64,
    /// Keys or ids of all objects in the grid, 4 bytes each.
    pub keys: u64,
    /// Extents of all objects, 16 bytes each.
    pub extents: u64,
    /// Records of the rods, 16 bytes each.
    pub rods: u64,
    /// Forces on rods, 64 bytes per rod.
    pub wrenches: u64,
    /// Rates of velocity Verlet, 24 bytes per sphere.
    pub rates: u64,
    /// Rows of 16 bytes per sphere, in scenes whose velocities have residues.
    pub residues: u64,
}

/// Nothing.
pub(crate) const NONE: Moves = Moves {
    rows: 0,
    sphere_aabbs: 0,
    aabbs: 0,
    tags: 0,
    counts: 0,
    entries: 0,
    cells: 0,
    keys: 0,
    extents: 0,
    rods: 0,
    wrenches: 0,
    rates: 0,
    residues: 0,
};

/// Data that every force evaluation reads in addition to the state.
pub(crate) const FORCES: Moves = Moves { counts: 1, entries: 1, wrenches: 1, ..NONE };
