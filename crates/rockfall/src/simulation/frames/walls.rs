//! Colliders of what never moves or follows a motion: boxes, polygons, fixed spheres and the rods between them.

use std::collections::HashSet;

use glam::{DQuat, DVec3, Vec3};

use super::build::{Builder, segment};
use super::facets::{self, Facet};
use crate::error::Result;
use crate::rigid::pose::Pose;
use crate::rigid::shape::Core;
use crate::rigid::world::Kind;
use crate::scene::{Body as Part, MotionId, Polygon, PolygonId, SphereId, Surface, upright};

impl Builder<'_> {
    /// Colliders of the world and of motions.
    pub(super) fn walls(&mut self) -> Result<()> {
        for (id, cuboid) in self.scene.box_ids().zip(self.scene.boxes()) {
            let (body, origin) = self.carrier(cuboid.motion)?;
            let (centre, turn, half) = cuboid.frame();
            let place = Pose::new((centre - origin).as_vec3(), turn.as_quat());
            let shape = self.shape(Core::Box { half: half.as_vec3() }, 0.0);
            let collider = self.collider(Part::Box(id), body, shape, place, (cuboid.group, cuboid.material))?;
            collider.surface_velocity = cuboid.surface_velocity;
            self.widen(body);
        }
        for (id, polygon) in self.scene.polygon_ids().zip(self.scene.polygons()) {
            self.polygon(id, polygon)?;
        }
        let ends = self.fixed_rods()?;
        for (id, sphere) in self.scene.sphere_ids().zip(self.scene.spheres()) {
            if sphere.fixed && !ends.contains(&id) {
                let shape = self.shape(Core::Point, sphere.radius);
                let place = Pose::new(self.local(sphere.centre().into()), sphere.orientation);
                self.collider(Part::Sphere(id), 0, shape, place, (sphere.group, sphere.material))?;
            }
        }
        Ok(())
    }

    fn polygon(&mut self, id: PolygonId, polygon: &Polygon) -> Result<()> {
        let (body, origin) = self.carrier(polygon.motion)?;
        let [corner, left, right] = [polygon.corner, polygon.left, polygon.right].map(|vector| vector.as_dvec3());
        let corner = corner - origin;
        let cores = match polygon.surface {
            Surface::Ball { inside: false } => {
                let shape = self.shape(Core::Point, left.length() as f32);
                return self.wall(id, polygon, (body, shape), Pose::new(corner.as_vec3(), glam::Quat::IDENTITY));
            }
            // Balls touch the wall itself, and everything else its facets.
            Surface::Ball { inside: true } => {
                let bowl = Core::Bowl { radius: left.length() as f32 };
                let facets = facets::of_bowl(corner, left.length());
                with_facets((bowl, Pose::new(corner.as_vec3(), glam::Quat::IDENTITY)), &facets)
            }
            Surface::Cone { inside } => {
                let Some(axis) = polygon.cone_axis() else { return Ok(()) };
                let turn = DQuat::from_rotation_arc(DVec3::Y, axis.along.normalize());
                let radii = axis.radii.map(|radius| radius.max(0.0) as f32);
                let facets = facets::of_cone(corner, &axis, right, inside);
                let cone = Core::Cone { half: (0.5 * axis.along.length()) as f32, radii, inside };
                let place = Pose::new((corner + 0.5 * axis.along).as_vec3(), turn.as_quat());
                // In a narrow cone a ball touches several places at once.
                let is_narrow = inside && radii[0].min(radii[1]) < 2.0 * self.greatest_ball();
                if is_narrow {
                    facets.iter().map(|facet| face(facet, true, false)).collect()
                } else {
                    with_facets((cone, place), &facets)
                }
            }
            Surface::Plane => {
                let turn = DQuat::from_rotation_arc(DVec3::Y, left.cross(right).normalize());
                vec![(Core::HalfSpace, Pose::new(corner.as_vec3(), turn.as_quat()))]
            }
            Surface::Parallelogram => vec![face(&Facet { corner, left, right, is_triangle: false }, true, false)],
            Surface::Triangle => vec![face(&Facet { corner, left, right, is_triangle: true }, false, false)],
        };
        for (core, place) in cores {
            let shape = self.shape(core, 0.0);
            self.wall(id, polygon, (body, shape), place)?;
        }
        Ok(())
    }

    /// A collider of a polygon.
    fn wall(&mut self, id: PolygonId, polygon: &Polygon, (body, shape): (u32, u32), place: Pose) -> Result<()> {
        let collider = self.collider(Part::Polygon(id), body, shape, place, (polygon.group, polygon.material))?;
        collider.surface_velocity = polygon.surface_velocity;
        self.widen(body);
        Ok(())
    }

    /// The radius of the greatest ball that may touch a wall, in units.
    fn greatest_ball(&self) -> f32 {
        let own = self.scene.spheres().iter().filter(|sphere| !sphere.fixed).map(|sphere| sphere.radius);
        let to_come = self.scene.inlets().iter().flat_map(|inlet| &inlet.kinds).map(|(kind, _)| match kind.shape {
            Some(shape) => self
                .scene
                .shape(shape)
                .map_or(0.0, |shape| shape.spheres.iter().map(|sphere| sphere.radius).fold(0.0, f32::max)),
            None => kind.radii.bounds(kind.by).1 as f32,
        });
        own.chain(to_come).fold(0.0, f32::max)
    }

    /// Capsules that never move: rods between fixed spheres. Returns the spheres that are a part of them.
    fn fixed_rods(&mut self) -> Result<HashSet<SphereId>> {
        let mut covered = HashSet::new();
        for (id, rod) in self.scene.rod_ids().zip(self.scene.rods()) {
            let [one, other] = [self.scene.sphere(rod.end1)?, self.scene.sphere(rod.end2)?];
            if !(one.fixed && other.fixed) {
                continue;
            }
            let (half, place) = segment(one.position.as_dvec3() - self.base, other.position.as_dvec3() - self.base);
            let shape = self.shape(Core::Segment { half }, rod.radius);
            self.collider(Part::Rod(id), 0, shape, place, (rod.group, rod.material))?;
            for (id, sphere) in [(rod.end1, one), (rod.end2, other)] {
                if sphere.radius <= rod.radius && (sphere.material, sphere.group) == (rod.material, rod.group) {
                    covered.insert(id);
                }
            }
        }
        Ok(covered)
    }

    /// The body that carries a wall, and where its origin lies before any motion.
    fn carrier(&self, motion: Option<MotionId>) -> Result<(u32, DVec3)> {
        let number = self.scene.body_number(motion)?;
        Ok((number, number.checked_sub(1).map_or(self.base, |motion| self.origins[motion as usize])))
    }

    /// Lets the radius of a body that carries walls reach the last collider. Planes have no end, and do not turn.
    fn widen(&mut self, body: u32) {
        let Some(collider) = self.world.colliders.last() else { return };
        let reach = collider.place.position.length() + self.world.shapes[collider.shape as usize].extent();
        let body = &mut self.world.bodies[body as usize];
        if body.kind == Kind::Kinematic && reach.is_finite() {
            body.radius = body.radius.max(reach);
        }
    }
}

/// A smooth wall for balls, and its facets for everything else.
fn with_facets(wall: (Core, Pose), facets: &[Facet]) -> Vec<(Core, Pose)> {
    std::iter::once(wall).chain(facets.iter().map(|facet| face(facet, true, true))).collect()
}

/// The core of a face, and its place.
fn face(facet: &Facet, one_sided: bool, is_facet: bool) -> (Core, Pose) {
    let Facet { corner, left, right, is_triangle } = *facet;
    let turn = upright(left, left.cross(right).normalize().cross(left));
    let inner = |edge: DVec3| (turn.inverse() * edge).as_vec3() * Vec3::new(1.0, 1.0, 0.0);
    let centre = (left + right) / if is_triangle { 3.0 } else { 2.0 };
    let [u, v] = if is_triangle { [-centre, left - centre] } else { [0.5 * left, 0.5 * right] }.map(inner);
    (Core::Face { u, v, is_triangle, one_sided, is_facet }, Pose::new((corner + centre).as_vec3(), turn.as_quat()))
}
