//! Rigid bodies: a shape with a pose and a motion. The spheres and rods of a body are objects of the scene that follow it.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use super::shape::{Kinetics, ShapeId};
use super::{Body, Cuboid, Handle, ObjectId, Rod, RodId, Scene, Shape, ShapeHull, ShapeSphere, Sphere, SphereId, Tag, shared};
use crate::error::{self, Result};
use crate::fine::Fine;
use crate::scene::checks::{finite, invalid};

/// Handle of a [`RigidBody`].
pub type RigidBodyId = Handle<RigidBody>;

/// Where a new rigid body lies and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    shape: ShapeId,
    place: Place,
    orientation: Quat,
    velocity: Vec3,
    rotation: Rotation,
    force: Vec3,
    torque: Vec3,
}

/// A point of the body, and where it comes to lie.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Origin(DVec3),
    Centre(DVec3),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Rotation {
    Spin(Vec3),
    Momentum(Vec3),
}

/// A body that moves and turns as a whole. Its spheres and rods are objects of the scene: they are listed and drawn like others, and
/// follow the body.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RigidBody {
    /// Shape.
    pub shape: ShapeId,
    /// Centre of mass, in units.
    pub position: Vec3,
    /// What is left of the centre of mass beyond the digits of `position`, in units: [`RigidBody::centre`] is their sum. Simulations use
    /// it with [`Precision::Double`](crate::settings::Precision).
    pub position_low: Vec3,
    /// Orientation, a unit quaternion. It turns coordinates of the shape into those of the world.
    pub orientation: Quat,
    /// Velocity of the centre of mass, in units/s.
    pub velocity: Vec3,
    /// Angular momentum about the centre of mass along the axes of the world, in mass units²/s.
    pub angular_momentum: Vec3,
    /// External force at the centre of mass, in mass units/s². It acts until it is changed, under the contact law `rigid` alone. The
    /// external forces of the spheres of the body come on top.
    pub force: Vec3,
    /// External torque about the centre of mass along the axes of the world, in mass units²/s². It acts as `force` does.
    pub torque: Vec3,
    pub(crate) spheres: Vec<SphereId>,
    pub(crate) rods: Vec<RodId>,
}

/// The bodies that spheres and rods are part of, by slot. The owner of a slot is a body that was removed if nothing else is right.
#[derive(Clone, Debug)]
pub(crate) struct Members<T> {
    spheres: Vec<Option<Handle<T>>>,
    rods: Vec<Option<Handle<T>>>,
}

impl<T> Default for Members<T> {
    fn default() -> Self {
        Self { spheres: Vec::new(), rods: Vec::new() }
    }
}

impl<T> Members<T> {
    pub(super) fn put(&mut self, spheres: &[SphereId], rods: &[RodId], owner: Handle<T>) {
        let slots = [
            (&mut self.spheres, spheres.iter().map(|id| id.slot()).collect::<Vec<_>>()),
            (&mut self.rods, rods.iter().map(|id| id.slot()).collect()),
        ];
        for (owners, slots) in slots {
            for slot in slots {
                if owners.len() <= slot {
                    owners.resize(slot + 1, None);
                }
                owners[slot] = Some(owner);
            }
        }
    }

    pub(super) fn of_sphere(&self, id: SphereId) -> Option<Handle<T>> {
        *self.spheres.get(id.slot())?
    }

    pub(super) fn of_rod(&self, id: RodId) -> Option<Handle<T>> {
        *self.rods.get(id.slot())?
    }
}

/// Position of the centre of mass, velocity, angular momentum about it and orientation of a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyState {
    pub(crate) position: Fine,
    pub(crate) velocity: Vec3,
    pub(crate) momentum: Vec3,
    pub(crate) orientation: Quat,
}

/// Where the points of a body are and how they move, in `f64`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// Centre of mass.
    pub(crate) centre: DVec3,
    /// Turns coordinates of the shape into those of the world.
    pub(crate) turn: DQuat,
    /// Velocity of the centre of mass, in units/s.
    pub(crate) velocity: DVec3,
    /// Angular velocity along the axes of the world, in rad/s.
    pub(crate) spin: DVec3,
}

impl Placement {
    /// Lays a body of a shape at the origin, at rest.
    pub fn new(shape: ShapeId) -> Self {
        Self {
            shape,
            place: Place::Origin(DVec3::ZERO),
            orientation: Quat::IDENTITY,
            velocity: Vec3::ZERO,
            rotation: Rotation::Spin(Vec3::ZERO),
            force: Vec3::ZERO,
            torque: Vec3::ZERO,
        }
    }

