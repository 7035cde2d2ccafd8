//! A scene: objects in order of addition, referred to by typed handles, and the physical constants.
//!
//! A scene does not advance in time. A [`Simulation`](crate::Simulation) does that.

use crate::error::Result;
use crate::settings::Settings;

mod any;
mod body;
mod bonded;
mod checks;
mod colour;
mod contact_law;
mod gauge;
mod groups;
mod implied;
mod inlet;
mod joint;
mod look;
mod materials;
mod mesh;
mod motion;
mod muscle;
mod objects;
pub(crate) mod periodic;
mod pose;
mod references;
mod registry;
mod remove;
mod restitution;
mod rigid;
mod run;
mod sensor;
mod servo;
mod shape;
mod shear;
mod smooth;
mod static_body;
mod statics;
mod surface;
mod tag;
mod text;
mod write;

pub(crate) use any::AnyId;
pub use body::Body;
pub use bonded::BondedSets;
pub(crate) use checks::finite;
pub use colour::Colour;
pub(crate) use colour::is_hexadecimal;
pub(crate) use contact_law::Dampings;
pub(crate) use gauge::Front;
pub use gauge::{Gauge, Gauged};
use groups::Groups;
pub(crate) use implied::{AnyForm, BodyHandles, Form, ImpliedBody, WholeBody};
pub(crate) use inlet::{FlowState, InletState, Passed, Sequence, Sum};
pub use inlet::{GrainKind, GrainMass, Inlet, Outlet, Radii, Rate, SizedBy};
pub(crate) use joint::name_is_taken;
pub use joint::{Anchor, Joint, JointFrame, JointId, JointKind};
pub use look::Look;
pub(crate) use materials::Pairs;
pub use materials::{CohesionModel, MAX_MATERIALS, Material, MaterialId, Pair, RollingModel};
pub use mesh::Facets;
pub use motion::{Motion, MotionId, MotionTerm};
pub use muscle::Muscle;
pub use objects::{Capsule, CapsuleId, CapsuleParts, Rod, RodId, Sphere, SphereId, Spring, SpringId, Tether, TetherId};
pub(crate) use pose::Pose;
pub(crate) use references::References;
pub use registry::Handle;
pub(crate) use registry::Registry;
use registry::new_scene_number;
pub(crate) use rigid::{BodyState, Frame};
pub use rigid::{Placement, RigidBody, RigidBodyId};
pub use run::RunDefaults;
pub use sensor::Sensor;
pub use servo::{Servo, Sought};
pub(crate) use shape::Core;
pub(crate) use shape::Kinetics;
pub use shape::{MassProperties, Shape, ShapeBox, ShapeHull, ShapeId, ShapeMass, ShapeRod, ShapeSphere};
pub use shear::Shear;
pub(crate) use statics::upright;
pub use statics::{BoxId, Cuboid, Polygon, PolygonId};
pub use surface::{ConeAxis, Surface};
pub(crate) use tag::shared;
pub use tag::{ObjectId, Tag};
pub use text::{LineWarning, Loaded};

/// Objects and their physical constants.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The physical constants.
    pub settings: Settings,
    /// How the scene is meant to be run.
    pub run: RunDefaults,
    pub(crate) spheres: Registry<Sphere>,
    pub(crate) rods: Registry<Rod>,
    pub(crate) capsules: Registry<CapsuleParts>,
    pub(crate) shapes: Registry<Shape>,
    /// How bodies of each shape move, in the order of the shapes.
    pub(crate) kinetics: Vec<Kinetics>,
    pub(crate) bodies: Registry<RigidBody>,
    pub(crate) members: rigid::Members<RigidBody>,
    /// Capsules and frames of rods that move as rigid bodies, in a simulation.
    pub(crate) implied: Registry<ImpliedBody>,
    pub(crate) implied_members: rigid::Members<ImpliedBody>,
    pub(crate) springs: Registry<Spring>,
    pub(crate) tethers: Registry<Tether>,
    pub(crate) joints: Registry<Joint>,
    pub(crate) groups: Groups,
    pub(crate) boxes: Registry<Cuboid>,
    pub(crate) polygons: Registry<Polygon>,
    pub(crate) motions: Registry<Motion>,
    pub(crate) gauges: Vec<Gauge>,
    pub(crate) inlets: Vec<Inlet>,
    pub(crate) outlets: Vec<Outlet>,
    pub(crate) sensors: Vec<Sensor>,
    pub(crate) materials: Registry<Material>,
    pub(crate) pairs: Pairs,
    pub(crate) periodic: [Option<[f32; 2]>; 3],
    pub(crate) shear: Option<Shear>,
    pub(crate) references: References,
    pub(crate) tag_changes: u64,
}

impl Default for Scene {
    fn default() -> Self {
        Self::new()
    }
}

