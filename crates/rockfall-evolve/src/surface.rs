//! How far a ball can fall before it touches the ground.

use rockfall::Scene;
use rockfall::glam::DVec3;

/// Distances below this count as contact, in units.
const CONTACT: f64 = 1e-6;
/// Most steps of the search for a contact. What is found by then is less than the true distance.
const ROUNDS: usize = 64;

/// The shapes of a ground that a creature can touch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    boxes: Vec<Block>,
    faces: Vec<Face>,
}

/// A box.
#[derive(Clone, Debug)]
struct Block {
    corner: DVec3,
    /// Directions of the edges, of length 1.
    axes: [DVec3; 3],
    size: DVec3,
    /// Height of the lowest corner.
    bottom: f64,
}

/// A parallelogram, a triangle or a plane.
#[derive(Clone, Debug)]
struct Face {
    corner: DVec3,
    left: DVec3,
    right: DVec3,
    /// Direction of the side that is touched, of length 1.
    normal: DVec3,
    surface: rockfall::Surface,
}

impl Surface {
    /// The boxes and polygons of the group of creatures, 0. Cones and balls are left out.
    pub(crate) fn of(scene: &Scene) -> Self {
        let block = |cuboid: &rockfall::Cuboid| {
            let edges = cuboid.edges.map(|edge| edge.as_dvec3());
            let corner = cuboid.corner.as_dvec3();
            let size = DVec3::from_array(edges.map(DVec3::length));
            let bottom = corner.y + edges.iter().map(|edge| edge.y.min(0.0)).sum::<f64>();
            Block { corner, axes: edges.map(DVec3::normalize_or_zero), size, bottom }
        };
        let face = |polygon: &rockfall::Polygon| {
            let [corner, left, right] = [polygon.corner, polygon.left, polygon.right].map(|vector| vector.as_dvec3());
            let normal = left.cross(right).normalize_or_zero();
            // A triangle is touched from above on whichever side that is.
            let normal = if polygon.is_triangle() && normal.y < 0.0 { -normal } else { normal };
            Face { corner, left, right, normal, surface: polygon.surface }
        };
        Self {
            boxes: scene.boxes().iter().filter(|cuboid| cuboid.group == 0).map(block).collect(),
            faces: scene
                .polygons()
                .iter()
                .filter(|polygon| polygon.group == 0 && !polygon.surface.is_round())
                .map(face)
                .collect(),
        }
    }

    /// Distance that a ball can fall straight down until it touches something, in units: 0 if it touches something already,
    /// infinity if there is nothing below it.
    pub(crate) fn fall(&self, centre: DVec3, radius: f64) -> f64 {
        let boxes = self.boxes.iter().map(|block| block.fall(centre, radius));
        let faces = self.faces.iter().map(|face| face.fall(centre, radius));
        boxes.chain(faces).fold(f64::INFINITY, f64::min)
    }
}

impl Block {
    fn distance(&self, point: DVec3) -> f64 {
        let from = point - self.corner;
        let local = DVec3::from_array(self.axes.map(|axis| from.dot(axis)));
        (-local).max(local - self.size).max(DVec3::ZERO).length()
    }

    fn fall(&self, centre: DVec3, radius: f64) -> f64 {
        let mut fallen = 0.0;
        for _ in 0..ROUNDS {
            let place = centre - DVec3::new(0.0, fallen, 0.0);
            if place.y + radius < self.bottom {
                return f64::INFINITY;
            }
            let free = self.distance(place) - radius;
            if free <= CONTACT {
                break;
            }
            fallen += free;
        }
        fallen
    }
}

