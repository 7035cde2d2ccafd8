//! Sizes and offsets of what the buffers hold: the constants that both backends share.

use crate::model::status::BAD_STAGE_SHIFT;

/// Threads in a workgroup of every stage.
pub const WORKGROUP: u32 = 64;
/// The same of stages whose threads have little to do each.
pub const WIDE: u32 = 256;

/// Movers in a slice of the pair lists, and words in a row of them: entry `e` of mover `i` is word `i % SLICE` of row
/// `entries_at / SLICE + slice_offset[i / SLICE] + e`, so that neighbouring threads read neighbouring words.
pub const SLICE: u32 = 32;

/// The most rows that the entries of the pair lists may take: 480 GiB. With the rows of counts and offsets before them they are
/// still numbered in 32 bits.
pub const MAX_PAIR_ROWS: u32 = 15 << 28;

/// Words of so many rows of the pair lists.
pub const fn words_of(rows: u32) -> u64 {
    SLICE as u64 * rows as u64
}

/// Words of a rod: sphere 1, sphere 2, radius, length (`<= 0`: free).
pub const ROD_WORDS: u32 = 4;
/// Words of a spring: sphere A, sphere B, stiffness k, rest length l, damping c.
pub const SPRING_WORDS: u32 = 5;
/// Words of a tether: sphere, the point's x, y, z, stiffness k, rest length l, damping c.
pub const TETHER_WORDS: u32 = 7;
/// Words of an outside force: x, y, z.
pub const FORCE_WORDS: u32 = 3;
/// Words of a box: corner P, edges I, J, K, three floats each.
pub const BOX_WORDS: u32 = 12;
/// Words of a polygon: corner P, edges L, R, three floats each.
pub const POLYGON_WORDS: u32 = 9;

/// An adjacency word is `kind << KIND_SHIFT | index`; a sphere's words are sorted, so its rods come first.
pub const KIND_SHIFT: u32 = 30;
/// Adjacency kind: a rod that ends in the sphere.
pub const KIND_ROD: u32 = 0;
/// What the word of a sphere's end tells: no rod ends in it;
pub const NO_ROD: u32 = u32::MAX;
/// several do, or one that may change its length. Of any other sphere, a capsule's end, it is the number of its only rod.
pub const SOME_RODS: u32 = u32::MAX - 1;
/// The network of a rod that is in none: one of free length, a rigid capsule's, or one between two fixed spheres.
pub const NO_NETWORK: u32 = u32::MAX;
/// Adjacency kind: a spring on the sphere.
pub const KIND_SPRING: u32 = 1;
/// Adjacency kind: a tether on the sphere.
pub const KIND_TETHER: u32 = 2;
/// Adjacency kind: an outside force on the sphere.
pub const KIND_FORCE: u32 = 3;

/// Low bits of a list entry: the id of the other object, and above it the feature.
pub const ENTRY_BITS: u32 = 30;
/// Bits of the feature in a list entry, in scenes with rods (see [`Step::entry_id_bits`]): a rod meets a box in up to
/// [`BOX_FEATURES`] contacts, each an entry of its own; 0 for every other pair.
pub const FEATURE_BITS: u32 = 4;
/// Set in a list entry by `find_collisions`: the pair overlaps.
pub const ENTRY_OVERLAPS: u32 = 1 << 30;
/// Set in a list entry by `find_collisions`: the pair overlaps and closes fast enough to collide.
pub const ENTRY_COLLIDES: u32 = 1 << 31;
/// Entries of a rod-box pair: feature f is edge f, or, where no edge is hit, vertex f for f < 8.
pub const BOX_FEATURES: u32 = 12;

/// In a mover's count of list entries, set by `find_collisions`: some entry of it collides.
pub const LIST_COLLIDES: u32 = 1 << 31;
/// Mask of the number in a mover's count of list entries.
pub const LIST_COUNT_MASK: u32 = LIST_COLLIDES - 1;

/// Bit of [`Step::flags`]: phase 3 (collisions) is on.
pub const FLAG_COLLISIONS: u32 = 1;
/// Bit of [`Step::flags`]: contact damping may pull (the thesis's form).
pub const FLAG_PULL: u32 = 2;
/// Bit of [`Step::flags`]: go on when a body's state stops being finite.
pub const FLAG_CONTINUE: u32 = 4;
/// Bit of [`Step::flags`]: objects are in more than one group.
pub const FLAG_GROUPS: u32 = 8;
/// Bit of [`Step::flags`], in scenes with large spheres: stage states 3 and 4 are those of an RK4 step not long ago, of the same spheres.
pub const FLAG_STAGES: u32 = 16;

/// [`Step::sweeps`]: every sphere works out its collisions itself. The step is void where one shares a body with another.
pub const SWEEPS_OFF: u32 = 0;
/// [`Step::sweeps`]: collisions are listed. The step is void where one shares a body with another.
pub const SWEEPS_LISTED: u32 = 1;
/// [`Step::sweeps`]: collisions are listed, and one workgroup makes all sweeps over those that share bodies. The step is void where there
/// are more than [`FEW_COLLISIONS`], or one has more neighbours than its record has room for.
pub const SWEEPS_FEW: u32 = 2;
/// [`Step::sweeps`]: collisions are listed, and every sweep over those that share bodies is a dispatch.
pub const SWEEPS_ON: u32 = 3;
/// Up to so many collisions one workgroup makes all sweeps faster than a dispatch each.
pub const FEW_COLLISIONS: u32 = 2048;
/// Sweeps over the impulses of collisions that share bodies.
pub const SWEEPS: u32 = 8;
/// Factors of the step sizes of these sweeps, each for two of them (docs/physics.md section 3.7).
pub const SWEEP_SIZES: [f32; 4] = [1.250_98, 2.668_52, 1.816_11, 1.0];
/// Words of a collision in the buffer of collisions.
pub const COLLISION_WORDS: u32 = 48;

