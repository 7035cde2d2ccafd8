//! Bodies that do not move by forces: the parts of a shape as fixed spheres, rods and boxes, or as walls that follow a motion.

use glam::{DVec3, Vec3};

use super::rigid::{Laid, wide};
use super::{Cuboid, MotionId, ObjectId, Placement, Polygon, Rod, Scene, Shape, ShapeRod, ShapeSphere, Sphere, Tag};
use crate::error::Result;
use crate::scene::checks::invalid;

impl Scene {
    /// Adds the parts of a shape at a place where they stay, or from which they follow a motion. Returns the objects that they become, in the
    /// order spheres, rods, boxes, hulls.
    ///
    /// Without a motion, spheres become fixed spheres, with rods between them. Parts that follow a motion are walls: a sphere becomes a
    /// [ball](Polygon::ball), a rod a [cylinder](Polygon::cylinder). In both cases boxes are boxes with sharp edges, and a hull becomes the
    /// triangles of its surface.
    ///
    /// # Errors
    /// As for [`Scene::add_body`], and [`Error::Invalid`](crate::Error::Invalid) for a velocity or spin of the placement: only a motion moves
    /// such a body. [`Error::StaleHandle`](crate::Error::StaleHandle) for a motion that is not in the scene. Nothing is added then.
    pub fn add_static_body(&mut self, placement: Placement, motion: Option<MotionId>) -> Result<Vec<ObjectId>> {
        let (body, _) = self.laid(placement)?;
        if body.velocity != Vec3::ZERO || body.angular_momentum != Vec3::ZERO {
            let value = [body.velocity, body.angular_momentum];
            return Err(invalid(
                "placement.velocity",
                value,
                "no velocity and no spin: a static body moves by its motion alone",
            ));
        }
        self.body_number(motion)?;
        let (shape, centre) = (self.shapes.get(body.shape)?.clone(), self.shape_mass(body.shape)?.centre);
        let (turn, origin) = (wide(body.orientation), DVec3::from_array(body.centre()) - wide(body.orientation) * centre);
        let laid = Laid { turn, origin };
        let mut added = Vec::new();
        if let Err(error) = self.add_parts(&shape, &laid, motion, &mut added) {
            self.remove_parts(&added)?;
            return Err(error);
        }
        Ok(added)
    }

    fn add_parts(&mut self, shape: &Shape, laid: &Laid, motion: Option<MotionId>, added: &mut Vec<ObjectId>) -> Result<()> {
        match motion {
            None => self.add_fixed_parts(shape, laid, added)?,
            Some(motion) => self.add_moving_parts(shape, laid, motion, added)?,
        }
        for part in &shape.boxes {
            let Cuboid { corner, edges, .. } = part.cuboid;
            let edges = edges.map(|edge| (laid.turn * edge.as_dvec3()).as_vec3());
            let id = self.add_box(Cuboid { corner: laid.point(corner).as_vec3(), edges, motion, ..part.cuboid })?;
            added.push(id.into());
            self.put_tag(id.into(), part.tag.clone())?;
        }
        for part in &shape.hulls {
            let corners = part.triangles().map(|corners| corners.map(|corner| laid.point(corner).as_vec3()));
            for [a, b, c] in corners {
                let wall = Polygon { group: part.group(), material: part.material(), motion, ..Polygon::triangle(a, b, c) };
                // A face is divided into triangles, and rounding may leave one without an area.
                if wall.validate().is_err() {
                    continue;
                }
                let id = self.add_polygon(wall)?;
                added.push(id.into());
                self.put_tag(id.into(), part.tag.clone())?;
            }
        }
        Ok(())
    }