    /// Sets where the origin of the shape comes to lie, in units.
    pub fn at(mut self, origin: impl Into<DVec3>) -> Self {
        self.place = Place::Origin(origin.into());
        self
    }

    /// Sets where the centre of mass comes to lie, in units. It replaces [`Placement::at`].
    pub fn centred_at(mut self, centre: impl Into<DVec3>) -> Self {
        self.place = Place::Centre(centre.into());
        self
    }

    /// Sets the orientation, a unit quaternion that turns coordinates of the shape into those of the world.
    pub fn turned(mut self, orientation: Quat) -> Self {
        self.orientation = orientation;
        self
    }

    /// Sets the velocity of the centre of mass, in units/s.
    pub fn velocity(mut self, velocity: impl Into<Vec3>) -> Self {
        self.velocity = velocity.into();
        self
    }

    /// Sets the angular velocity along the axes of the world, in rad/s.
    pub fn spin(mut self, spin: impl Into<Vec3>) -> Self {
        self.rotation = Rotation::Spin(spin.into());
        self
    }

    /// Sets the angular momentum about the centre of mass along the axes of the world, in mass units²/s. It replaces
    /// [`Placement::spin`].
    pub fn angular_momentum(mut self, angular_momentum: impl Into<Vec3>) -> Self {
        self.rotation = Rotation::Momentum(angular_momentum.into());
        self
    }

    /// Sets the external force at the centre of mass and the external torque about it, in mass units/s² and mass units²/s²: see
    /// [`RigidBody::force`].
    pub fn force(mut self, force: impl Into<Vec3>, torque: impl Into<Vec3>) -> Self {
        (self.force, self.torque) = (force.into(), torque.into());
        self
    }
}

impl RigidBody {
    /// The centre of mass, in units: the sum of `position` and `position_low`.
    pub fn centre(&self) -> [f64; 3] {
        Fine { high: self.position, low: self.position_low }.wide().to_array()
    }

    /// Moves the centre of mass to a position with the digits of an `f64`, in units.
    pub fn set_centre(&mut self, centre: impl Into<DVec3>) {
        let Fine { high, low } = Fine::at(centre.into().to_array());
        (self.position, self.position_low) = (high, low);
    }

    /// The spheres of the body, in the order of its shape.
    pub fn spheres(&self) -> &[SphereId] {
        &self.spheres
    }

    /// The rods of the body, in the order of its shape.
    pub fn rods(&self) -> &[RodId] {
        &self.rods
    }

    pub(crate) fn state(&self) -> BodyState {
        BodyState {
            position: Fine { high: self.position, low: self.position_low },
            velocity: self.velocity,
            momentum: self.angular_momentum,
            orientation: self.orientation,
        }
    }

    pub(crate) fn set_state(&mut self, state: BodyState) {
        (self.position, self.position_low) = (state.position.high, state.position.low);
        (self.velocity, self.angular_momentum, self.orientation) = (state.velocity, state.momentum, state.orientation);
    }

    pub(crate) fn validate(&self) -> Result<()> {
        finite("body.position", self.position)?;
        finite("body.position_low", self.position_low)?;
        finite("body.velocity", self.velocity)?;
        finite("body.angular_momentum", self.angular_momentum)?;
        finite("body.force", self.force)?;
        finite("body.torque", self.torque)?;
        if !self.orientation.is_normalized() {
            let q = self.orientation;
            return Err(invalid("body.orientation", [q.w, q.x, q.y, q.z], "a unit quaternion w, x, y, z"));
        }
        Ok(())
    }
}

impl Scene {
    /// Checks that the rods suit the rigid bodies of the scene.
    pub(crate) fn check_bodies(&self) -> Result<()> {
        if self.bodies().is_empty() {
            return Ok(());
        }
        let pulls =
            |rod: &Rod| rod.length.is_some() && [rod.end1, rod.end2].into_iter().any(|end| self.body_of_sphere(end).is_some());
        if let Some((id, _)) = self.rod_ids().zip(self.rods()).find(|(_, rod)| pulls(rod)) {
            let expected = "a rod of free length, or a spring: a rod of fixed length does not pull a rigid body";
            return Err(error::Error::Invalid { field: "rod.length", value: self.name_of(Body::Rod(id)), expected });
        }
        Ok(())
    }
}