/// The pass of `run_steps` is `phases << PHASES_SHIFT | SYMPLECTIC_EULER | order`, the second for symplectic Euler alone: how many phases it
/// runs, and in which order. Collisions and positions take turns, collisions first where the order is 0.
pub const PHASES_SHIFT: u32 = 3;
/// Order of `run_steps`: positions come first.
pub const POSITIONS_FIRST: u32 = 1;
/// Order of `run_steps`: there are no collisions.
pub const POSITIONS_ALONE: u32 = 2;
/// The bits of the order in the pass of `run_steps`.
pub const ORDER_MASK: u32 = 3;
/// Bit of the pass of `run_steps`: symplectic Euler, not RK4.
pub const SYMPLECTIC_EULER: u32 = 4;

/// Words of the sizes of dispatches that make lists: x, y and z for each of [`Threads::PLANNED`](crate::model::dispatch::Threads::PLANNED).
pub const SIZE_WORDS: u32 = 12;
/// From so many objects on the device decides how many workgroups the stages have that make lists.
pub const PLANNED_FROM: u32 = 1 << 22;
/// Workgroups of a dispatch along one dimension that WebGPU promises.
pub const MOST_ACROSS: u32 = 65_535;
/// Words of a line of a device's cache: what neighbouring threads read together begins with one.
pub const LINE: u32 = 32;
/// First word of the largest edges of AABBs in the buffer `cells`: for each level the bits of that of the objects on it, not negative.
pub const EDGES_AT: u32 = LINE;
/// First word, in the buffer `cells`, of how far objects stand from the origin: for each level the bits of the greatest coordinate,
/// without its sign, of a centre on it.
pub const FARTHEST_AT: u32 = EDGES_AT + LINE;
/// First word of the cells in the buffer `cells`; word 0 is a mask of the levels that have objects, word 1 tells
/// whether lists are to be made, word 2 the number of objects that sort-and-skip has put in order, word 3 the number of long
/// movers.
pub const CELLS_AT: u32 = FARTHEST_AT + LINE;
/// Cells that one workgroup sums.
pub const CELL_BLOCK: u32 = 4096;
/// Words that the sum of a block takes, of which the first holds it: the kernels read and write rows of four words.
pub const SUM_WORDS: u32 = 4;
/// Spheres whose keys one workgroup counts and scatters, digit by digit.
pub const DIGIT_BLOCK: u32 = 1024;
/// Values of a digit of a key.
pub const DIGITS: u32 = 16;
/// Binary digits of one.
pub const DIGIT_BITS: u32 = 4;
/// About so many spheres tell how well memory is ordered.
pub const ORDER_SAMPLE: u32 = 1 << 16;
/// Up to so many movers are bound by the dispatches of a device more than by what they do: their lists may be longer.
pub const FEW_MOVERS: u32 = 1 << 15;
/// So many boxes and polygons are tested one by one, by every mover; more have levels of the grid of their own.
pub const FEW_STATICS: u32 = 32;
/// Level of the cells of size `cell_size`; cells of level l are `2^(l - LEVEL_BIAS)` times as large.
pub const LEVEL_BIAS: u32 = 8;
/// Movers on this level of the grid and above are long: their AABB is more than four cells of size `cell_size` wide, so that they
/// look at hundreds of objects, and a workgroup makes the list of each.
pub const LONG_LEVEL: u32 = LEVEL_BIAS + 3;
/// Levels of cells.
pub const LEVELS: u32 = 32;
/// The level of what is too large for every other: all of it is in one cell.
pub const TOP_LEVEL: u32 = LEVELS - 1;
/// A row of cells begins at `y ROW_Y + z ROW_Z + level ROW_LEVEL + x` of the table, modulo its size. Odd numbers that
/// scatter rows evenly, whatever the shape of the scene.
pub const ROW_Y: u32 = 0x9e37_79b1;
/// See [`ROW_Y`].
pub const ROW_Z: u32 = 0x85eb_ca77;
/// See [`ROW_Y`].
pub const ROW_LEVEL: u32 = 0xc2b2_ae3d;

/// From so many objects on a key of `find_neighbours` has no room beside an index in order of addition for five bits more.
pub const MANY_OBJECTS: u32 = 1 << 27;

/// The most objects that a scene may have, with rods or without: ids are numbers in list entries, and in the word that tells which
/// body stopped being finite.
pub const fn most_objects(has_rods: bool) -> u32 {
    if has_rods { (1 << (ENTRY_BITS - FEATURE_BITS)) - 1 } else { (1 << BAD_STAGE_SHIFT) - 1 }
}

/// Bodies that a thread of the CPU backend takes at least: handing over fewer costs more than doing them.
pub(crate) const GRAIN: usize = 64;
