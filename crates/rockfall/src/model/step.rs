//! The uniform blocks of every kernel, and the AABB of an object.

use std::mem::{offset_of, size_of};

use bytemuck::{Pod, Zeroable, bytes_of, bytes_of_mut};

use crate::model::layout::{ENTRY_BITS, FEATURE_BITS, SWEEPS_LISTED, SWEEPS_OFF, SWEEPS_ON};

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
    /// Linear damping C in 1/s: v' = -C v.
    pub linear_damping: f32,
    /// Angular damping C in 1/s: L' = -C L.
    pub angular_damping: f32,
    /// How far AABBs are grown for what accelerates within a step, in 0.02 r; 1.05 |v| dt comes on top, and as much of both
    /// for every further step of `lookahead`.
    pub margin_scale: f32,
    /// Steps for which AABBs are grown; the more, the longer lists last, and the longer they are.
    pub lookahead: f32,
    /// Steps from one chance of making lists to the next: for so many lists have to last.
    pub list_interval: f32,
    /// Steps, or a part of one, by which AABBs stand ahead of moving spheres.
    pub lead: f32,
    /// How collisions are solved ([`SWEEPS_OFF`], [`SWEEPS_LISTED`], [`SWEEPS_ON`]). Results do not depend on it.
    pub sweeps: u32,
    /// `FLAG_*` bits. The last of the fields that change while the world stays as it is: see [`Step::with_constants_of`].
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
    /// First word of the users: the index in order of addition of the sphere in each memory slot; 0: they are the same.
    pub insertion_indices_at: u32,
    /// First word of the slots: the memory slot of each sphere by its index in order of addition; 0: they are the same.
    pub slots_at: u32,
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
    /// Collisions that the buffer of collisions has room for.
    pub collision_room: u32,
}

impl Step {
    /// This with the constants of another: the fields up to `flags`. Counts, offsets and room stay.
    pub fn with_constants_of(&self, other: &Self) -> Self {
        const END: usize = offset_of!(Step, flags) + size_of::<u32>();
        let mut step = *self;
        bytes_of_mut(&mut step)[..END].copy_from_slice(&bytes_of(other)[..END]);
        step
    }

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
