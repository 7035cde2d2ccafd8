//! Corners of walls, which the boxes of rigid bodies touch (docs/physics.md section 2.16).

use glam::Vec3;

use crate::model::view::{Object, View};
use crate::physics::geometry::box_vertex;
use crate::physics::motions::{Motions, box_from};
use crate::physics::rod_polygon::polygon_from;
use crate::scene::Surface;

/// Number of corners of a wall.
pub(crate) fn corners(view: &View, wall: Object) -> u32 {
    match wall {
        Object::Cuboid(_) => 8,
        Object::Polygon(polygon) => match view.polygon(polygon).surface {
            Surface::Parallelogram => 4,
            Surface::Triangle => 3,
            _ => 0,
        },
        Object::Sphere(_) | Object::Rod(_) => 0,
    }
}

/// A corner of a wall as seen from the centre of a sphere.
pub(super) fn seen(view: &View, sphere: u32, wall: Object, corner: u32) -> Option<Vec3> {
    let origin = Motions::place(view, sphere);
    match wall {
        Object::Cuboid(cuboid) => Some(box_vertex(&box_from(view, &view.cuboid(cuboid), origin), corner).0),
        Object::Polygon(polygon) => {
            let face = polygon_from(view, &view.polygon(polygon), origin);
            let edges = [face.left, face.right].into_iter().enumerate().filter(|(bit, _)| corner >> bit & 1 == 1);
            Some(face.corner + edges.map(|(_, edge)| edge).sum::<Vec3>())
        }
        Object::Sphere(_) | Object::Rod(_) => None,
    }
}

/// The vector from the middle of a wall to a corner.
pub(super) fn outward(view: &View, wall: Object, corner: u32) -> Vec3 {
    let side = |bit: u32, middle: f32| (corner >> bit & 1) as f32 - middle;
    match wall {
        Object::Cuboid(cuboid) => {
            let [i, j, k] = view.cuboid(cuboid).edges;
            side(0, 0.5) * i + side(1, 0.5) * j + side(2, 0.5) * k
        }
        Object::Polygon(polygon) => {
            let face = view.polygon(polygon);
            let middle = if face.is_triangle() { 1.0 / 3.0 } else { 0.5 };
            side(0, middle) * face.left + side(1, middle) * face.right
        }
        Object::Sphere(_) | Object::Rod(_) => Vec3::ZERO,
    }
}
