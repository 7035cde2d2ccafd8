//! The uniform blocks of every kernel, and the AABB of an object.

use std::mem::offset_of;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::model::declare::block;
use crate::model::layout::{
    ENTRY_BITS, FEATURE_BITS, FLAG_DOUBLE, FLAG_HALF_STEP, FLAG_RESIDUES, FLAG_VERLET, RESIDUE_REGION, SPRING_WORDS,
};
use crate::settings::{Settings, constant_table};

/// Declares [`Constants`], with a field for every constant of the table that kernels read.
macro_rules! step_block {
    (
        kernel { $($(#[doc = $doc:literal])+ $constant:ident: $read:ident = $default:expr, $unit:literal, $slider:expr;)+ }
        host $host:tt
    ) => {
block! {
    /// What the settings, the integrator and the clock give. `World` writes it in `model/world/constants.rs` alone.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
    pub struct Constants {
        /// Acceleration by gravity, G g, in units/s².
        pub gravity: [f32; 3],
        /// Time step in s.
        pub dt: f32,
        $($(#[doc = $doc])+ pub $constant: f32,)+
        /// Magnitude of `gravity`, in units/s².
        pub gravity_size: f32,
        /// Cosine of the greatest angle between the normals of two triangles that a sphere touches as one.
        pub mesh_cosine: f32,
        /// Steps since the base of the muscles' phases when the counter of steps in the status was 0.
        pub muscle_step: u32,
        /// Time of the simulation at that base, in s.
        pub time_base: f32,
        /// Value of `steps` in the status to which the first row of the poses of bodies and the displacement of the box above belong.
        pub pose_step: u32,
        /// Number of rows of that table.
        pub pose_rows: u32,
        /// Displacement of the box above in a sheared scene, in units of 2^-64 periods: the low word. At the step `pose_step`; on the CPU
        /// at the time of a stage while it runs.
        pub shear_low: u32,
        /// The high word.
        pub shear_high: u32,
        /// Change of that displacement in half a step: the low word.
        pub shear_change_low: u32,
        /// The high word.
        pub shear_change_high: u32,
        /// How collisions are solved: one of the `SWEEPS_*` constants. Results do not depend on it.
        pub sweeps: u32,
        /// `FLAG_*` bits.
        pub flags: u32,
    }
}

impl Constants {
    /// Copies the constants that kernels read under the same name.
    pub fn set_constants(&mut self, settings: &Settings) {
        $(self.$constant = settings.$constant;)+
    }
}
    };
}

constant_table!(step_block);

block! {
    /// How lists are built. Results do not depend on it. `simulation/lists.rs` alone writes it.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
    pub struct ListSettings {
        /// Margin of AABBs for accelerations in the first step, in units of 0.02 r. The margin also includes 1.05 |v| dt per
        /// step, and 0.05 r for every further step of `lookahead`. `update_aabbs` has the whole formula.
        pub margin_scale: f32,
        /// Number of steps for which AABBs are grown. With more steps, lists are valid for longer but have more entries.
        pub lookahead: f32,
        /// Number of steps from one opportunity to rebuild lists to the next. Lists must last for as many steps.
        pub list_interval: f32,
        /// Distance by which the centres of AABBs are ahead of moving spheres, in steps of motion at their present velocity.
        pub lead: f32,
    }
}

block! {
    /// The numbers of objects, the sizes and offsets of arrays, and what a scene is packed for. `World` writes it where it packs a
    /// scene or sizes its arrays, in `model/world` alone.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
    pub struct Layout {
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
        /// First word of the rods in `topology`.
        pub rods_at: u32,
        /// First word of the springs.
        pub springs_at: u32,
        /// First word of the muscles: one record per spring, 0 when no spring has a muscle.
        pub muscles_at: u32,
        /// First word of the parameters of the force laws that the program gave.
        pub laws_at: u32,
        /// First word of the tethers.
        pub tethers_at: u32,
        /// First word of the external forces.
        pub forces_at: u32,
        /// First word of the boxes.
        pub boxes_at: u32,
        /// First word of the polygons.
        pub polygons_at: u32,
        /// First word of the motions of boxes and polygons, one record of [`WALL_WORDS`](crate::model::layout::WALL_WORDS) each, followed by
        /// the boxes and polygons as they are written; 0 when none of them moves.
        pub walls_at: u32,
        /// Number of bodies with a prescribed motion.
        pub bodies: u32,
        /// Number of rigid bodies.
        pub rigid_bodies: u32,
        /// First word of the rigid bodies, [`RIGID_WORDS`](crate::model::layout::RIGID_WORDS) each.
        pub rigid_at: u32,
        /// First word of the numbers of the rigid bodies of spheres, by insertion index;
        /// [`NO_RIGID`](crate::model::layout::NO_RIGID) for a sphere of its own.
        pub rigid_of_at: u32,
        /// First word of the boxes and hulls that spheres stand for, by insertion index; 0 if no rigid body has one.
        /// A word is 0 for a sphere that stands for none, otherwise the first word of the box, or that of the hull with
        /// [`HULL_PART`](crate::model::layout::HULL_PART). No stage reads them, only the viewer.
        pub rigid_parts_at: u32,
        /// First word of the tags: group (low 16 bits) and material (high 16 bits) of every object, by id.
        pub tags_at: u32,
        /// First word of the adjacency ranges; 0 when nothing is attached to any sphere. The range of a sphere is two absolute
        /// word offsets: the start and the end of its adjacency words.
        pub adjacency_at: u32,
        /// Number of batches of fixed-length rods.
        pub batches: u32,
        /// First word of the batch table, which holds the absolute offset of each batch. A batch consists of the number of
        /// colours C, C + 1 absolute offsets, and rod indices.
        pub batches_at: u32,
        /// First word of the slice offsets in `lists`; the counts are at 0.
        pub slices_at: u32,
        /// First word of the entries in `lists`.
        pub entries_at: u32,
        /// Size of the grid's cells at level [`LEVEL_BIAS`](crate::model::layout::LEVEL_BIAS), in units. It is a little more
        /// than the size of most bodies.
        pub cell_size: f32,
        /// The smallest radius of a sphere, in units.
        pub least_radius: f32,
        /// Lowest level of the grid that objects are put on, however small they are.
        pub least_level: u32,
        /// Cells of the grid's table, a power of two and a multiple of [`CELL_BLOCK`](crate::model::layout::CELL_BLOCK).
        pub cells: u32,
        /// First word of the block sums in `cells`. The cells themselves start at [`CELLS_AT`](crate::model::layout::CELLS_AT).
        pub sums_at: u32,
        /// First word of the objects' keys in `cells`.
        pub keys_at: u32,
        /// First word of the objects' ids in the order of their keys, in `cells`.
        pub sorted_at: u32,
        /// First word of the insertion indices, one per memory slot of a sphere; 0 when slots and insertion indices are the
        /// same.
        pub insertion_indices_at: u32,
        /// First word of the slots: the memory slot of each sphere, by its insertion index; 0 when they are the same.
        pub slots_at: u32,
        /// First word of the bits that say which spheres belong to this process, by insertion index, 32 per word; 0 where all do.
        pub own_at: u32,
        /// Number of spheres that passes with [`EARLY`](crate::model::layout::EARLY) compute; 0 where the scene is not shared, and on the
        /// CPU.
        pub sent: u32,
        /// First word of their insertion indices.
        pub sent_at: u32,
        /// First word of the long movers in `cells`; 0 when radii differ so little that one thread builds each list.
        pub long_at: u32,
        /// First word of the table of ends, one word per sphere: [`NO_ROD`](crate::model::layout::NO_ROD),
        /// [`SOME_RODS`](crate::model::layout::SOME_RODS), or the index of its only rod, if that has a fixed length. 0
        /// without rods.
        pub ends_at: u32,
        /// Number of large spheres. They are the last ones in memory. In stages that process lists, each of them has a
        /// workgroup.
        pub large: u32,
        /// Number of networks: connected sets of fixed-length rods that are not rigid capsules.
        pub networks: u32,
        /// First word of the network table, which holds the absolute offset of each network. A network consists of the number
        /// of spheres, the number of rods, the spheres (as `2 rod + end`, for a rod that ends in the sphere), and the rods.
        /// Before the table there is one word per rod: its network, or [`NO_NETWORK`](crate::model::layout::NO_NETWORK).
        pub networks_at: u32,
        /// Number of collisions that the buffer `collisions` has room for.
        pub collision_room: u32,
        /// Number of rows and columns of the table of pairs: the number of materials plus 1, because row and column 0 are those
        /// of objects without a material. 0 when no properties of pairs are given.
        pub materials: u32,
        /// The contact law, one of the `LAW_*` constants.
        pub law: u32,
        /// Blocks of the pool in either table of the springs of contacts.
        pub history_pool: u32,
        /// JKR cohesion: distance up to which contacts persist when their objects are apart, as a fraction of the radius of any
        /// of them. AABBs of spheres and rods grow by as much. 0 in scenes without it.
        pub neck: f32,
        /// First word of the sizes of the accelerations of spheres by everything but contacts, one f32 per sphere; 0 where it is that
        /// of gravity for all of them.
        pub free_at: u32,
        /// First word of the table of pairs, which has [`PAIR_WORDS`](crate::model::layout::PAIR_WORDS) words per pair.
        pub pairs_at: u32,
        /// Period along x, in units; 0 where the scene is not periodic.
        pub period_x: f32,
        /// Period along y.
        pub period_y: f32,
        /// Period along z.
        pub period_z: f32,
        /// Least x of the box of a periodic scene. AABBs are brought back so that their centres are in the box.
        pub from_x: f32,
        /// Least y of the box.
        pub from_y: f32,
        /// Least z of the box.
        pub from_z: f32,
        /// Velocity of the box above in a sheared scene, in units/s.
        pub shear_speed: f32,
        /// The axis along which the velocity of the flow changes (0 for x, 1 for y, 2 for z), and 4 times that of the flow.
        pub shear_axes: u32,
    }
}

/// The parameters of a step: the uniform block `step` of every kernel, which has the fields of all three parts in a row.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Step {
    /// What the settings, the integrator and the clock give.
    pub constants: Constants,
    /// How lists are built.
    pub lists: ListSettings,
    /// The numbers of objects, the sizes and offsets of arrays.
    pub layout: Layout,
}

impl Aabb {
    /// The centre.
    pub(crate) fn centre(&self) -> Vec3 {
        0.5 * Vec3::from_array(self.min) + 0.5 * Vec3::from_array(self.max)
    }

    /// The AABB, displaced.
    pub(crate) fn moved(self, by: Vec3) -> Self {
        let moved = |place: [f32; 3]| (Vec3::from_array(place) + by).to_array();
        Self { min: moved(self.min), max: moved(self.max), ..self }
    }
}

impl ListSettings {
    /// The settings before the first step: lists for one step, built in every step.
    pub const FIRST: Self = Self { margin_scale: 2.0, lookahead: 1.0, list_interval: 1.0, lead: 0.0 };
}

impl Step {
    /// Name, offset and size of every field, in bytes.
    pub fn fields() -> impl Iterator<Item = (&'static str, usize, usize)> {
        let parts = [
            (offset_of!(Step, constants), Constants::FIELDS),
            (offset_of!(Step, lists), ListSettings::FIELDS),
            (offset_of!(Step, layout), Layout::FIELDS),
        ];
        parts.into_iter().flat_map(|(at, fields)| fields.iter().map(move |(name, offset, size)| (*name, at + offset, *size)))
    }

    /// The fields in the declaration for kernels.
    pub(crate) fn wgsl_fields() -> String {
        [Constants::WGSL_FIELDS, ListSettings::WGSL_FIELDS, Layout::WGSL_FIELDS].concat()
    }

    /// Number of objects that have a list: spheres and rods.
    pub const fn movers(&self) -> u32 {
        self.layout.spheres + self.layout.rods
    }

    /// Number of blocks in either table of the springs of contacts: one per mover, and the pool.
    pub const fn history_table_blocks(&self) -> u32 {
        self.movers() + self.layout.history_pool
    }

    /// Number of all objects.
    pub const fn objects(&self) -> u32 {
        self.movers() + self.layout.boxes + self.layout.polygons
    }

    /// The pass of the force evaluation that counts contacts and advances their springs: the first one, or, for velocity Verlet,
    /// that at the end of the step.
    pub(crate) fn counted_pass(&self) -> u32 {
        if self.constants.flags & FLAG_VERLET == 0 { 0 } else { 3 }
    }

    /// Whether geometry uses the low parts of positions (docs/physics section 5.8).
    pub const fn is_double(&self) -> bool {
        self.constants.flags & FLAG_DOUBLE != 0
    }

    /// Number of regions of a state: position and radius, velocity and inverse mass, angular momentum and inverse inertia, and the
    /// low part of the position. A region is one vec4 per sphere. `Y4` has low parts only where they are read: with velocity Verlet
    /// and with double precision.
    /// With symplectic Euler, `Start` and `Y2` have a fifth region: the velocity at the time of the positions and inverse mass.
    /// With residues, there are further regions from [`RESIDUE_REGION`] on: in all states with RK4, in `Start`, `Y3`, which sorts memory,
    /// and with velocity Verlet in `Y4`.
    pub const fn state_regions(&self, state: usize) -> u32 {
        let is_verlet = self.constants.flags & FLAG_VERLET != 0;
        let is_rk4 = !is_verlet && !self.is_half_step();
        match state {
            _ if self.has_residues() && is_rk4 => RESIDUE_REGION + 2,
            0 | 2 if self.has_residues() => RESIDUE_REGION + 1,
            3 if self.has_residues() && is_verlet => RESIDUE_REGION + 1,
            0 | 1 => self.collision_regions(),
            3 if !self.is_double() && !is_verlet => 3,
            _ => 4,
        }
    }

    /// Number of regions of a state that collisions change.
    pub const fn collision_regions(&self) -> u32 {
        if self.is_half_step() { 5 } else { 4 }
    }

    /// Whether velocities have residues (docs/physics section 5.10).
    pub const fn has_residues(&self) -> bool {
        self.constants.flags & FLAG_RESIDUES != 0
    }

    /// Whether velocities are half a step behind positions (docs/physics section 5.2).
    pub const fn is_half_step(&self) -> bool {
        self.constants.flags & FLAG_HALF_STEP != 0
    }

    /// Time in s, in which the free acceleration gives a body the approach velocity above which it may collide (docs/physics
    /// section 3.1).
    pub const fn free_time(&self) -> f32 {
        if self.is_half_step() { 4.0 * self.constants.dt } else { 2.0 * self.constants.dt }
    }

    /// Number of springs.
    pub const fn spring_count(&self) -> u32 {
        (self.layout.tethers_at - self.layout.springs_at) / SPRING_WORDS
    }

    /// Bits of the id in a list entry: 26 in scenes with rods. In other scenes there are no features, so the id has all 30
    /// bits.
    pub const fn entry_id_bits(&self) -> u32 {
        if self.layout.rods > 0 { ENTRY_BITS - FEATURE_BITS } else { ENTRY_BITS }
    }

    /// Mask of the id in a list entry.
    pub const fn entry_id_mask(&self) -> u32 {
        (1 << self.entry_id_bits()) - 1
    }
}

block! {
    /// The uniform block `pass_`: which of several dispatches of a stage this is.
    #[repr(C)]
    #[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
    pub struct Pass {
        /// 0 to 3 for the force evaluations of RK4, 0 and 1 for `sort_axis`, 0 to 7 for the digits of a sort. For
        /// `sweep_collisions`, the number of sweeps before it. For `project_networks` and `gather_impulses`, the number of sweeps
        /// done. For `run_worlds`, see [`STEPS_SHIFT`](crate::model::layout::STEPS_SHIFT). 0 for symplectic Euler and all other
        /// stages.
        pub index: u32,
        /// Number of steps without motion after which `run_worlds` leaves a world as it is; 0 for never.
        pub rest_steps: u32,
        /// Greatest speed of a sphere that does not move, in units/s.
        pub rest_speed: f32,
        /// Always 0. Kernels use it where the compiler must not know a value (`physics/fine.wgsl`).
        pub zero: u32,
    }
}

block! {
    /// An axis-aligned bounding box, which includes a margin for motion.
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
}
