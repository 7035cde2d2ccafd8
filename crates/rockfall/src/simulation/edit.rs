//! Changes a scene between steps. Edits are collected here and reach the engine with the next step or read.

use glam::{Quat, Vec3};

use crate::error::{Error, Result};
use crate::fine::Fine;
use crate::mesh::Mesh;
use crate::model::layout::FLAG_CONTINUE;
use crate::scene::{
    BodyHandles, BoxId, Capsule, CapsuleId, Cuboid, Facets, Inlet, Material, MaterialId, Motion, MotionId, MotionTerm,
    ObjectId, Outlet, Pair, Placement, Polygon, PolygonId, RigidBody, RigidBodyId, Rod, RodId, Scene, Sensor, Shape, ShapeId,
    Sphere, SphereId, Spring, SpringId, Tag, Tether, TetherId, finite,
};
use crate::simulation::kept::{Kept, put_residues};
use crate::simulation::order::Disorder;
use crate::simulation::{Simulation, engine, ids_of, pack};
use crate::step::walls::move_walls::place_walls;

/// The changes that were not uploaded to the engine yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Dirty {
    Clean,
    /// Rods, springs, tethers, forces, static objects.
    Topology,
    /// The spheres, or the number of objects.
    Everything,
}

/// A change of a sphere's state.
#[derive(Clone, Copy, Debug)]
pub(super) enum Edit {
    Position(Vec3),
    Centre(Fine),
    Velocity(Vec3),
    AngularMomentum(Vec3),
    Orientation(Quat),
    Impulse(Vec3),
    Force(Vec3),
}

/// A change together with the sphere that it applies to. Changes are applied in the order of the calls.
pub(super) type Edits = (SphereId, Edit);

impl Edit {
    /// Whether it changes the velocity or the angular momentum.
    fn sets_motion(self) -> bool {
        matches!(self, Self::Velocity(_) | Self::AngularMomentum(_) | Self::Impulse(_))
    }

    fn apply(self, sphere: &mut Sphere) {
        match self {
            Self::Position(position) => (sphere.position, sphere.position_low) = (position, Vec3::ZERO),
            Self::Centre(centre) => (sphere.position, sphere.position_low) = (centre.high, centre.low),
            Self::Velocity(velocity) => sphere.velocity = velocity,
            Self::AngularMomentum(angular_momentum) => sphere.angular_momentum = angular_momentum,
            Self::Orientation(orientation) => sphere.orientation = orientation,
            Self::Impulse(impulse) if !sphere.fixed => sphere.velocity += impulse / sphere.mass,
            Self::Impulse(_) => {}
            Self::Force(force) => sphere.force = force,
        }
    }
}