    fn remove_parts(&mut self, parts: &[ObjectId]) -> Result<()> {
        for id in parts {
            match id {
                // Takes its rods along.
                ObjectId::Sphere(id) => self.remove_sphere(*id)?,
                ObjectId::Box(id) => self.remove_box(*id)?,
                ObjectId::Polygon(id) => self.remove_polygon(*id)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn add_fixed_parts(&mut self, shape: &Shape, laid: &Laid, added: &mut Vec<ObjectId>) -> Result<()> {
        let mut spheres = Vec::with_capacity(shape.spheres.len());
        for ShapeSphere { centre, radius, group, material, tag } in &shape.spheres {
            let mut sphere = Sphere::new(Vec3::ZERO, *radius).group(*group);
            (sphere.fixed, sphere.material) = (true, *material);
            sphere.set_centre(laid.point(*centre).to_array());
            let id = self.add_sphere(sphere)?;
            spheres.push(id);
            added.push(id.into());
            self.put_tag(id.into(), tag.clone())?;
        }
        for ShapeRod { end1, end2, radius, group, material, tag } in &shape.rods {
            let rod = Rod { group: *group, material: *material, ..Rod::new(spheres[*end1], spheres[*end2], *radius) };
            let id = self.add_rod(rod)?;
            added.push(id.into());
            self.put_tag(id.into(), tag.clone())?;
        }
        Ok(())
    }

    fn add_moving_parts(&mut self, shape: &Shape, laid: &Laid, motion: MotionId, added: &mut Vec<ObjectId>) -> Result<()> {
        let balls = shape.spheres.iter().map(|ShapeSphere { centre, radius, group, material, tag }| {
            let wall = Polygon::ball(laid.point(*centre).as_vec3(), *radius);
            (Polygon { group: *group, material: *material, ..wall }, tag)
        });
        let cylinders = shape.rods.iter().map(|ShapeRod { end1, end2, radius, group, material, tag }| {
            let [from, to] = [end1, end2].map(|end| laid.point(shape.spheres[*end].centre));
            let wall = Polygon::cylinder(from.as_vec3(), (to - from).as_vec3(), *radius, from.distance(to) as f32);
            (Polygon { group: *group, material: *material, ..wall }, tag)
        });
        for (wall, tag) in balls.chain(cylinders) {
            let id = self.add_polygon(Polygon { motion: Some(motion), ..wall })?;
            added.push(ObjectId::from(id));
            self.put_tag(id.into(), tag.clone())?;
        }
        Ok(())
    }

    /// Gives the parts of a static body what their shape does not say.
    pub(crate) fn tag_parts(&mut self, parts: &[ObjectId], tag: &Tag) -> Result<()> {
        for id in parts {
            let own = self.tag(*id)?.cloned().unwrap_or_default();
            self.set_tag(*id, own.or(tag))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, MotionTerm};

    fn scene() -> (Scene, Placement) {
        let mut scene = Scene::new();
        let cube = Cuboid::between([1.0, -0.5, -0.5], [2.0, 0.5, 0.5]);
        let shape = Shape::new()
            .capsule([0.0; 3], [1.0, 0.0, 0.0], 0.25)
            .cuboid(cube)
            .tag(Tag::new().name("tip"))
            .sphere([3.0, 0.0, 0.0], 0.5);
        let shape = scene.add_shape(shape).unwrap();
        // x becomes y.
        (scene, Placement::new(shape).at([1.0, 2.0, 3.0]).turned(glam::Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)))
    }

    #[test]
    fn parts_of_a_fixed_body_lie_where_those_of_a_body_would() {
        let (mut scene, placement) = scene();
        let added = scene.add_static_body(placement, None).unwrap();
        scene.tag_parts(&added, &Tag::new().name("arm")).unwrap();
        assert_eq!((scene.spheres().len(), scene.rods().len(), scene.boxes().len(), added.len()), (3, 1, 1, 5));
        assert!(scene.spheres().iter().all(|sphere| sphere.fixed) && scene.bodies().is_empty());
        assert!(scene.spheres()[2].position.distance(Vec3::new(1.0, 5.0, 3.0)) < 1e-6);
        assert!(scene.boxes()[0].corner.distance(Vec3::new(1.5, 3.0, 2.5)) < 1e-6, "{:?}", scene.boxes()[0].corner);
        assert!(scene.boxes()[0].edges[0].distance(Vec3::Y) < 1e-6);
        assert_eq!((scene.named("arm").unwrap().len(), scene.named("tip").unwrap().len()), (4, 1));
    }

    #[test]
    fn parts_that_follow_a_motion_are_walls() {
        let (mut scene, placement) = scene();
        let motion = scene.add_motion(Motion::new("arm", MotionTerm::turn(2.0, DVec3::Z, DVec3::ZERO))).unwrap();
        let added = scene.add_static_body(placement, Some(motion)).unwrap();
        assert_eq!((scene.spheres().len(), scene.polygons().len(), scene.boxes().len(), added.len()), (0, 4, 1, 5));
        let moves = scene.polygons().iter().map(|wall| wall.motion).chain(scene.boxes().iter().map(|wall| wall.motion));
        assert!(moves.into_iter().all(|of| of == Some(motion)));
    }

    #[test]
    fn a_static_hull_is_its_surface() {
        let mut scene = Scene::new();
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]].map(Vec3::from);
        let shape = scene.add_shape(Shape::new().tag(Tag::new().name("wedge")).add_hull(corners).unwrap()).unwrap();
        let added = scene.add_static_body(Placement::new(shape).at([0.0, 5.0, 0.0]), None).unwrap();
        // Two triangles below, and the four sides of the pyramid.
        assert_eq!((scene.polygons().len(), added.len()), (6, 6));
        let area = |wall: &Polygon| 0.5 * wall.left.cross(wall.right).length();
        let expected = 1.0 + 2.0 * 0.5 + 2.0 * 0.5_f32.sqrt();
        assert!((scene.polygons().iter().map(area).sum::<f32>() - expected).abs() < 1e-5);
        assert!(scene.polygons().iter().all(|wall| wall.is_triangle() && wall.corner.y >= 4.9));
        assert_eq!(scene.named("wedge").unwrap().len(), 6);
    }

    #[test]
    fn a_static_body_has_no_velocity() {
        let (mut scene, placement) = scene();
        let error = scene.add_static_body(placement.velocity([1.0, 0.0, 0.0]), None).unwrap_err().to_string();
        assert!(error.contains("placement.velocity") && scene.counts().spheres == 0, "{error}");
    }
}