impl Kinetics {
    /// The inertia tensor along the axes of the world, of a body with an orientation.
    pub(crate) fn tensor(&self, turn: DQuat) -> DMat3 {
        self.in_world(turn, self.moments)
    }

    /// The inverse of the inertia tensor along the axes of the world.
    pub(crate) fn inverse_tensor(&self, turn: DQuat) -> DMat3 {
        self.in_world(turn, self.moments.recip())
    }

    fn in_world(&self, turn: DQuat, diagonal: DVec3) -> DMat3 {
        let axes = DMat3::from_quat(turn * self.axes);
        axes * DMat3::from_diagonal(diagonal) * axes.transpose()
    }
}

impl Frame {
    pub(crate) fn of(body: &BodyState, kinetics: &Kinetics) -> Self {
        let turn = wide(body.orientation);
        Self {
            centre: body.position.wide(),
            turn,
            velocity: body.velocity.as_dvec3(),
            spin: kinetics.inverse_tensor(turn) * body.momentum.as_dvec3(),
        }
    }

    /// Sets the state of a sphere at a point that is `arm` away from the centre of mass in coordinates of the shape.
    pub(super) fn place(&self, sphere: &mut Sphere, arm: DVec3, orientation: Quat) {
        let arm = self.turn * arm;
        sphere.set_centre((self.centre + arm).to_array());
        sphere.velocity = (self.velocity + self.spin.cross(arm)).as_vec3();
        sphere.angular_momentum = (self.spin * f64::from(sphere.inertia())).as_vec3();
        sphere.orientation = orientation;
    }
}

/// Where the coordinates of a shape lie.
pub(super) struct Laid {
    pub(super) turn: DQuat,
    pub(super) origin: DVec3,
}

impl Laid {
    pub(super) fn point(&self, place: Vec3) -> DVec3 {
        self.origin + self.turn * place.as_dvec3()
    }
}

/// A unit quaternion in `f64`.
pub(super) fn wide(orientation: Quat) -> DQuat {
    orientation.as_dquat().normalize()
}

impl Scene {
    /// Adds a rigid body: its spheres, its rods, and the body that they follow. A sphere gets the share of the mass that its volume has
    /// of that of all spheres, boxes and hulls. One sphere stands for each box and each hull.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for numbers that are not finite, an orientation that is not a unit quaternion, and a
    /// share of the mass that a sphere may not have. [`Error::StaleHandle`](crate::Error::StaleHandle) for a shape that is not in the
    /// scene.
    pub fn add_body(&mut self, placement: Placement) -> Result<RigidBodyId> {
        let (mut body, spheres) = self.laid(placement)?;
        let shape = self.shapes.get(placement.shape)?;
        let (parts, rods) = (shape.all_spheres(), shape.rods.clone());
        for (sphere, ShapeSphere { tag, .. }) in spheres.into_iter().zip(parts) {
            let id = self.spheres.add(sphere);
            body.spheres.push(id);
            if tag.is_some() {
                self.put_tag(id.into(), tag)?;
            }
        }
        for part in rods {
            let [end1, end2] = [part.end1, part.end2].map(|end| body.spheres[end]);
            let rod = Rod { group: part.group, material: part.material, ..Rod::new(end1, end2, part.radius) };
            let id = self.rods.add(rod);
            body.rods.push(id);
            if part.tag.is_some() {
                self.put_tag(id.into(), part.tag)?;
            }
        }
        Ok(self.keep_body(body))
    }

    /// A body where it is laid, which has no parts yet, and its spheres. Fails as [`Scene::add_body`].
    pub(super) fn laid(&self, placement: Placement) -> Result<(RigidBody, Vec<Sphere>)> {
        let kinetics = *self.shape_mass(placement.shape)?;
        let mut body = RigidBody {
            shape: placement.shape,
            position: Vec3::ZERO,
            position_low: Vec3::ZERO,
            orientation: placement.orientation,
            velocity: placement.velocity,
            angular_momentum: Vec3::ZERO,
            force: placement.force,
            torque: placement.torque,
            spheres: Vec::new(),
            rods: Vec::new(),
        };
        let turn = wide(placement.orientation);
        body.set_centre(match placement.place {
            Place::Centre(centre) => centre,
            Place::Origin(origin) => origin + turn * kinetics.centre,
        });
        body.angular_momentum = match placement.rotation {
            Rotation::Momentum(momentum) => momentum,
            Rotation::Spin(spin) => (kinetics.tensor(turn) * spin.as_dvec3()).as_vec3(),
        };
        body.validate()?;
        let shape = self.shapes.get(placement.shape)?;
        let spheres = members(shape, &shape.all_spheres(), &body, &kinetics);
        spheres.iter().try_for_each(Sphere::validate)?;
        Ok((body, spheres))
    }