/// Number of objects of each kind. The spheres and rods of capsules and rigid bodies are counted as spheres and rods too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Spheres.
    pub spheres: usize,
    /// Rods.
    pub rods: usize,
    /// Capsules.
    pub capsules: usize,
    /// Springs.
    pub springs: usize,
    /// Tethers.
    pub tethers: usize,
    /// Boxes.
    pub boxes: usize,
    /// Polygons.
    pub polygons: usize,
    /// Rigid bodies.
    pub bodies: usize,
    /// Hulls of rigid bodies.
    pub hulls: usize,
    /// Joints.
    pub joints: usize,
}

impl Scene {
    /// Creates an empty scene with the default settings.
    pub fn new() -> Self {
        let number = new_scene_number();
        Self {
            settings: Settings::default(),
            run: RunDefaults::default(),
            spheres: Registry::new(number, "sphere"),
            rods: Registry::new(number, "rod"),
            capsules: Registry::new(number, "capsule"),
            shapes: Registry::new(number, "shape"),
            kinetics: Vec::new(),
            bodies: Registry::new(number, "rigid body"),
            members: rigid::Members::default(),
            implied: Registry::new(number, "implied body"),
            implied_members: rigid::Members::default(),
            springs: Registry::new(number, "spring"),
            tethers: Registry::new(number, "tether"),
            joints: Registry::new(number, "joint"),
            groups: Groups::default(),
            boxes: Registry::new(number, "box"),
            polygons: Registry::new(number, "polygon"),
            motions: Registry::new(number, "motion"),
            gauges: Vec::new(),
            inlets: Vec::new(),
            outlets: Vec::new(),
            sensors: Vec::new(),
            materials: Registry::new(number, "material"),
            pairs: Pairs::new(),
            periodic: [None; 3],
            shear: None,
            references: References::default(),
            tag_changes: 0,
        }
    }

    /// Adds a sphere.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) when a field is not finite, mass or radius is not positive, or the orientation
    /// is not a unit quaternion. [`Error::StaleHandle`](crate::Error::StaleHandle) for a material that is not in the scene, here
    /// and for all other objects.
    pub fn add_sphere(&mut self, sphere: Sphere) -> Result<SphereId> {
        sphere.validate()?;
        self.material_number(sphere.material)?;
        Ok(self.spheres.add(sphere))
    }

    /// Adds a rod between two spheres.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) for an end that is not in the scene,
    /// [`Error::Invalid`](crate::Error::Invalid) for a radius or length that is not positive, or a rod from a sphere to itself.
    pub fn add_rod(&mut self, rod: Rod) -> Result<RodId> {
        self.check_ends(rod.end1, rod.end2)?;
        self.material_number(rod.material)?;
        rod.validate()?;
        Ok(self.rods.add(rod))
    }

    /// Adds a capsule: a sphere at end 1, a sphere at end 2, and a rod of fixed length.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) as for its spheres and its rod, and when the ends coincide.
    pub fn add_capsule(&mut self, capsule: Capsule) -> Result<CapsuleId> {
        let end = |position| {
            let sphere = Sphere::new(position, capsule.radius).mass(capsule.mass * 0.5).velocity(capsule.velocity);
            Sphere { material: capsule.material, ..sphere.group(capsule.group) }
        };
        let length = capsule.validate()?;
        self.material_number(capsule.material)?;
        let end1 = self.spheres.add(end(capsule.end1));
        let end2 = self.spheres.add(end(capsule.end2));
        let rod = Rod::new(end1, end2, capsule.radius).length(length).group(capsule.group);
        let rod = self.rods.add(Rod { material: capsule.material, ..rod });
        Ok(self.capsules.add(CapsuleParts { end1, end2, rod }))
    }

    /// Adds a spring between two spheres.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) for a sphere that is not in the scene,
    /// [`Error::Invalid`](crate::Error::Invalid) for a negative constant, a muscle with a number out of range, or a spring from a
    /// sphere to itself.
    pub fn add_spring(&mut self, spring: Spring) -> Result<SpringId> {
        self.check_ends(spring.a, spring.b)?;
        spring.validate()?;
        Ok(self.springs.add(spring))
    }

    /// Adds a tether from a sphere to a point in space.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) for a sphere that is not in the scene,
    /// [`Error::Invalid`](crate::Error::Invalid) for a negative constant or a point that is not finite.
    pub fn add_tether(&mut self, tether: Tether) -> Result<TetherId> {
        self.spheres.index(tether.sphere)?;
        tether.validate()?;
        Ok(self.tethers.add(tether))
    }

