//! The memory that both backends share: plain structs and the offsets of what the buffers hold.
//!
//! Every buffer of the GPU has a host array of the same layout in [`World`](crate::world::World). The WGSL side of
//! these declarations is `wgsl/step.wgsl`; a test reflects it and compares names, offsets, types and sizes.
//!
//! ```text
//! object ids   spheres, then rods, then boxes, then polygons, each in order of addition; spheres may stand in another
//!              order in memory (`users_at`), then a sphere's id is its memory slot
//! movers       spheres and rods: the objects that have a list of pairs
//! state        3 n vec4 for n spheres: n x (position, radius), n x (velocity, inverse mass),
//!              n x (angular momentum, inverse inertia)
//! words        u32: rods, springs, tethers, boxes, polygons, tags, users, slots, batches, ends, adjacency (see the WORDS
//!              constants)
//! lists        u32, in rows of SLICE words: counts (one a mover, padded to whole slices; the top bit is a mark), slice
//!              offsets in rows (one a slice and the end, padded to whole rows), entries
//! row sums     f32, in scenes with rods: one a word of the list entries, of those that collide
//! ```

use bytemuck::{Pod, Zeroable};

mod status;

pub use status::{
    BAD_STAGE_SHIFT, BadStage, LISTS_ASKED, LISTS_MADE, NO_BODY, Status, TELLERS, Told, VOID_COLLISIONS, VOID_COUNT,
    VOID_ESCAPED, VOID_MANY, VOID_NON_FINITE, VOID_PAIRS,
};

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

/// The pass of `run_steps` is `phases << PHASES_SHIFT | LEAPS | order`, the second for symplectic Euler alone: how many phases it
/// runs, and in which order. Collisions and positions take turns, collisions first where the order is 0.
pub const PHASES_SHIFT: u32 = 3;
/// Order of `run_steps`: positions come first.
pub const POSITIONS_FIRST: u32 = 1;
/// Order of `run_steps`: there are no collisions.
pub const POSITIONS_ALONE: u32 = 2;
/// The bits of the order in the pass of `run_steps`.
pub const ORDER_MASK: u32 = 3;
/// Bit of the pass of `run_steps`: symplectic Euler, not RK4.
pub const LEAPS: u32 = 4;

/// Words of the sizes of dispatches that make lists: x, y and z for each of [`Threads::PLANNED`](crate::stage::Threads::PLANNED).
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

/// What a step needs to know: the uniform block `step` of every kernel.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Step {
    /// Gravity's acceleration, G g, in units/s².
    pub gravity: [f32; 3],
    /// Time step in s.
    pub dt: f32,
    /// A contact collides above this times the smaller radius, in 1/s.
    pub activation_threshold: f32,
    /// Coefficient of restitution e.
    pub restitution: f32,
    /// Contact damping Cd in 1/s.
    pub contact_damping: f32,
    /// Contact force Cc in 1/s².
    pub contact_force: f32,
    /// Friction mu.
    pub friction: f32,
    /// Coefficient mu_c of Coulomb friction in contacts; 0: the friction force of the thesis.
    pub coulomb_friction: f32,
    /// Coefficient of Coulomb friction in collisions.
    pub collision_friction: f32,
    /// Magnitude of `gravity`, in units/s².
    pub gravity_size: f32,
    /// How far AABBs are grown for what accelerates within a step, in 0.02 r; 1.05 |v| dt comes on top, and as much of both
    /// for every further step of `lookahead`.
    pub margin_scale: f32,
    /// `FLAG_*` bits.
    pub flags: u32,
    /// Rows that the entries of the pair lists may take.
    pub pair_rows: u32,
    /// Number of spheres.
    pub spheres: u32,
    /// Number of rods.
    pub rods: u32,
    /// Number of boxes.
    pub boxes: u32,
    /// Number of polygons.
    pub polygons: u32,
    /// First word of the rods in `words`.
    pub rods_at: u32,
    /// First word of the springs.
    pub springs_at: u32,
    /// First word of the tethers.
    pub tethers_at: u32,
    /// First word of the outside forces.
    pub forces_at: u32,
    /// First word of the boxes.
    pub boxes_at: u32,
    /// First word of the polygons.
    pub polygons_at: u32,
    /// First word of the tags: group (low 16 bits) and material (high 16 bits) of every object, by id.
    pub tags_at: u32,
    /// First word of the adjacency ranges (two absolute word offsets a sphere: where its words begin and end); 0 when nothing is
    /// attached to any sphere.
    pub adjacency_at: u32,
    /// Number of batches of fixed-length rods.
    pub batches: u32,
    /// First word of the batch table: per batch the absolute offset of: colour count C, C + 1 absolute offsets, rod indices.
    pub batches_at: u32,
    /// First word of the slice offsets in `lists`; the counts are at 0.
    pub slices_at: u32,
    /// First word of the entries in `lists`.
    pub entries_at: u32,
    /// Size of the grid's cells at level [`LEVEL_BIAS`], in units: a little more than most bodies.
    pub cell_size: f32,
    /// The lowest level that objects are on, however small they are.
    pub least_level: u32,
    /// Cells of the grid's table, a power of two and a multiple of [`CELL_BLOCK`].
    pub cells: u32,
    /// First word of the sums of blocks of cells in `cells`; the cells themselves are at [`CELLS_AT`].
    pub sums_at: u32,
    /// First word of the objects' keys in `cells`.
    pub keys_at: u32,
    /// First word of the objects' ids in the order of their keys, in `cells`.
    pub sorted_at: u32,
    /// Steps for which AABBs are grown; the more, the longer lists last, and the longer they are.
    pub lookahead: f32,
    /// First word of the users: the index in order of addition of the sphere in each memory slot; 0: they are the same.
    pub users_at: u32,
    /// First word of the slots: the memory slot of each sphere by its index in order of addition; 0: they are the same.
    pub slots_at: u32,
    /// Steps from one chance of making lists to the next: for so many lists have to last.
    pub list_interval: f32,
    /// Steps, or a part of one, by which AABBs stand ahead of moving spheres.
    pub lead: f32,
    /// First word of the long movers, in `cells`; 0: all lists are made by one thread each, for radii differ little.
    pub long_at: u32,
    /// 1: `plan_lists` decides how many workgroups the stages have that make lists.
    pub planned: u32,
    /// First word of the ends: what rods end in each sphere ([`NO_ROD`], [`SOME_RODS`], or of a capsule's end its rod); 0 without
    /// rods.
    pub ends_at: u32,
    /// The last so many spheres in memory are large: in stages that go through lists a workgroup works on each of them.
    pub large: u32,
    /// Number of networks: connected sets of fixed-length rods that are not rigid capsules.
    pub networks: u32,
    /// First word of the network table: per network the absolute offset of: sphere count, rod count, spheres (as `2 rod + end`, for
    /// a rod that ends in the sphere), rods. Before the table stands one word a rod: its network, or [`NO_NETWORK`].
    pub networks_at: u32,
    /// How collisions are solved ([`SWEEPS_OFF`], [`SWEEPS_LISTED`], [`SWEEPS_ON`]). Results do not depend on it.
    pub sweeps: u32,
    /// Collisions that the buffer of collisions has room for.
    pub collision_room: u32,
    /// Padding to 16 bytes.
    pub pad: [u32; 2],
}

