//! The facts of a scene on which special paths depend.

use crate::model::layout::{
    FLAG_COHESION, FLAG_COLLISIONS, FLAG_CONTINUOUS, FLAG_DOUBLE, FLAG_HALF_STEP, FLAG_PAIR_FRICTION, FLAG_PERIODIC,
    FLAG_RESIDUES, FLAG_RESISTANCE, FLAG_SERVOS, FLAG_SHEARED, FLAG_SMOOTH, FLAG_TRIANGLES, FLAG_VERLET, MANY_OBJECTS,
};
use crate::model::step::Step;
use crate::settings::Integrator;

/// What a scene consists of and how it is computed. Kernels are compiled for some of it, and every special path states its
/// conditions over it, in a function beside the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Traits {
    /// The number of the contact law.
    pub law: u32,
    /// The integrator.
    pub integrator: Integrator,
    /// Geometry uses the low parts of positions.
    pub double: bool,
    /// Velocities have residues.
    pub residues: bool,
    /// Number of spheres.
    pub spheres: u32,
    /// There are rods.
    pub rods: bool,
    /// There are connected sets of fixed-length rods that are not rigid capsules.
    pub networks: bool,
    /// There are large spheres, each of which gets a workgroup.
    pub large: bool,
    /// There is room for movers that are much larger than most.
    pub long_movers: bool,
    /// There are springs with muscles.
    pub muscles: bool,
    /// Springs, tethers or forces act.
    pub free_table: bool,
    /// Boxes or polygons move.
    pub walls: bool,
    /// Walls follow servos.
    pub servos: bool,
    /// There are rigid bodies.
    pub rigid: bool,
    /// There are polygons.
    pub polygons: bool,
    /// Some polygons are triangles.
    pub triangles: bool,
    /// Some polygons are smooth walls.
    pub smooth: bool,
    /// There are rods and polygons.
    pub rod_polygons: bool,
    /// The scene is periodic along some axis.
    pub periodic: bool,
    /// The images of the scene slide along the box.
    pub sheared: bool,
    /// There are properties of pairs of materials.
    pub materials: bool,
    /// There are pairs with rolling or twisting resistance.
    pub resistance: bool,
    /// There are pairs with cohesion.
    pub cohesion: bool,
    /// Collisions are handled as impulses.
    pub collisions: bool,
    /// Contacts that begin and end within a step are handled.
    pub continuous: bool,
    /// Contacts get friction impulses. They never do in scenes with rigid bodies.
    pub friction_impulses: bool,
    /// There are so many objects that a sort key of `find_neighbours` has no room for more than an insertion index.
    pub many: bool,
    /// Spheres are in the order of their insertion in memory.
    pub in_insertion_order: bool,
}

impl Step {
    /// The traits of the scene.
    pub fn traits(&self) -> Traits {
        let (constants, layout) = (&self.constants, &self.layout);
        let has = |flag: u32| constants.flags & flag != 0;
        Traits {
            law: layout.law,
            integrator: match () {
                () if has(FLAG_VERLET) => Integrator::VelocityVerlet,
                () if has(FLAG_HALF_STEP) => Integrator::SymplecticEuler,
                () => Integrator::Rk4,
            },
            double: has(FLAG_DOUBLE),
            residues: has(FLAG_RESIDUES),
            spheres: layout.spheres,
            rods: layout.rods > 0,
            networks: layout.networks > 0,
            large: layout.large > 0,
            long_movers: layout.long_at != 0,
            muscles: layout.muscles_at > 0,
            free_table: layout.free_at != 0,
            walls: layout.walls_at != 0,
            servos: has(FLAG_SERVOS),
            rigid: layout.rigid_bodies > 0,
            polygons: layout.polygons > 0,
            triangles: has(FLAG_TRIANGLES),
            smooth: has(FLAG_SMOOTH),
            rod_polygons: layout.rods > 0 && layout.polygons > 0,
            periodic: has(FLAG_PERIODIC),
            sheared: has(FLAG_SHEARED),
            materials: layout.materials > 0,
            resistance: has(FLAG_RESISTANCE),
            cohesion: has(FLAG_COHESION),
            collisions: has(FLAG_COLLISIONS),
            continuous: has(FLAG_CONTINUOUS),
            friction_impulses: layout.rigid_bodies == 0
                && (constants.coulomb_friction > 0.0 || constants.collision_friction > 0.0 || has(FLAG_PAIR_FRICTION)),
            many: self.objects() >= MANY_OBJECTS,
            in_insertion_order: layout.insertion_indices_at == 0,
        }
    }
}

impl Traits {
    /// Orientations are updated by stages after the integration, so that it leaves them the mean spins.
    pub const fn turns_late(&self) -> bool {
        self.rods || self.rigid
    }

    /// Passages of spheres through walls are counted. Contacts that begin and end within a step take such spheres back.
    pub const fn counts_passages(&self) -> bool {
        self.polygons && !self.continuous
    }

    /// Bodies may have long lists.
    pub const fn has_long_lists(&self) -> bool {
        self.rods || self.large
    }
}
