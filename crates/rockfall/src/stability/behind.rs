//! Finds bodies behind polygons, which act on one side only.

use glam::Vec3;

use crate::model::view::PolygonRecord;
use crate::physics::geometry::point_over_polygon;
use crate::scene::{Polygon, Scene, Sphere, Surface};

/// Largest number of spheres times walls that are compared.
const COMPARISONS: usize = 50_000_000;

/// A wall that a sphere may meet as it falls.
enum Wall {
    /// A polygon that does not act on bodies from above.
    FacesDown(usize, PolygonRecord, u16),
    /// The bounds of any other wall.
    Other(Vec3, Vec3, u16),
}

impl Scene {
    /// A message about the first moving sphere that overlaps a polygon from behind.
    pub(super) fn behind_polygon(&self) -> Option<String> {
        if self.spheres().len().saturating_mul(self.polygons().len()) > COMPARISONS {
            return None;
        }
        let movers = || self.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed);
        let of_face = |(number, face): (usize, &Polygon)| {
            if face.surface != Surface::Parallelogram {
                return None;
            }
            let record = PolygonRecord::of(face);
            let is_behind = |sphere: &Sphere| {
                let (_, height, inside) = point_over_polygon(&record, sphere.position);
                inside && height < 0.0 && height > -sphere.radius && self.groups_touch(sphere.group, face.group)
            };
            let (index, _) = movers().find(|(_, sphere)| is_behind(sphere))?;
            Some(self.describe_behind(index, number, "overlaps it"))
        };
        self.polygons().iter().enumerate().find_map(of_face)
    }

    /// A message about the first moving sphere that falls on the back of a polygon: nothing holds the sphere, and no other wall is
    /// above the polygon on the straight way along gravity.
    pub(super) fn falls_through_polygon(&self) -> Option<String> {
        let down = self.settings.gravity_direction.normalize_or_zero() * self.settings.gravity.signum();
        if self.settings.gravity == 0.0 || self.polygons().is_empty() {
            return None;
        }
        let walls = self.walls_along(down);
        if self.spheres().len().saturating_mul(walls.len()) > COMPARISONS {
            return None;
        }
        let held = self.sets_at_rest();
        let mut movers = self.spheres().iter().enumerate().filter(|(index, sphere)| !sphere.fixed && !held.is_held(*index));
        movers.find_map(|(index, sphere)| {
            let number = first_is_back(&walls, sphere, down)?;
            Some(self.describe_behind(index, number, "falls through it"))
        })
    }

    fn describe_behind(&self, sphere: usize, polygon: usize, what: &str) -> String {
        format!(
            "{} is behind polygon number {polygon} and {what}: a polygon acts only on the side that its normal L x R points to, so the \
             body is not held; turn the polygon round by exchanging L and R",
            self.name_of_sphere(sphere),
        )
    }

    fn walls_along(&self, down: Vec3) -> Vec<Wall> {
        let polygons = self.polygons().iter().enumerate().map(|(number, face)| {
            let is_one_sided = matches!(face.surface, Surface::Parallelogram | Surface::Plane) && face.motion.is_none();
            if is_one_sided && face.left.cross(face.right).dot(down) > 0.0 {
                return Wall::FacesDown(number, PolygonRecord::of(face), face.group);
            }
            let (min, max) = face.bounds().unwrap_or((Vec3::NEG_INFINITY, Vec3::INFINITY));
            Wall::Other(min, max, face.group)
        });
        let boxes = self.boxes().iter().map(|cuboid| {
            let [least, most] =
                [Vec3::min, Vec3::max].map(|of| cuboid.edges.map(|edge| of(edge, Vec3::ZERO)).iter().sum::<Vec3>());
            let (min, max) = (cuboid.corner + least, cuboid.corner + most);
            Wall::Other(min, max, cuboid.group)
        });
        let fixed = self.spheres().iter().filter(|sphere| sphere.fixed);
        let fixed =
            fixed.map(|Sphere { position, radius, group, .. }| Wall::Other(*position - *radius, *position + *radius, *group));
        polygons.chain(boxes).chain(fixed).collect()
    }
}

/// The number of the polygon that a sphere meets first on its way down, if it meets its back.
fn first_is_back(walls: &[Wall], sphere: &Sphere, down: Vec3) -> Option<usize> {
    let (mut first, mut back) = (f32::INFINITY, None);
    for wall in walls {
        match wall {
            Wall::FacesDown(number, record, group) if *group == sphere.group => {
                let (normal, height, _) = point_over_polygon(record, sphere.position);
                let way = -height / normal.dot(down);
                let (_, _, inside) = point_over_polygon(record, sphere.position + way * down);
                if way > 0.0 && way < first && inside {
                    (first, back) = (way, Some(*number));
                }
            }
            Wall::Other(min, max, group) if *group == sphere.group => {
                let way = way_into(*min - sphere.radius, *max + sphere.radius, sphere.position, down);
                if way.is_some_and(|way| way <= first) {
                    (first, back) = (way.unwrap_or_default(), None);
                }
            }
            _ => {}
        }
    }
    back
}

/// How far a point moves in a direction until it is within bounds: 0 if it is there now, `None` if it passes by.
fn way_into(min: Vec3, max: Vec3, point: Vec3, direction: Vec3) -> Option<f32> {
    let (mut enter, mut leave) = (0.0_f32, f32::INFINITY);
    for axis in 0..3 {
        let (low, high) = (min[axis] - point[axis], max[axis] - point[axis]);
        if direction[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let [one, other] = [low, high].map(|bound| bound / direction[axis]);
        enter = enter.max(one.min(other));
        leave = leave.min(one.max(other));
    }
    (enter <= leave).then_some(enter)
}