impl Step {
    /// Objects that have a list: spheres and rods.
    pub const fn movers(&self) -> u32 {
        self.spheres + self.rods
    }

    /// All objects.
    pub const fn objects(&self) -> u32 {
        self.movers() + self.boxes + self.polygons
    }

    /// Whether bodies may have long lists: in scenes with rods or large spheres.
    pub const fn has_long_lists(&self) -> bool {
        self.rods > 0 || self.large > 0
    }

    /// [`Step::sweeps`] where no collisions are known to share bodies. Networks are solved by sweeps alone, and friction in collisions
    /// needs to know their impulses.
    pub fn calm_sweeps(&self) -> u32 {
        if self.networks > 0 {
            SWEEPS_ON
        } else if self.has_long_lists() || self.collision_friction > 0.0 {
            SWEEPS_LISTED
        } else {
            SWEEPS_OFF
        }
    }

    /// Whether one workgroup may make all sweeps, where collisions are few.
    pub const fn may_sweep_at_once(&self) -> bool {
        self.networks == 0 && self.large == 0
    }

    /// Whether contacts get friction impulses.
    pub fn has_friction_impulses(&self) -> bool {
        self.coulomb_friction > 0.0 || self.collision_friction > 0.0
    }

    /// The approach velocity, in units/s, above which a contact of this smaller radius collides: erratum E19. Gravity gives a body
    /// at rest up to `|gravity| dt` within a step.
    pub fn collision_velocity(&self, smaller_radius: f32) -> f32 {
        (self.activation_threshold * smaller_radius).max(2.0 * self.gravity_size * self.dt)
    }

    /// Bits of the id in a list entry: 26 in scenes with rods; without there are no features, and all 30.
    pub const fn entry_id_bits(&self) -> u32 {
        if self.rods > 0 { ENTRY_BITS - FEATURE_BITS } else { ENTRY_BITS }
    }

    /// Mask of the id in a list entry.
    pub const fn entry_id_mask(&self) -> u32 {
        (1 << self.entry_id_bits()) - 1
    }
}

/// From so many objects on a key of `find_neighbours` has no room beside an index in order of addition for five bits more.
pub const MANY_OBJECTS: u32 = 1 << 27;

/// The most objects that a scene may have, with rods or without: ids are numbers in list entries, and in the word that tells which
/// body stopped being finite.
pub const fn most_objects(has_rods: bool) -> u32 {
    if has_rods { (1 << (ENTRY_BITS - FEATURE_BITS)) - 1 } else { (1 << BAD_STAGE_SHIFT) - 1 }
}

/// The uniform block `pass_`: which force evaluation of the step this is.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Pass {
    /// 0..4 for the stages of RK4, 0 and 1 for `sort_axis`, 0..8 for the digits of a sort, what [`PHASES_SHIFT`] tells for
    /// `run_steps`; 0 for symplectic Euler and everything else.
    pub index: u32,
    /// Padding to 16 bytes.
    pub pad: [u32; 3],
}

/// An axis-aligned bounding box, grown by the motion of the step.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Aabb {
    /// Least x, y, z.
    pub min: [f32; 3],
    /// The object's id.
    pub id: u32,
    /// Greatest x, y, z.
    pub max: [f32; 3],
    /// The object's tag: group (low 16 bits) and material (high 16 bits).
    pub tag: u32,
}