    /// Adds a body whose spheres and rods are in the scene already.
    pub(crate) fn keep_body(&mut self, body: RigidBody) -> RigidBodyId {
        let (spheres, rods) = (body.spheres.clone(), body.rods.clone());
        let id = self.bodies.add(body);
        self.members.put(&spheres, &rods, id);
        id
    }

    /// Changes the pose and the motion of a rigid body. Its shape cannot be changed. Its spheres follow.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when it is not in the scene, [`Error::Invalid`](crate::Error::Invalid) for
    /// numbers that are not finite, an orientation that is not a unit quaternion, and a motion with which a sphere of the body would not
    /// be finite. Nothing is changed then.
    pub fn update_body(&mut self, id: RigidBodyId, change: impl FnOnce(&mut RigidBody)) -> Result<()> {
        let before = self.bodies.get(id)?;
        let mut body = before.clone();
        change(&mut body);
        (body.shape, body.spheres, body.rods) = (before.shape, before.spheres.clone(), before.rods.clone());
        body.validate()?;
        let before = std::mem::replace(self.bodies.get_mut(id)?, body);
        self.place_members(id)?;
        let spheres = before.spheres.iter().map(|sphere| self.spheres.get(*sphere)?.validate());
        if let Err(error) = spheres.collect::<Result<()>>() {
            *self.bodies.get_mut(id)? = before;
            self.place_members(id)?;
            return Err(error);
        }
        Ok(())
    }

    /// The rigid body with the pose and the motion that it has when its first sphere has the position, the velocity, the orientation and
    /// the angular momentum of `sphere`: what the states of spheres in a file say about it.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when it is not in the scene.
    pub fn body_with_sphere(&self, id: RigidBodyId, sphere: &Sphere) -> Result<RigidBody> {
        let mut body = self.bodies.get(id)?.clone();
        let kinetics = self.shape_mass(body.shape)?;
        let first = self.shapes.get(body.shape)?.all_spheres()[0].centre.as_dvec3();
        let turn = wide(sphere.orientation);
        let (arm, spin) = (turn * (first - kinetics.centre), sphere.angular_momentum.as_dvec3() / f64::from(sphere.inertia()));
        body.set_centre(DVec3::from_array(sphere.centre()) - arm);
        body.orientation = sphere.orientation;
        body.velocity = (sphere.velocity.as_dvec3() - spin.cross(arm)).as_vec3();
        body.angular_momentum = (kinetics.tensor(turn) * spin).as_vec3();
        Ok(body)
    }

    /// The angular velocity of a rigid body along the axes of the world, in rad/s.
    ///
    /// # Errors
    /// [`Error::StaleHandle`](crate::Error::StaleHandle) when it is not in the scene.
    pub fn body_spin(&self, id: RigidBodyId) -> Result<Vec3> {
        Ok(self.frame(id)?.spin.as_vec3())
    }

    /// Sets the angular velocity of a rigid body along the axes of the world, in rad/s.
    ///
    /// # Errors
    /// As for [`Scene::update_body`].
    pub fn set_body_spin(&mut self, id: RigidBodyId, spin: impl Into<Vec3>) -> Result<()> {
        let body = self.bodies.get(id)?;
        let momentum = self.shape_mass(body.shape)?.tensor(wide(body.orientation)) * spin.into().as_dvec3();
        self.update_body(id, |body| body.angular_momentum = momentum.as_vec3())
    }

