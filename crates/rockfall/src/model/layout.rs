//! Constants that both backends share: sizes and offsets of the records in the buffers, flags and limits.

use crate::model::declare::constants;
use crate::model::status::BAD_STAGE_SHIFT;

constants! {
    /// Threads in a workgroup of most stages.
    pub const WORKGROUP: u32 = 64;
    /// Threads in a workgroup of stages whose threads have little to do.
    pub const WIDE_WORKGROUP: u32 = 256;
    /// Movers in a slice of the pair lists, and words in a row of them. Entry `e` of mover `i` is word `i % SLICE` of row
    /// `entries_at / SLICE + slice_offset[i / SLICE] + e`, so that neighbouring threads read neighbouring words.
    pub const SLICE: u32 = 32;
    /// Words of a rod: sphere 1, sphere 2, radius, length (`<= 0`: free).
    pub const ROD_WORDS: u32 = 4;
    /// Words of a spring: sphere A, sphere B, stiffness k, rest length l, damping c.
    pub const SPRING_WORDS: u32 = 5;
    /// Words of a muscle: amplitude, phase, change of the phase in half a step. Phases have 64 bits, low word first.
    pub const MUSCLE_WORDS: u32 = 5;
    /// Words of a tether: sphere, the point's x, y, z, stiffness k, rest length l, damping c.
    pub const TETHER_WORDS: u32 = 7;
    /// Words of an external force: x, y, z.
    pub const FORCE_WORDS: u32 = 3;
    /// Words of a box: corner P, edges I, J, K, three floats each.
    pub const BOX_WORDS: u32 = 12;
    /// Words of a polygon: corner P, edges L, R, three floats each; 1 for a triangle, 0 for a parallelogram.
    pub const POLYGON_WORDS: u32 = 10;
    /// Words of the motion of a box or polygon: velocity of the corner x, y, z, number of the body (0: the world), angular velocity x, y,
    /// z, padding, acceleration of the corner x, y, z, padding, surface velocity x, y, z, padding.
    pub const WALL_WORDS: u32 = 16;
    /// Floats of the pose of a body: the rows of R - 1, R the rotation from where its shapes are written; a reference point X; its
    /// displacement; its velocity; its acceleration; the angular velocity. Each is a vec4 whose last number is 0.
    pub const POSE_FLOATS: u32 = 32;
    /// Words of a rigid body: centre x, y, z of the state that forces are evaluated in; inverse mass; tensor of the inverse inertia in that
    /// state, xx, yy, zz, xy, xz, yz; greatest inverse moment of inertia; first word of its shape; first word of its members, which are
    /// insertion indices of spheres; their number; orientation in that state x, y, z, w; greatest distance of a point of a sphere from the
    /// centre.
    pub const RIGID_WORDS: u32 = 19;
    /// Words of a box of a shape: half its edges x, y, z, the rotation from its edges to the coordinates of the shape
    /// x, y, z, w. No stage reads them, only the viewer.
    pub const SHAPE_BOX_WORDS: u32 = 7;
    /// Bit of the word of a sphere that stands for a hull. The other bits are the first word of its triangles: their number, then the
    /// corners x, y, z of each from the centre of the sphere. No stage reads them, only the viewer.
    pub const HULL_PART: u32 = 1 << 30;
    /// Words of a shape before the places of its spheres, x, y, z from the centre of mass: 1 / J_m, kappa x, y, z (docs/physics section
    /// 5.9), and the rotation from the principal axes to the coordinates of the shape, x, y, z, w.
    pub const SHAPE_WORDS: u32 = 8;
    /// Body of a sphere that belongs to no rigid body.
    pub const NO_RIGID: u32 = u32::MAX;
    /// Vectors of a rigid body: position, low part of the position, velocity, angular momentum, orientation, and the residues
    /// of velocity and angular momentum. The others are scratch.
    pub const RIGID_ROWS: u32 = 12;
    /// Row of a rigid body with its residues.
    pub const RESIDUE_ROW: u32 = 5;
    /// First row of a rigid body with the state after the drift of velocity Verlet: velocity, angular momentum, orientation,
    /// position and its low part.
    pub const STAGE_ROW: u32 = 7;
    /// Row of a rigid body with the residues after the drift of velocity Verlet.
    pub const DRIFTED_ROW: u32 = 6;
    /// Pass of `move_bodies` after the drift of velocity Verlet.
    pub const AFTER_DRIFT: u32 = 4;
    /// Pass of `move_bodies` after the second half of the kick of velocity Verlet.
    pub const AFTER_KICK: u32 = 5;
    /// Pass of `move_bodies` after a step of symplectic Euler.
    pub const AFTER_EULER: u32 = 6;
    /// Pass of `move_bodies` at the start of a step, in which no body moves.
    pub const BEFORE_STEP: u32 = 7;
    /// An adjacency word is `kind << KIND_SHIFT | index`. The words of a sphere are sorted, so its rods come first.
    pub const KIND_SHIFT: u32 = 30;
    /// Adjacency kind: a rod that ends in the sphere.
    pub const KIND_ROD: u32 = 0;
    /// Value of a sphere's word in the table of ends (see [`Layout::ends_at`](crate::model::step::Layout::ends_at)): no rod ends in
    /// the sphere.
    pub const NO_ROD: u32 = u32::MAX;
    /// Value of a sphere's word in the table of ends: several rods end in the sphere, or one of free length. In all other cases
    /// exactly one rod ends in the sphere, that rod has a fixed length, and the word is the index of the rod.
    pub const SOME_RODS: u32 = u32::MAX - 1;
    /// Network of a rod that belongs to no network: a rod of free length, the rod of a rigid capsule, or a rod between two fixed
    /// spheres.
    pub const NO_NETWORK: u32 = u32::MAX;
    /// Adjacency kind: a spring on the sphere.
    pub const KIND_SPRING: u32 = 1;
    /// Adjacency kind: a tether on the sphere.
    pub const KIND_TETHER: u32 = 2;
    /// Adjacency kind: an external force on the sphere.
    pub const KIND_FORCE: u32 = 3;
    /// Low bits of a list entry that hold the id of the other object and, above it, the feature.
    pub const ENTRY_BITS: u32 = 30;
    /// Bit of a list entry, set by `find_collisions`: the contact is pressed.
    pub const ENTRY_OVERLAPS: u32 = 1 << 30;
    /// Bit of a list entry, set by `find_collisions`: the contact collides, which means that it is pressed and closes fast enough.
    pub const ENTRY_COLLIDES: u32 = 1 << 31;
    /// Number of entries of a rod-box pair. Feature f is edge f, or, where no edge is hit and f < 8, vertex f.
    pub const BOX_FEATURES: u32 = 12;
    /// Bit of the word that holds the length of a mover's list, set by `find_collisions`: some entry of the list collides.
    pub const LIST_COLLIDES: u32 = 1 << 31;
    /// Mask of the length in that word.
    pub const LIST_COUNT_MASK: u32 = LIST_COLLIDES - 1;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): collisions are handled as impulses.
    pub const FLAG_COLLISIONS: u32 = 1;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): contact damping may pull objects together, as in the thesis.
    pub const FLAG_PULL: u32 = 2;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): the simulation continues when a body's state stops being finite.
    pub const FLAG_CONTINUE: u32 = 4;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): objects are in more than one group.
    pub const FLAG_GROUPS: u32 = 8;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): some polygons are triangles.
    pub const FLAG_TRIANGLES: u32 = 16;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): some pair of materials has Coulomb friction.
    pub const FLAG_PAIR_FRICTION: u32 = 32;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): some pair of materials has rolling or twisting friction, and the
    /// contact law has a history.
    pub const FLAG_RESISTANCE: u32 = 64;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): some pair of materials has cohesion, and the contact law has a history.
    pub const FLAG_COHESION: u32 = 128;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): the integrator is velocity Verlet.
    pub const FLAG_VERLET: u32 = 256;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): positions have a low part, in a fourth region of each state.
    pub const FLAG_DOUBLE: u32 = 512;
    /// Part of the largest coordinate of an AABB by which a sphere must be inside it. It covers the rounding of this test (4 units of
    /// 2^-24), the low part of a position, which the test leaves out (1 unit), and the rounding of overlaps.
    pub const ROUNDING_SLACK: f32 = 4e-7;
    /// Part of its largest coordinate by which an AABB is larger. It exceeds the slack by more than the rounding of AABBs and of the test
    /// (9 units), so that a sphere at rest is inside.
    pub const ROUNDING_MARGIN: f32 = 1e-6;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): contacts that begin and end within a step are handled.
    pub const FLAG_CONTINUOUS: u32 = 1024;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): the integrator is symplectic Euler, so that velocities are half a step
    /// behind positions. `synchronise` keeps those at the time of the positions in a fifth region of `Start`.
    pub const FLAG_HALF_STEP: u32 = 2048;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): the scene is periodic along some axis.
    pub const FLAG_PERIODIC: u32 = 4096;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): some polygons are smooth walls.
    pub const FLAG_SMOOTH: u32 = 8192;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): velocities have residues (docs/physics section 5.10).
    pub const FLAG_RESIDUES: u32 = 16_384;
    /// Region of a state with the residues of velocity and angular momentum. In the stage states of RK4, the increments of the velocity
    /// so far; those of the angular momentum follow.
    pub const RESIDUE_REGION: u32 = 5;
    /// Bit of [`Constants::flags`](crate::model::step::Constants::flags): the images of a periodic scene slide along the box.
    pub const FLAG_SHEARED: u32 = 32_768;
    /// Surface of a polygon: a parallelogram. The numbers are the places in `Surface::ALL`.
    pub const SURFACE_PARALLELOGRAM: u32 = 0;
    /// Surface of a polygon: a triangle.
    pub const SURFACE_TRIANGLE: u32 = 1;
    /// Surface of a polygon: a plane.
    pub const SURFACE_PLANE: u32 = 2;
    /// Surface of a polygon: a cone that is touched from outside. The next number is that of one that is touched from inside.
    pub const SURFACE_CONE: u32 = 3;
    /// Surface of a polygon: a ball that is touched from outside. The next number is that of one that is touched from inside.
    pub const SURFACE_BALL: u32 = 5;
    /// A sphere whose way in a step is longer than this, in radii, may pass a wall (docs/physics section 2.20).
    pub const FAST_WAY: f32 = 0.25;
    /// Overlap, in radii, from which the centre of a slower sphere may be near a wall.
    pub const DEEP_OVERLAP: f32 = 0.5;
    /// How far the place at which a centre passes the plane of a polygon may be outside of its outline, as a share of its edges, so that no
    /// seam has a gap.
    pub const OUTLINE_SLACK: f32 = 1e-4;
    /// Half the edge of the bounding box of a plane, in units.
    pub const UNBOUNDED: f32 = 1e15;
    /// Words of the rates of a sphere: acceleration x, y, z, torque x, y, z.
    pub const RATE_WORDS: u32 = 6;
    /// Shift of the material in a tag.
    pub const MATERIAL_SHIFT: u32 = 16;
    /// Mask of the group in a tag.
    pub const GROUP_MASK: u32 = (1 << MATERIAL_SHIFT) - 1;
    /// Words of a pair of materials in the topology buffer: restitution, strength of the square-root friction, coefficient of
    /// Coulomb friction in contacts, the same in collisions. A negative number stands for the constant of the scene. Then, for laws
    /// with history: normal constant, tangential constant, damping, coefficient of friction; coefficient of rolling friction, ratio of
    /// rolling damping (negative for the model of constant torque), coefficient of twisting friction, cohesion
    /// (DMT: pull-off force per R*; JKR: -(pi gamma / (4 E*))^(1/3)).
    pub const PAIR_WORDS: u32 = 12;
    /// Value of [`Layout::law`](crate::model::step::Layout::law): the law of the thesis.
    pub const LAW_THESIS: u32 = 0;
    /// Words of the spring of a contact: displacement x, y, z, overlap, moment x, y, z, key.
    pub const HISTORY_WORDS: u32 = 8;
    /// Records of a block of springs. A mover has one block of its own, and chains further ones from a pool.
    pub const HISTORY_BLOCK: u32 = 4;
    /// Key of a record without a contact. It ends a chain of blocks.
    pub const NO_KEY: u32 = u32::MAX;
    /// Bit of the key of a record that links to a block. The other bits are the number of that block. [`NO_KEY`] has this bit, too, so
    /// it is tested first. Keys of springs have at most [`ENTRY_BITS`] bits.
    pub const LINK_KEY: u32 = 1 << 31;
    /// Value of [`Constants::sweeps`](crate::model::step::Constants::sweeps): no sweeps. The step is rejected when a collision shares a body with
    /// another.
    pub const SWEEPS_LISTED: u32 = 0;
    /// Value of [`Constants::sweeps`](crate::model::step::Constants::sweeps): one workgroup does all sweeps over collisions that share bodies. The step is rejected when there are more than [`FEW_COLLISIONS`] collisions, or when one has
    /// more neighbours than its record has room for.
    pub const SWEEPS_FEW: u32 = 1;
    /// Value of [`Constants::sweeps`](crate::model::step::Constants::sweeps): every sweep over collisions that share bodies is a dispatch.
    pub const SWEEPS_ON: u32 = 2;
    /// Up to this number of collisions, one workgroup does all sweeps faster than one dispatch per sweep does.
    pub const FEW_COLLISIONS: u32 = 2048;
    /// Pass of `constrain` before the integration.
    pub const RESTORING: u32 = 4;
    /// Added to the number of a pass that computes only the spheres of which other processes have copies (docs/cluster.md).
    pub const EARLY: u32 = 64;
    /// Number of sweeps over the impulses of collisions that share bodies.
    pub const SWEEPS: u32 = 8;
    /// Factors omega of the sweeps (docs/physics section 3.7). Each applies to two sweeps.
    pub const SWEEP_SIZES: [f32; 4] = [1.250_98, 2.668_52, 1.816_11, 1.0];
    /// Words of a collision in the buffer `collisions`.
    pub const COLLISION_WORDS: u32 = 48;
    /// The pass index of `run_worlds` is `steps << STEPS_SHIFT`, with the bit [`SYMPLECTIC_EULER`] for symplectic Euler.
    pub const STEPS_SHIFT: u32 = 1;
    /// Bit of the pass index of `run_worlds`: symplectic Euler instead of RK4.
    pub const SYMPLECTIC_EULER: u32 = 1;
    /// Words of a cache line of a device. Arrays that neighbouring threads read together start at a multiple of it.
    pub const LINE: u32 = 32;
    /// First word, in the buffer `cells`, of the largest AABB edge on each level of the grid. It is stored as the bits of a float
    /// that is not negative.
    pub const EDGES_AT: u32 = LINE;
    /// First word, in the buffer `cells`, of the greatest absolute coordinate of the AABB centres on each level of the grid, stored
    /// as the bits of a float.
    pub const FARTHEST_AT: u32 = EDGES_AT + LINE;
    /// First word of the cells in the buffer `cells`. Word 1 of the buffer is not 0 when lists are to be rebuilt. Word 2 is the number of
    /// objects that sort-and-skip has put in order. Word 3 is the number of long movers.
    pub const CELLS_AT: u32 = FARTHEST_AT + LINE;
    /// Word, in the buffer `cells`, of the mask of the levels that have objects.
    pub const MASK_AT: u32 = 4;
    /// Number of cells that one workgroup sums.
    pub const CELL_BLOCK: u32 = 4096;
    /// Words of the sum of a block. The first word holds the sum; the others pad it to a row of four words, which the kernels read
    /// and write at once.
    pub const SUM_WORDS: u32 = 4;
    /// Number of spheres whose keys one workgroup counts and scatters, digit by digit.
    pub const DIGIT_BLOCK: u32 = 1024;
    /// Number of values of a digit of a sort key.
    pub const DIGITS: u32 = 16;
    /// Bits of a digit of a sort key.
    pub const DIGIT_BITS: u32 = 4;
    /// Approximate number of spheres in the sample that measures the order of memory.
    pub const ORDER_SAMPLE: u32 = 1 << 16;
    /// Up to this number of boxes and polygons, every mover tests each of them, because additional grid levels for them would cost
    /// more. If there are more, they are stored in the grid.
    pub const FEW_STATICS: u32 = 32;
    /// Level of the cells of size `cell_size`. Cells of level l are `2^(l - LEVEL_BIAS)` times as large.
    pub const LEVEL_BIAS: u32 = 8;
    /// Movers on this level of the grid and above are long: their AABB is more than four cells of size `cell_size` wide. They test
    /// hundreds of objects, so a workgroup builds the list of each.
    pub const LONG_LEVEL: u32 = LEVEL_BIAS + 3;
    /// Number of levels of the grid.
    pub const LEVELS: u32 = 32;
    /// Level of objects that are too large for all other levels. All of them are in one cell.
    pub const TOP_LEVEL: u32 = LEVELS - 1;
    /// A row of cells starts at `y ROW_Y + z ROW_Z + level ROW_LEVEL + x` of the table, modulo the table size. The factors are odd
    /// numbers that scatter the rows evenly for any shape of the scene.
    pub const ROW_Y: u32 = 0x9e37_79b1;
    /// See [`ROW_Y`].
    pub const ROW_Z: u32 = 0x85eb_ca77;
    /// See [`ROW_Y`].
    pub const ROW_LEVEL: u32 = 0xc2b2_ae3d;
}