impl Face {
    /// A ball touches a polygon with the point of its surface that is nearest to the plane, if that is inside the edges.
    fn fall(&self, centre: DVec3, radius: f64) -> f64 {
        let distance = (centre - self.corner).dot(self.normal);
        if self.normal.y <= 0.0 || distance < 0.0 {
            return f64::INFINITY;
        }
        let fallen = ((distance - radius) / self.normal.y).max(0.0);
        let from = centre - DVec3::new(0.0, fallen, 0.0) - self.corner;
        let area = self.left.cross(self.right).dot(self.normal);
        let shares = [from.cross(self.right).dot(self.normal) / area, self.left.cross(from).dot(self.normal) / area];
        let is_inside = shares.iter().all(|share| (0.0..=1.0).contains(share));
        let is_inside = match self.surface {
            rockfall::Surface::Plane => true,
            rockfall::Surface::Triangle => is_inside && shares[0] + shares[1] <= 1.0,
            _ => is_inside,
        };
        if is_inside { fallen } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockfall::{Cuboid, Polygon};

    fn fall(scene: &Scene, centre: [f64; 3]) -> f64 {
        Surface::of(scene).fall(DVec3::from_array(centre), 0.1)
    }

    #[test]
    fn a_ball_falls_on_the_highest_thing_below_it() {
        let mut scene = Scene::new();
        scene.add_box(Cuboid::between([-5.0, -1.0, -5.0], [5.0, 0.0, 5.0])).unwrap();
        scene.add_box(Cuboid::between([1.0, 0.0, -5.0], [5.0, 0.5, 5.0])).unwrap();
        scene.add_box(Cuboid::between([-5.0, 3.0, -5.0], [5.0, 4.0, 5.0])).unwrap();
        scene.add_box(Cuboid::between([-3.0, 0.0, -5.0], [-2.0, 0.8, 5.0]).group(7)).unwrap();
        // Heights of f32, which the level ground gives back exactly.
        let height = f64::from(1.3_f32);
        assert_eq!(fall(&scene, [0.0, height, 0.0]), height - 0.1);
        assert!((fall(&scene, [2.0, 1.3, 0.0]) - 0.7).abs() < 1e-6);
        // Over the edge of the step by 0.06 of its radius of 0.1: it falls by 0.02 more.
        assert!((fall(&scene, [0.94, 1.3, 0.0]) - 0.72).abs() < 1e-5);
        // Another group does not count. A ball in contact with a wall does not fall.
        assert!((fall(&scene, [-2.5, 1.3, 0.0]) - 1.2).abs() < 1e-6);
        assert_eq!(fall(&scene, [0.91, 0.3, 0.0]), 0.0);
        assert_eq!(fall(&scene, [0.0, 0.05, 0.0]), 0.0);
        assert_eq!(fall(&scene, [9.0, 1.0, 0.0]), f64::INFINITY);
        assert_eq!(fall(&scene, [0.0, -2.0, 0.0]), f64::INFINITY);
    }

    #[test]
    fn a_ball_falls_on_slopes() {
        let slope = DVec3::new(3.0, 1.0, 0.0).normalize();
        let up = DVec3::new(-slope.y, slope.x, 0.0);
        // A point 0.7 above a slope of 1 in 3; the ball touches it earlier.
        let expected = 0.7 - 0.1 / up.y;
        let mut tilted = Scene::new();
        let edges = [10.0 * slope, up, 10.0 * DVec3::Z].map(|edge| edge.as_vec3());
        tilted.add_box(Cuboid::new((-up - 5.0 * slope - 5.0 * DVec3::Z).as_vec3(), edges[0], edges[1], edges[2])).unwrap();
        assert!((fall(&tilted, [0.3, 0.8, 0.0]) - expected).abs() < 1e-5);
        let mut face = Scene::new();
        let corner = (-5.0 * slope - 5.0 * DVec3::Z).as_vec3();
        face.add_polygon(Polygon::new(corner, edges[2], edges[0])).unwrap();
        assert!((fall(&face, [0.3, 0.8, 0.0]) - expected).abs() < 1e-5);
        // Beside it, and under it: only one side is touched.
        assert_eq!(fall(&face, [0.3, 0.8, 5.01]), f64::INFINITY);
        assert_eq!(fall(&face, [0.3, -0.8, 0.0]), f64::INFINITY);
    }
}