    /// Adds a box.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for edges that are not orthogonal, or too short or too long for f32.
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) for a motion that is not in the scene.
    pub fn add_box(&mut self, cuboid: Cuboid) -> Result<BoxId> {
        cuboid.validate()?;
        self.material_number(cuboid.material)?;
        self.body_number(cuboid.motion)?;
        Ok(self.boxes.add(cuboid))
    }

    /// Adds a polygon.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for edges that are parallel, or too short or too long for f32.
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) for a motion that is not in the scene.
    pub fn add_polygon(&mut self, polygon: Polygon) -> Result<PolygonId> {
        polygon.validate()?;
        self.material_number(polygon.material)?;
        self.body_number(polygon.motion)?;
        Ok(self.polygons.add(polygon))
    }

    fn check_ends(&self, a: SphereId, b: SphereId) -> Result<()> {
        self.spheres.index(a)?;
        self.spheres.index(b)?;
        Ok(())
    }

    /// Changes a spring's constants and its muscle. Its spheres cannot be changed.
    ///
    /// # Errors
    /// As for [`Scene::add_spring`]. Nothing is changed then.
    pub fn update_spring(&mut self, id: SpringId, change: impl FnOnce(&mut Spring)) -> Result<()> {
        let mut spring = *self.springs.get(id)?;
        let ends = (spring.a, spring.b);
        change(&mut spring);
        (spring.a, spring.b) = ends;
        spring.validate()?;
        *self.springs.get_mut(id)? = spring;
        Ok(())
    }

    /// Changes a tether's point and constants. Its sphere cannot be changed.
    ///
    /// # Errors
    /// As for [`Scene::add_tether`]. Nothing is changed then.
    pub fn update_tether(&mut self, id: TetherId, change: impl FnOnce(&mut Tether)) -> Result<()> {
        let mut tether = *self.tethers.get(id)?;
        let sphere = tether.sphere;
        change(&mut tether);
        tether.sphere = sphere;
        tether.validate()?;
        *self.tethers.get_mut(id)? = tether;
        Ok(())
    }

    /// Changes a rod's radius, length, group and material. Its ends cannot be changed.
    ///
    /// # Errors
    /// As for [`Scene::add_rod`], and for a rod that is part of a rigid body. Nothing is changed then.
    pub fn update_rod(&mut self, id: RodId, change: impl FnOnce(&mut Rod)) -> Result<()> {
        if self.body_of_rod(id).is_some() {
            return Err(checks::invalid("rod", id, "a rod that is not part of a rigid body, whose shape cannot be changed"));
        }
        let mut rod = *self.rods.get(id)?;
        let ends = (rod.end1, rod.end2);
        change(&mut rod);
        (rod.end1, rod.end2) = ends;
        rod.validate()?;
        self.material_number(rod.material)?;
        self.release_rods(&[id]);
        *self.rods.get_mut(id)? = rod;
        Ok(())
    }

    /// Advances the phases of all muscles by `time` seconds, so that a simulation of this scene begins with the rest lengths that
    /// they have after that time.
    pub fn advance_muscles(&mut self, time: f64) {
        for spring in self.springs.objects_mut() {
            spring.muscle = spring.muscle.map(|muscle| muscle.after(time));
        }
    }

    /// Number of objects of each kind.
    pub fn counts(&self) -> Counts {
        Counts {
            spheres: self.spheres.len(),
            rods: self.rods.len(),
            capsules: self.capsules.len(),
            springs: self.springs.len(),
            tethers: self.tethers.len(),
            boxes: self.boxes.len(),
            polygons: self.polygons.len(),
            bodies: self.bodies.len(),
            hulls: self.hull_count(),
            joints: self.joints().len(),
        }
    }
}

macro_rules! readers {
    ($($one:ident, $all:ident, $ids:ident, $handle:ty, $object:ty, $what:literal;)*) => {
        impl Scene {
            $(
                #[doc = concat!("The ", $what, " with this handle.")]
                ///
                /// # Errors
                /// [`Error::StaleHandle`](crate::Error::StaleHandle) when it is not in the scene.
                pub fn $one(&self, id: $handle) -> Result<&$object> {
                    self.$all.get(id)
                }

                #[doc = concat!("All objects of the kind ", $what, ", in order of addition.")]
                pub fn $all(&self) -> &[$object] {
                    self.$all.objects()
                }

                #[doc = concat!("The handles of all objects of the kind ", $what, ", in order of addition.")]
                pub fn $ids(&self) -> impl Iterator<Item = $handle> + '_ {
                    self.$all.handles()
                }
            )*
        }
    };
}

readers! {
    sphere, spheres, sphere_ids, SphereId, Sphere, "sphere";
    rod, rods, rod_ids, RodId, Rod, "rod";
    capsule, capsules, capsule_ids, CapsuleId, CapsuleParts, "capsule";
    spring, springs, spring_ids, SpringId, Spring, "spring";
    tether, tethers, tether_ids, TetherId, Tether, "tether";
    joint, joints, joint_ids, JointId, Joint, "joint";
    cuboid, boxes, box_ids, BoxId, Cuboid, "box";
    polygon, polygons, polygon_ids, PolygonId, Polygon, "polygon";
    material, materials, material_ids, MaterialId, Material, "material";
    motion, motions, motion_ids, MotionId, Motion, "motion";
    shape, shapes, shape_ids, ShapeId, Shape, "shape";
    body, bodies, body_ids, RigidBodyId, RigidBody, "rigid body";
}