macro_rules! edits {
    ($($level:ident: $(#[$doc:meta])* $name:ident($($arg:ident: $type:ty),*) -> $result:ty;)*) => {
        /// Adding, removing and changing objects. Changes take effect with the next step or read.
        impl Simulation {
            $(
                $(#[$doc])*
                ///
                /// # Errors
                #[doc = concat!("As for [`Scene::", stringify!($name), "`].")]
                pub fn $name(&mut self, $($arg: $type),*) -> Result<$result> {
                    let result = self.scene.$name($($arg),*)?;
                    self.dirty = self.dirty.max(Dirty::$level);
                    Ok(result)
                }
            )*
        }
    };
}

edits! {
    Clean: /// Replaces the name, colour, look and label of an object.
        set_tag(id: impl Into<ObjectId>, tag: Tag) -> ();
    Everything: /// Adds a sphere.
        add_sphere(sphere: Sphere) -> SphereId;
    Everything: /// Adds a rod between two spheres.
        add_rod(rod: Rod) -> RodId;
    Everything: /// Adds a capsule: two spheres and a rod of fixed length.
        add_capsule(capsule: Capsule) -> CapsuleId;
    Clean: /// Adds a shape of rigid bodies.
        add_shape(shape: Shape) -> ShapeId;
    Everything: /// Adds a rigid body with its spheres and rods.
        add_body(placement: Placement) -> RigidBodyId;
    Everything: /// Adds the parts of a shape as fixed objects, or as walls that follow a motion.
        add_static_body(placement: Placement, motion: Option<MotionId>) -> Vec<ObjectId>;
    Everything: /// Removes a rigid body with its spheres and rods and everything attached to them.
        remove_body(id: RigidBodyId) -> ();
    Everything: /// Removes rigid bodies with their spheres and rods and everything attached to them, in one pass.
        remove_bodies(ids: &[RigidBodyId]) -> ();
    Topology: /// Adds a spring between two spheres.
        add_spring(spring: Spring) -> SpringId;
    Topology: /// Adds a tether from a sphere to a point in space.
        add_tether(tether: Tether) -> TetherId;
    Everything: /// Adds a static box.
        add_box(cuboid: Cuboid) -> BoxId;
    Everything: /// Adds a static polygon.
        add_polygon(polygon: Polygon) -> PolygonId;
    Everything: /// Removes a sphere together with its rods, capsules, springs and tethers.
        remove_sphere(id: SphereId) -> ();
    Everything: /// Removes spheres together with their rods, capsules, springs and tethers, in one pass.
        remove_spheres(ids: &[SphereId]) -> ();
    Everything: /// Removes a rod. If it is part of a capsule, the two spheres stay.
        remove_rod(id: RodId) -> ();
    Everything: /// Removes rods in one pass. Spheres of capsules that they are part of stay.
        remove_rods(ids: &[RodId]) -> ();
    Everything: /// Removes a capsule with both its spheres and everything attached to them.
        remove_capsule(id: CapsuleId) -> ();
    Everything: /// Removes capsules with their spheres and everything attached to them, in one pass.
        remove_capsules(ids: &[CapsuleId]) -> ();
    Topology: /// Removes a spring.
        remove_spring(id: SpringId) -> ();
    Topology: /// Removes springs in one pass.
        remove_springs(ids: &[SpringId]) -> ();
    Topology: /// Removes a tether.
        remove_tether(id: TetherId) -> ();
    Topology: /// Removes tethers in one pass.
        remove_tethers(ids: &[TetherId]) -> ();
    Everything: /// Removes a box.
        remove_box(id: BoxId) -> ();
    Everything: /// Removes boxes in one pass.
        remove_boxes(ids: &[BoxId]) -> ();
    Everything: /// Adds the triangles of a mesh.
        add_mesh(mesh: &Mesh, with: impl Fn(Polygon) -> Polygon) -> Facets;
    Everything: /// Removes a polygon.
        remove_polygon(id: PolygonId) -> ();
    Everything: /// Removes polygons in one pass.
        remove_polygons(ids: &[PolygonId]) -> ();
    Topology: /// Changes a spring's constants and its muscle. The phase of a muscle follows from its frequency and the time since
        /// the start of the simulation, so another frequency changes the phase at once.
        update_spring(id: SpringId, change: impl FnOnce(&mut Spring)) -> ();
    Topology: /// Changes a tether's point and constants, for example to hold or drag a body.
        update_tether(id: TetherId, change: impl FnOnce(&mut Tether)) -> ();
    Everything: /// Changes a rod's radius, length, group and material.
        update_rod(id: RodId, change: impl FnOnce(&mut Rod)) -> ();
    Topology: /// Adds a motion, which boxes and polygons may follow. Its time is that of the simulation.
        add_motion(motion: Motion) -> MotionId;
    Everything: /// Lets a box or polygon follow a motion, or none. It jumps to where the motion puts it at the present time.
        set_motion(id: impl Into<ObjectId>, motion: Option<MotionId>) -> ();
    Everything: /// Sets the surface velocity of a box or polygon, in units/s, for example to stop a conveyor.
        set_surface_velocity(id: impl Into<ObjectId>, velocity: impl Into<Vec3>) -> ();
    Clean: /// Adds an inlet. Its times are those of the simulation.
        add_inlet(inlet: Inlet) -> ();
    Clean: /// Adds an outlet.
        add_outlet(outlet: Outlet) -> ();
    Clean: /// Adds a sensor.
        add_sensor(sensor: Sensor) -> ();
    Topology: /// Adds a material.
        add_material(material: Material) -> MaterialId;
    Topology: /// Changes the constants of a material.
        update_material(id: MaterialId, change: impl FnOnce(&mut Material)) -> ();
    Topology: /// Sets the properties of the contacts between two materials.
        set_pair(one: MaterialId, other: MaterialId, pair: Pair) -> ();
}

/// Changing the state of walls and spheres. Changes take effect with the next step or read.
impl Simulation {
    /// Replaces a motion from now on without a jump: walls go on from where they are with `term`, whose directions and axis are those of
    /// the world. A term without velocity, amplitude and spin stops them. See [`Motion::go_on`].
    ///
    /// # Errors
    /// As for [`Scene::update_motion`].
    pub fn go_on(&mut self, id: MotionId, term: MotionTerm) -> Result<()> {
        let time = self.muscle_clock.written_time();
        self.update_motion(id, |motion| motion.go_on(time, term))
    }

    /// Changes the terms or the servo of a motion. The walls jump to where the new terms put them at the present time. Walls of a servo
    /// stay where they are, unless its displacement is changed.
    ///
    /// # Errors
    /// As for [`Scene::update_motion`], and as for [`Simulation::sync`] if the motion has a servo.
    pub fn update_motion(&mut self, id: MotionId, change: impl FnOnce(&mut Motion)) -> Result<()> {
        if self.scene.motion(id)?.servo.is_some() {
            // The change may depend on the present state.
            self.sync()?;
        }
        self.scene.update_motion(id, change)?;
        self.dirty = Dirty::Everything;
        Ok(())
    }

    /// Sets a sphere's position, in units.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] when the sphere is not in the scene, [`Error::Invalid`] for a value that is not finite.
    pub fn set_position(&mut self, id: SphereId, position: impl Into<Vec3>) -> Result<()> {
        let position = position.into();
        finite("position", position)?;
        self.edit(id, Edit::Position(position))
    }

    /// Sets a sphere's position with the digits of an `f64`, in units. With [`Precision::Single`](crate::settings::Precision) it is
    /// rounded to `f32`.
    ///
    /// # Errors
    /// As for [`Simulation::set_position`].
    pub fn set_centre(&mut self, id: SphereId, centre: [f64; 3]) -> Result<()> {
        self.set_place(id, Fine::at(centre))
    }

    pub(crate) fn set_place(&mut self, id: SphereId, place: Fine) -> Result<()> {
        finite("position", place.high)?;
        self.edit(id, Edit::Centre(place))
    }

    /// Sets a sphere's velocity, in units/s.
    ///
    /// # Errors
    /// As for [`Simulation::set_position`].
    pub fn set_velocity(&mut self, id: SphereId, velocity: impl Into<Vec3>) -> Result<()> {
        let velocity = velocity.into();
        finite("velocity", velocity)?;
        self.edit(id, Edit::Velocity(velocity))
    }

    /// Sets a sphere's angular momentum, in mass units²/s.
    ///
    /// # Errors
    /// As for [`Simulation::set_position`].
    pub fn set_angular_momentum(&mut self, id: SphereId, angular_momentum: impl Into<Vec3>) -> Result<()> {
        let angular_momentum = angular_momentum.into();
        finite("angular_momentum", angular_momentum)?;
        self.edit(id, Edit::AngularMomentum(angular_momentum))
    }

    /// Sets a sphere's orientation.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] when the sphere is not in the scene, [`Error::Invalid`] for a value that is not a unit
    /// quaternion.
    pub fn set_orientation(&mut self, id: SphereId, orientation: Quat) -> Result<()> {
        if !orientation.is_normalized() {
            return Err(Error::Invalid {
                field: "orientation",
                value: format!("{orientation}"),
                expected: "a unit quaternion",
            });
        }
        self.edit(id, Edit::Orientation(orientation))
    }

    /// Applies an impulse, in mass units/s: the velocity of the sphere changes by impulse / mass. A fixed sphere does not
    /// change.
    ///
    /// # Errors
    /// As for [`Simulation::set_position`].
    pub fn apply_impulse(&mut self, id: SphereId, impulse: impl Into<Vec3>) -> Result<()> {
        let impulse = impulse.into();
        finite("impulse", impulse)?;
        self.edit(id, Edit::Impulse(impulse))
    }

    /// Sets the external force on a sphere, in mass units/s². The force acts until it is changed.
    ///
    /// # Errors
    /// As for [`Simulation::set_position`].
    pub fn set_force(&mut self, id: SphereId, force: impl Into<Vec3>) -> Result<()> {
        let force = force.into();
        finite("force", force)?;
        if self.forces_synced {
            self.scene.spheres.get_mut(id)?.force = force;
        } else {
            // Reading the forces back would replace it.
            self.edit(id, Edit::Force(force))?;
        }
        self.dirty = self.dirty.max(Dirty::Topology);
        Ok(())
    }

    /// Whether [`Simulation::set_rest_lengths`] writes the lengths alone.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn takes_rest_lengths(&self) -> bool {
        self.dirty == Dirty::Clean && self.edits.is_empty() && self.cpu_view().is_some()
    }

    /// Sets the rest lengths of all springs. The lengths are in order of addition and must be valid. Where nothing else has to
    /// be packed and the arrays are on the host, only the lengths are written: packing all objects again takes several times as
    /// long.
    #[cfg(not(target_family = "wasm"))]
    pub(crate) fn set_rest_lengths(&mut self, lengths: &[f32]) -> Result<()> {
        let is_packed = self.takes_rest_lengths();
        let ids: Vec<_> = self.scene.spring_ids().collect();
        for (id, length) in ids.into_iter().zip(lengths) {
            self.scene.springs.get_mut(id)?.length = *length;
        }
        if is_packed {
            self.world.set_rest_lengths(lengths);
            self.observation = None;
            self.status.forces_due = 1;
        } else {
            self.dirty = self.dirty.max(Dirty::Topology);
        }
        Ok(())
    }

    /// Changes the pose, the motion and the external force of a rigid body. Its spheres follow. A change of the force and the torque alone
    /// is cheap.
    ///
    /// # Errors
    /// As for [`Scene::update_body`] and [`Simulation::sync`].
    pub fn update_body(&mut self, id: RigidBodyId, change: impl FnOnce(&mut RigidBody)) -> Result<()> {
        self.sync_states()?;
        let before = self.scene.body(id)?.clone();
        self.scene.update_body(id, change)?;
        let body = self.scene.body(id)?;
        let (force, torque) = (body.force, body.torque);
        let has_loads = (force, torque) != (before.force, before.torque);
        if *body != (RigidBody { force, torque, ..before }) {
            self.dirty = Dirty::Everything;
        }
        if has_loads { self.changed_loads(id) } else { Ok(()) }
    }

    /// Changes poses and motions of rigid bodies.
    pub(crate) fn move_bodies(&mut self, change: impl FnOnce(&mut Scene) -> Result<()>) -> Result<()> {
        self.sync_states()?;
        // A change that fails may have moved some.
        self.dirty = Dirty::Everything;
        change(&mut self.scene)
    }

    /// Reads the states that an edit may depend on. Earlier edits of bodies are in the scene and need not be packed before.
    pub(super) fn sync_states(&mut self) -> Result<()> {
        if self.synced && self.edits.is_empty() { Ok(()) } else { self.sync().map(drop) }
    }

    fn edit(&mut self, id: SphereId, edit: Edit) -> Result<()> {
        self.scene.spheres.index(id)?;
        if !matches!(edit, Edit::Force(_)) && self.scene.body_of_sphere(id).is_some() {
            return Err(Error::Invalid {
                field: "sphere",
                value: format!("{id:?}, a part of a rigid body"),
                expected: "a sphere of its own: `update_body` moves a body",
            });
        }
        self.edits.push((id, edit));
        Ok(())
    }

    /// Applies the edits made since the last step or read to the arrays in memory and on the device. `Simulation::gpu_view`
    /// and [`Simulation::cpu_view`] then show them. No state is read back.
    ///
    /// # Errors
    /// [`Error::Device`] when the GPU fails, [`Error::DeviceLimit`] when the scene has become too large.
    pub fn flush(&mut self) -> Result<()> {
        let device = self.engine.waiter();
        engine::block_on(device, self.flush_async())
    }

    /// [`Simulation::flush`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::flush`].
    pub async fn flush_async(&mut self) -> Result<()> {
        if self.dirty == Dirty::Clean && self.edits.is_empty() {
            return Ok(());
        }
        if self.dirty != Dirty::Clean {
            self.check_contact_law()?;
            self.observation = None;
        }
        self.frames_due = true;
        // The topology has the places of walls.
        let has_servos = self.scene.motions().iter().any(|motion| motion.servo.is_some());
        if self.dirty == Dirty::Everything || !self.edits.is_empty() || has_servos {
            self.pull().await?;
        }
        #[cfg(feature = "gpu")]
        if self.dirty != Dirty::Clean {
            self.pull_forces().await?;
        }
        let moves = self.dirty == Dirty::Everything || !self.edits.is_empty();
        let fronts = moves.then(|| self.planes.in_front_of(&self.world, &self.scene));
        let edits = std::mem::take(&mut self.edits);
        for (id, edit) in &edits {
            // Edits of a sphere that was removed afterwards have no effect.
            if let Ok(sphere) = self.scene.spheres.get_mut(*id) {
                edit.apply(sphere);
            }
        }
        let moved = edits.iter().filter(|(_, edit)| !matches!(edit, Edit::Force(_))).map(|(id, _)| *id);
        if !self.scene.follow_spheres(&moved.collect::<Vec<_>>()) {
            self.dirty = Dirty::Everything;
        }
        let springs = if self.dirty == Dirty::Everything { self.springs().await? } else { Vec::new() };
        let edited: Vec<SphereId> = edits.iter().filter(|(_, edit)| edit.sets_motion()).map(|(id, _)| *id).collect();
        let residues = if moves { self.residues(&edited) } else { Vec::new() };
        if let Some(before) = fronts {
            self.planes.edited(before, &self.scene);
        }
        // If this fails, the world stays that of the scene before.
        match std::mem::replace(&mut self.dirty, Dirty::Everything) {
            Dirty::Everything => {
                self.rebuild(&Kept { springs: &springs, rates: &[], residues: &residues })?;
                self.mark_state_edited();
            }
            Dirty::Topology => {
                let neck = self.world.step.layout.neck;
                self.world.set_topology(&self.scene)?;
                place_walls(&mut self.world, &self.scene, &self.muscle_clock);
                // AABBs grow by the length of necks.
                self.aabbs_due |= neck != self.world.step.layout.neck;
                self.lists_due |= neck != self.world.step.layout.neck;
                self.engine.upload_topology(&self.world)?;
                self.status.forces_due = 1;
            }
            Dirty::Clean => {}
        }
        if !edits.is_empty() {
            self.world.set_spheres(&self.scene);
            put_residues(&mut self.world, &residues);
            self.engine.upload_spheres(&self.world)?;
            self.mark_state_edited();
        }
        self.dirty = Dirty::Clean;
        Ok(())
    }

    /// Packs the scene again, with what it keeps. The lists keep their capacity.
    pub(super) fn rebuild(&mut self, kept: &Kept<'_>) -> Result<()> {
        let old = &self.world.step;
        let (flags, dt, rows) = (old.constants.flags, old.constants.dt, old.layout.pair_rows);
        let (own, sent) = (std::mem::take(&mut self.world.own), std::mem::take(&mut self.world.sent));
        self.scene.imply_bodies();
        self.world = pack(&self.scene, &self.options, self.time_step, self.info.kind)?;
        if own.len() == self.world.step.layout.spheres as usize {
            self.world.set_own(own, sent);
        }
        self.world.set_flags(FLAG_CONTINUE, flags);
        self.world.set_time_step(dt);
        place_walls(&mut self.world, &self.scene, &self.muscle_clock);
        self.world.set_pair_room(rows);
        kept.put(&mut self.world, &self.scene);
        self.status.forces_due = self.world.status.forces_due;
        self.status.history_table = self.world.status.history_table;
        self.engine.complete(&mut self.world);
        self.packed_ids = ids_of(&self.scene);
        self.packed = self.scene.sphere_ids().collect();
        self.packed_bodies = BodyHandles::of(&self.scene);
        self.observation = None;
        self.packings += 1;
        self.engine.replace(&self.world)?;
        self.disorder = Disorder::sorted_at(self.report.steps);
        self.aabbs_due = true;
        self.lists_due = true;
        Ok(())
    }

    pub(super) fn mark_state_edited(&mut self) {
        self.status.lengths_due = 1;
        self.status.forces_due = 1;
        self.aabbs_due = true;
        self.lists_due = true;
    }

    /// [`Simulation::sync`] without blocking.
    ///
    /// # Errors
    /// As for [`Simulation::sync`].
    pub async fn sync_async(&mut self) -> Result<&Scene> {
        self.flush_async().await?;
        self.pull().await?;
        #[cfg(feature = "gpu")]
        self.pull_forces().await?;
        Ok(&self.scene)
    }

    /// Reads the state of the spheres back into the scene.
    pub(super) async fn pull(&mut self) -> Result<()> {
        if !self.synced && self.pull_frames()? {
            self.synced = true;
        }
        if !self.synced {
            self.engine.download_spheres(&mut self.world).await?;
            self.world.read_spheres(&mut self.scene, &self.packed);
            self.world.read_bodies(&mut self.scene, &self.packed_bodies);
            self.world.read_servos(&mut self.scene);
            self.synced = true;
        }
        Ok(())
    }
}