    /// Applies an impulse at a point of a rigid body, in mass units/s: the velocity changes by impulse / mass, and the angular momentum
    /// by the moment of the impulse about the centre of mass.
    ///
    /// # Errors
    /// As for [`Scene::update_body`].
    pub fn apply_body_impulse(&mut self, id: RigidBodyId, impulse: impl Into<Vec3>, point: impl Into<DVec3>) -> Result<()> {
        let (impulse, point) = (impulse.into().as_dvec3(), point.into());
        let body = self.bodies.get(id)?;
        let mass = self.shape_mass(body.shape)?.mass;
        let moment = (point - DVec3::from_array(body.centre())).cross(impulse);
        self.update_body(id, |body| {
            body.velocity = (body.velocity.as_dvec3() + impulse / mass).as_vec3();
            body.angular_momentum = (body.angular_momentum.as_dvec3() + moment).as_vec3();
        })
    }

    /// Adds a force at a point of a rigid body, in mass units/s², to its external force and torque: see [`RigidBody::force`]. It acts
    /// until these are changed, and does not follow the point.
    ///
    /// # Errors
    /// As for [`Scene::update_body`].
    pub fn add_body_force(&mut self, id: RigidBodyId, force: impl Into<Vec3>, point: impl Into<DVec3>) -> Result<()> {
        let (force, point) = (force.into(), point.into());
        self.update_body(id, |body| {
            body.force += force;
            let moment = (point - DVec3::from_array(body.centre())).cross(force.as_dvec3());
            body.torque = (body.torque.as_dvec3() + moment).as_vec3();
        })
    }

    /// The rigid body that a sphere is part of.
    pub fn body_of_sphere(&self, id: SphereId) -> Option<RigidBodyId> {
        let owner = self.members.of_sphere(id)?;
        (self.spheres.index(id).is_ok() && self.bodies.index(owner).is_ok()).then_some(owner)
    }

    /// The rigid body that a rod is part of.
    pub fn body_of_rod(&self, id: RodId) -> Option<RigidBodyId> {
        let owner = self.members.of_rod(id)?;
        (self.rods.index(id).is_ok() && self.bodies.index(owner).is_ok()).then_some(owner)
    }

    /// The number, in its shape, of the box of a rigid body that a sphere stands for: `None` for other spheres. The
    /// sphere contains the box, and has its centre and the orientation of the body.
    pub fn box_of_sphere(&self, id: SphereId) -> Option<usize> {
        let body = self.bodies.get(self.body_of_sphere(id)?).ok()?;
        let shape = self.shapes.get(body.shape).ok().filter(|shape| !shape.boxes.is_empty())?;
        // The spheres of a body follow each other in the scene.
        let first = self.spheres.index(*body.spheres.first()?).ok()?;
        shape.box_of_sphere(self.spheres.index(id).ok()? - first)
    }

    /// Number of hulls of all rigid bodies.
    pub(super) fn hull_count(&self) -> usize {
        if self.shapes().iter().all(|shape| shape.hulls.is_empty()) {
            return 0;
        }
        let of_body = |body: &RigidBody| self.shapes.get(body.shape).map_or(0, |shape| shape.hulls.len());
        self.bodies().iter().map(of_body).sum()
    }

    /// The hull of a rigid body that a sphere stands for: `None` for other spheres. The sphere contains the hull, and has the centre of its
    /// volume and the orientation of the body.
    pub fn hull_of_sphere(&self, id: SphereId) -> Option<&ShapeHull> {
        let body = self.bodies.get(self.body_of_sphere(id)?).ok()?;
        let shape = self.shapes.get(body.shape).ok().filter(|shape| !shape.hulls.is_empty())?;
        let first = self.spheres.index(*body.spheres.first()?).ok()?;
        Some(&shape.hulls[shape.hull_of_sphere(self.spheres.index(id).ok()? - first)?])
    }

    /// A box of a rigid body, with the corner and the edges that it has now, by the sphere that stands for it. `None` for other spheres.
    pub fn box_at(&self, id: SphereId) -> Option<Cuboid> {
        let number = self.box_of_sphere(id)?;
        let owner = self.body_of_sphere(id)?;
        let (body, frame) = (self.bodies.get(owner).ok()?, self.frame(owner).ok()?);
        let cuboid = self.shapes.get(body.shape).ok()?.boxes[number].cuboid;
        let arm = cuboid.corner.as_dvec3() - self.shape_mass(body.shape).ok()?.centre;
        let corner = (frame.centre + frame.turn * arm).as_vec3();
        Some(Cuboid { corner, edges: cuboid.edges.map(|edge| (frame.turn * edge.as_dvec3()).as_vec3()), ..cuboid })
    }

