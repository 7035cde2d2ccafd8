//! Where the box of an inlet has room for a sphere.

use glam::{DVec3, Vec3};

use crate::mesh::nearest::{on_segment, on_triangle};
use crate::model::period::Periods;
use crate::model::view::PolygonRecord;
use crate::physics::smooth::distance;
use crate::scene::{Cuboid, GrainKind, Inlet, Polygon, Scene};

/// What is near the box of an inlet.
pub(super) struct Room {
    periods: Option<Periods>,
    /// Centres and radii of spheres.
    spheres: Vec<(DVec3, f64)>,
    /// Ends and radii of rods.
    rods: Vec<([DVec3; 2], f64)>,
    /// Corners and edges.
    boxes: Vec<(DVec3, [DVec3; 3])>,
    /// Corners, and the middle of the polygon.
    triangles: Vec<([DVec3; 3], DVec3)>,
    smooth: Vec<PolygonRecord>,
}

impl Room {
    /// What the spheres of an inlet can touch, at a time in s.
    pub(super) fn of(scene: &Scene, inlet: &Inlet, time: f64) -> Self {
        let [low, high] = inlet.corners;
        let periods = Periods::unsheared(scene.periodic());
        let way = |to: DVec3| periods.map_or(DVec3::ZERO, |periods| periods.whole(to - 0.5 * (low + high)));
        // Spheres stay inside the box, so it is enough that an object overlaps it: where it does, its image that is nearest to the middle does.
        let overlaps = |points: &[DVec3], margin: f64| {
            let (least, greatest) = points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(least, greatest), point| {
                (least.min(*point), greatest.max(*point))
            });
            let way = way(0.5 * (least + greatest));
            (least - margin - way).cmple(high).all() && (greatest + margin - way).cmpge(low).all()
        };
        let poses = scene.poses(time);
        let groups = groups(scene, inlet);
        let meets = |group: u16| groups.iter().any(|own| scene.groups_touch(*own, group));
        let spheres = scene.spheres().iter().filter(|sphere| meets(sphere.group));
        let spheres = spheres.map(|sphere| (sphere.position.as_dvec3(), f64::from(sphere.radius)));
        let rods = scene.rods().iter().filter(|rod| meets(rod.group)).filter_map(|rod| {
            let [Ok(one), Ok(other)] = [rod.end1, rod.end2].map(|id| scene.sphere(id)) else { return None };
            Some(([one, other].map(|end| end.position.as_dvec3()), f64::from(rod.radius)))
        });
        let boxes = scene.boxes().iter().filter(|cuboid| meets(cuboid.group)).map(|cuboid| {
            let Cuboid { corner, edges, .. } = poses.of_box(cuboid);
            (corner.as_dvec3(), edges.map(Vec3::as_dvec3))
        });
        let polygons = scene.polygons().iter().filter(|polygon| meets(polygon.group)).map(|polygon| poses.of_polygon(polygon));
        let (smooth, flat): (Vec<Polygon>, Vec<Polygon>) = polygons.partition(|polygon| polygon.surface.is_smooth());
        let near_box = |polygon: &Polygon| {
            let near = triangles(polygon).into_iter().filter(|triangle| overlaps(triangle, 0.0));
            near.map(|triangle| (triangle, PolygonRecord::of(polygon).middle().as_dvec3())).collect::<Vec<_>>()
        };
        Self {
            periods,
            spheres: spheres.filter(|(centre, radius)| overlaps(&[*centre], *radius)).collect(),
            rods: rods.filter(|(ends, radius)| overlaps(ends, *radius)).collect(),
            boxes: boxes.filter(|(corner, edges)| overlaps(&corners(*corner, edges), 0.0)).collect(),
            triangles: flat.iter().flat_map(near_box).collect(),
            smooth: smooth.iter().map(PolygonRecord::of).collect(),
        }
    }

    pub(super) fn add(&mut self, centre: DVec3, radius: f32) {
        // The centre that the sphere has.
        self.spheres.push((centre.as_vec3().as_dvec3(), radius.into()));
    }

    /// Whether a sphere touches nothing.
    pub(super) fn has_room(&self, centre: DVec3, radius: f32) -> bool {
        let (centre, radius) = (centre.as_vec3().as_dvec3(), f64::from(radius));
        // The image that is nearest to the middle of an object.
        let near = |middle: DVec3| self.periods.map_or(centre, |periods| centre - periods.whole(centre - middle));
        // Whether the image is far enough from the nearest point of the object, which has a radius.
        let is_free = |middle: DVec3, nearest: &dyn Fn(DVec3) -> DVec3, other: f64| {
            let centre = near(middle);
            centre.distance_squared(nearest(centre)) >= (radius + other) * (radius + other)
        };
        self.spheres.iter().all(|(other, other_radius)| is_free(*other, &|_| *other, *other_radius))
            && self.rods.iter().all(|(ends, other_radius)| is_free(ends[0], &|centre| on_segment(centre, ends), *other_radius))
            && self.boxes.iter().all(|(corner, edges)| {
                is_free(*corner + 0.5 * edges.iter().sum::<DVec3>(), &|centre| in_box(centre, *corner, edges), 0.0)
            })
            && self.smooth.iter().all(|wall| distance(wall, near(wall.middle().as_dvec3()) - wall.corner.as_dvec3()) >= radius)
            && self.triangles.iter().all(|(triangle, middle)| is_free(*middle, &|centre| on_triangle(centre, triangle), 0.0))
    }
}

