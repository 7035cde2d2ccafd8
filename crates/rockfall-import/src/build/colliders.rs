//! Geoms as parts of shapes and as walls.

use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{Cuboid, Look, MaterialId, Mesh, Placement, Polygon, Shape, Tag};

use crate::error::Result;
use crate::mass::Pose;
use crate::model::Geom;
use crate::solid::{Solid, surface};

use super::Builder;
use super::bodies::Body;
use super::contacts::Contacts;

impl Builder<'_> {
    /// The shape of a body.
    pub(super) fn shape(&mut self, body: &Body, number: usize) -> Result<Shape> {
        let [xx, yy, zz, xy, xz, yz] = body.mass.elements().map(|element| element as f32);
        let centre = body.mass.centre.as_vec3();
        let mut shape = Shape::new().name(&body.name).mass_properties(body.mass.mass as f32, centre, [xx, yy, zz, xy, xz, yz]);
        let meets = body.geoms.iter().any(|geom| self.contacts.group(geom).is_some());
        let own = Contacts::own_group(number);
        for geom in &body.geoms {
            let group = self.contacts.group(geom);
            if meets && group.is_none() {
                self.notes.add(&geom.element, "it touches nothing in the file, so it is left out");
                continue;
            }
            let material = self.contacts.material(geom);
            shape = self.with_geom(shape, geom, group.unwrap_or(own), material)?;
        }
        if shape.spheres.is_empty() && shape.boxes.is_empty() && shape.hulls.is_empty() {
            // As large as a ball of this mass and inertia.
            let radius = (2.5 * (xx + yy + zz) / 3.0 / body.mass.mass as f32).sqrt();
            // Glass, because it is no part of the robot.
            shape = shape.group(own).tag(Tag::new().look(Look::Glass)).sphere(centre, radius.max(1e-6));
            if !body.is_between {
                self.notes.add(
                    &body.element,
                    format!("{} has no collision geometry, so it is a ball that touches nothing", body.name),
                );
            }
        }
        Ok(shape)
    }

    fn with_geom(&mut self, shape: Shape, geom: &Geom, group: u16, material: Option<MaterialId>) -> Result<Shape> {
        let mut shape = shape.group(group);
        if let Some(material) = material {
            shape = shape.material(material);
        }
        let point = |point: DVec3| geom.pose.rounded(point);
        Ok(match &geom.solid {
            Solid::Sphere { radius } => shape.sphere(point(DVec3::ZERO), *radius as f32),
            Solid::Capsule { radius, half } if *half > 1e-6 * radius => {
                let ends = [-*half, *half].map(|z| point(DVec3::new(0.0, 0.0, z)));
                shape.capsule(ends[0], ends[1], *radius as f32)
            }
            Solid::Capsule { radius, .. } => shape.sphere(point(DVec3::ZERO), *radius as f32),
            Solid::Box { half } => shape.cuboid(cuboid(&geom.pose, *half)),
            Solid::Plane => {
                self.notes.add(&geom.element, "the plane is left out: only the world has planes");
                shape
            }
            solid => {
                self.note_hull(geom);
                let points = solid.hull().unwrap_or_default();
                let hull = shape.add_hull(points.into_iter().map(point));
                hull.map_err(|error| geom.element.wrong(error.to_string()))?
            }
        })
    }

    fn note_hull(&mut self, geom: &Geom) {
        match geom.solid {
            Solid::Cylinder { .. } => {
                self.notes.replaced(&geom.element, "cylinders are prisms of 16 sides with the same volume");
            }
            Solid::Ellipsoid { .. } => self.notes.replaced(&geom.element, "ellipsoids are hulls of 16 points on them"),
            Solid::Mesh(_) => self.notes.replaced(&geom.element, "meshes are the convex hulls of their vertices"),
            _ => {}
        }
    }

    /// Adds the walls: geoms that are fixed to the world.
    pub(super) fn add_world(&mut self, bodies: &[Body]) -> Result<()> {
        for geom in &bodies[0].geoms {
            match self.contacts.group(geom) {
                Some(group) => self.add_wall(geom, group)?,
                None => self.notes.add(&geom.element, "it is fixed and touches nothing, so it is left out"),
            }
        }
        Ok(())
    }

    fn add_wall(&mut self, geom: &Geom, group: u16) -> Result<()> {
        let material = self.contacts.material(geom);
        let wrong = |error: rockfall::Error| geom.element.wrong(error.to_string());
        match &geom.solid {
            Solid::Plane => {
                let mut plane = Polygon::plane(geom.pose.at.as_vec3(), (geom.pose.turn * DVec3::Z).as_vec3());
                (plane.group, plane.material) = (group, material);
                self.scene.add_polygon(plane).map_err(wrong)?;
            }
            Solid::Sphere { .. } | Solid::Capsule { .. } | Solid::Box { .. } => {
                let shape = self.with_geom(Shape::new(), geom, group, material)?;
                let shape = self.scene.add_shape(shape).map_err(wrong)?;
                let place = Placement::new(shape).at(Vec3::ZERO.as_dvec3()).turned(Quat::IDENTITY);
                self.scene.add_static_body(place, None).map_err(wrong)?;
            }
            solid => {
                self.note_hull(geom);
                let points: Vec<DVec3> =
                    solid.hull().unwrap_or_default().into_iter().map(|point| geom.pose.point(point)).collect();
                let Some((corners, triangles)) = surface(&points) else {
                    return Err(geom.element.wrong("the engine does not take its hull, expected points that span a volume"));
                };
                let mesh =
                    Mesh::new(corners.iter().map(|corner| corner.as_vec3().to_array()).collect(), triangles).map_err(wrong)?;
                let with = |triangle: Polygon| {
                    let triangle = triangle.group(group);
                    material.map_or(triangle, |material| triangle.material(material))
                };
                self.scene.add_mesh(&mesh, with).map_err(wrong)?;
            }
        }
        Ok(())
    }
}

fn cuboid(pose: &Pose, half: DVec3) -> Cuboid {
    let edge = |axis: DVec3| (pose.turn * (2.0 * half * axis)).as_vec3();
    Cuboid::new(pose.rounded(-half), edge(DVec3::X), edge(DVec3::Y), edge(DVec3::Z))
}