    /// Where a body is and how it moves.
    pub(crate) fn frame(&self, id: RigidBodyId) -> Result<Frame> {
        let body = self.bodies.get(id)?;
        Ok(Frame::of(&body.state(), self.shape_mass(body.shape)?))
    }

    /// Gives the spheres of a body the places and motions that follow from it.
    pub(crate) fn place_members(&mut self, id: RigidBodyId) -> Result<()> {
        let body = self.bodies.get(id)?;
        let (shape, kinetics) = (self.shapes.get(body.shape)?, *self.shape_mass(body.shape)?);
        let frame = Frame::of(&body.state(), &kinetics);
        for (member, part) in body.spheres.iter().zip(shape.all_spheres()) {
            frame.place(self.spheres.get_mut(*member)?, part.centre.as_dvec3() - kinetics.centre, body.orientation);
        }
        Ok(())
    }

    /// Sets the state of a loose sphere.
    pub(crate) fn put_sphere(&mut self, id: SphereId, state: &BodyState) -> Result<()> {
        let sphere = self.spheres.get_mut(id)?;
        (sphere.position, sphere.position_low) = (state.position.high, state.position.low);
        (sphere.velocity, sphere.angular_momentum, sphere.orientation) = (state.velocity, state.momentum, state.orientation);
        Ok(())
    }

    /// Sets the state of a body. Its spheres follow.
    pub(crate) fn put_body(&mut self, id: RigidBodyId, state: BodyState) -> Result<()> {
        self.bodies.get_mut(id)?.set_state(state);
        self.place_members(id)
    }

    /// Gives the spheres of all bodies the places and motions that follow from the bodies.
    pub(crate) fn place_all_members(&mut self) {
        let ids: Vec<RigidBodyId> = self.body_ids().collect();
        for id in ids {
            // All of them are in the scene.
            let _ = self.place_members(id);
        }
    }

    /// Rounds the positions of spheres and bodies to `f32`.
    pub(crate) fn round_positions(&mut self) {
        for body in self.bodies.objects_mut() {
            body.position_low = Vec3::ZERO;
        }
        self.place_all_members();
        for sphere in self.spheres.objects_mut() {
            sphere.position_low = Vec3::ZERO;
        }
    }

    /// The tags of the spheres and rods of a body with a tag.
    pub(super) fn tags_of_members(&self, id: RigidBodyId, tag: &Option<Arc<Tag>>) -> Result<Vec<(ObjectId, Option<Arc<Tag>>)>> {
        let body = self.bodies.get(id)?;
        let shape = self.shapes.get(body.shape)?;
        let both = |own: &Option<Arc<Tag>>| match (own, tag) {
            (Some(own), Some(tag)) => shared(own.or(tag)),
            (own, tag) => own.clone().or_else(|| tag.clone()),
        };
        let spheres = body.spheres.iter().zip(shape.all_spheres()).map(|(id, part)| (ObjectId::from(*id), both(&part.tag)));
        let rods = body.rods.iter().zip(&shape.rods).map(|(id, part)| (ObjectId::from(*id), both(&part.tag)));
        Ok(spheres.chain(rods).collect())
    }
}

/// The spheres of a new body. `parts` are all spheres of its shape.
fn members(shape: &Shape, parts: &[ShapeSphere], body: &RigidBody, kinetics: &Kinetics) -> Vec<Sphere> {
    let frame = Frame::of(&body.state(), kinetics);
    let volume = |(number, part): (usize, &ShapeSphere)| match shape.box_of_sphere(number) {
        Some(of) => shape.boxes[of].volume(),
        None if shape.hull_of_sphere(number).is_some() => shape.hulls[number - shape.first_hull()].volume(),
        None => 4.0 / 3.0 * std::f64::consts::PI * f64::from(part.radius).powi(3),
    };
    let volumes: Vec<f64> = parts.iter().enumerate().map(volume).collect();
    let all: f64 = volumes.iter().sum();
    let member = |(part, volume): (&ShapeSphere, f64)| {
        let mass = kinetics.mass * volume / all;
        let mut sphere = Sphere::new(part.centre, part.radius).mass(mass as f32).group(part.group);
        sphere.material = part.material;
        frame.place(&mut sphere, part.centre.as_dvec3() - kinetics.centre, body.orientation);
        sphere
    };
    parts.iter().zip(volumes).map(member).collect()
}

#[cfg(test)]
#[path = "rigid_tests.rs"]
mod tests;