/// The collision groups of what comes in.
fn groups(scene: &Scene, inlet: &Inlet) -> Vec<u16> {
    let of_kind = |kind: &GrainKind| {
        let Some(Ok(shape)) = kind.shape.map(|shape| scene.shape(shape)) else { return vec![kind.group] };
        let spheres = shape.all_spheres().into_iter().map(|sphere| sphere.group);
        spheres.chain(shape.rods.iter().map(|rod| rod.group)).collect()
    };
    inlet.kinds.iter().flat_map(|(kind, _)| of_kind(kind)).collect()
}

fn corners(corner: DVec3, [i, j, k]: &[DVec3; 3]) -> [DVec3; 8] {
    std::array::from_fn(|index| {
        let share = |bit: usize| f64::from(u8::from(index & bit != 0));
        corner + *i * share(1) + *j * share(2) + *k * share(4)
    })
}

/// A triangle, or the two halves of a parallelogram.
fn triangles(polygon: &Polygon) -> Vec<[DVec3; 3]> {
    let [corner, left, right] = [polygon.corner, polygon.left, polygon.right].map(Vec3::as_dvec3);
    let (first, second) = (corner + left, corner + right);
    let half = [corner, first, second];
    if polygon.is_triangle() { vec![half] } else { vec![half, [first + right, first, second]] }
}

/// The point of a box that is nearest to a point. The edges are orthogonal.
fn in_box(point: DVec3, corner: DVec3, edges: &[DVec3; 3]) -> DVec3 {
    let from_corner = point - corner;
    corner + edges.iter().map(|edge| *edge * (from_corner.dot(*edge) / edge.length_squared()).clamp(0.0, 1.0)).sum::<DVec3>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Rate, Rod, Sphere};

    #[test]
    fn spheres_touch_nothing() {
        let mut scene = Scene::new();
        scene.add_box(Cuboid::between([-1.0, -1.0, -1.0], [1.0, 0.0, 1.0])).unwrap();
        scene.add_polygon(Polygon::new([0.5, 0.0, -1.0], [0.0, 0.0, 2.0], [0.0, 2.0, 0.0])).unwrap();
        let ends = [[-0.5, 1.0, -0.5], [-0.5, 1.0, 0.5]].map(|end| scene.add_sphere(Sphere::new(end, 0.01)).unwrap());
        scene.add_rod(Rod::new(ends[0], ends[1], 0.05)).unwrap();
        let inlet = Inlet::new("in", [[-1.0, -1.0, -1.0], [1.0, 2.0, 1.0]], Rate::Number(1.0), 0.1);
        let mut room = Room::of(&scene, &inlet, 0.0);
        room.add(DVec3::new(0.0, 1.0, 0.0), 0.2);
        let cases = [
            ([0.0, 0.1, 0.0], true),
            ([0.0, 0.09, 0.0], false),
            ([0.0, -0.5, 0.0], false),
            ([0.39, 1.0, 0.9], true),
            ([0.41, 1.0, 0.9], false),
            ([0.41, 1.9, -0.9], false),
            ([-0.5, 1.16, 0.0], true),
            ([-0.5, 1.14, 0.3], false),
            ([0.29, 1.0, 0.0], false),
            ([0.31, 1.0, 0.0], true),
        ];
        for (centre, expected) in cases {
            assert_eq!(room.has_room(DVec3::from_array(centre), 0.1), expected, "{centre:?}");
        }
    }
}