/// Maximum number of rows of list entries: 480 GiB. Together with the rows of counts and offsets before them, the row numbers
/// still fit 32 bits.
pub const MAX_PAIR_ROWS: u32 = 15 << 28;
/// Words of list entries that every scene may have: 64 MiB.
const LEAST_PAIR_WORDS: u64 = 1 << 24;
/// Words of list entries for each mover that larger scenes may have: 4 KiB.
const PAIR_WORDS_A_MOVER: u64 = 1024;
/// Collisions that every scene may have. Their records take 192 MiB.
const LEAST_COLLISIONS: u32 = 1 << 20;
/// Collisions for each mover that larger scenes may have. Their records take 6 KiB.
const COLLISIONS_A_MOVER: u32 = 32;

/// Limit on the rows of list entries of a scene. Only thousands of bodies in one place need more. Their number grows with the square
/// of the bodies, so a short scene could take all memory.
pub fn most_pair_rows(movers: u32) -> u32 {
    let words = LEAST_PAIR_WORDS.max(PAIR_WORDS_A_MOVER * u64::from(movers));
    u32::try_from(words / u64::from(SLICE)).unwrap_or(u32::MAX).min(MAX_PAIR_ROWS)
}

/// Limit on the collisions of a step, for the same reason.
pub fn most_collisions(movers: u32) -> u32 {
    LEAST_COLLISIONS.max(COLLISIONS_A_MOVER.saturating_mul(movers))
}

/// Returns the number of words in `rows` rows of the pair lists.
pub const fn words_of_rows(rows: u32) -> u64 {
    SLICE as u64 * rows as u64
}

/// Bit of [`Constants::flags`](crate::model::step::Constants::flags) that no kernel reads: walls follow servos.
pub(crate) const FLAG_SERVOS: u32 = 1 << 16;
/// Vectors of the record of a servo.
pub(crate) const SERVO_ROWS: u32 = 4;
/// Partial sums of the forces that a servo exerts, a thread each.
pub(crate) const SERVO_SUMS: u32 = 256;
/// Pass of `drive_servos` at the end of a step. Pass 0 is at its start.
pub(crate) const SERVO_END: u32 = 1;

/// Place of the number of the body in the record of a moving wall.
pub(crate) const WALL_BODY: usize = 3;
/// First word of the surface velocity in the motion of a box or polygon.
pub(crate) const WALL_SURFACE: usize = 12;

/// Place of the rest length in the record of a spring.
#[cfg(not(target_family = "wasm"))]
pub(crate) const LENGTH_WORD: usize = 3;

/// Bits of the feature in a list entry, in scenes with rods (see
/// [`Step::entry_id_bits`](crate::model::step::Step::entry_id_bits)). A rod has up to [`BOX_FEATURES`] contacts with a box,
/// each with a list entry of its own. The feature is 0 for every
/// other pair.
pub const FEATURE_BITS: u32 = 4;

/// Maximum number of blocks in a table of springs. The vectors of both tables are then numbered by 32 bits.
pub const MAX_HISTORY_BLOCKS: u32 = 1 << 28;

/// Up to this number of movers, a step takes more time for dispatches than for the work of its threads. Lists may then be
/// longer.
pub const FEW_MOVERS: u32 = 1 << 15;

/// From this number of objects on, a 32-bit key of `find_neighbours` has no room for five bits beside the insertion index. The
/// five bits are the place of an object among the 32 objects that are sorted at once.
pub const MANY_OBJECTS: u32 = 1 << 27;

/// Returns the maximum number of objects in a scene. With rods, ids must fit a list entry beside the feature. Without rods,
/// they must fit the word that records the first body whose state is not finite.
pub const fn max_objects(has_rods: bool) -> u32 {
    if has_rods { (1 << (ENTRY_BITS - FEATURE_BITS)) - 1 } else { (1 << BAD_STAGE_SHIFT) - 1 }
}

/// Minimum number of bodies per task on the CPU: distributing fewer bodies costs more than computing them.
pub(crate) const GRAIN: usize = 64;
