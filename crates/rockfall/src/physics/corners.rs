//! Contacts of the boxes of rigid bodies with corners of walls (docs/physics.md section 2.16).

use glam::Vec3;

use crate::model::lists::Entry;
use crate::model::view::{Object, View};
use crate::physics::geometry::{box_vertex, point_box, point_polygon};
use crate::physics::motions::{Motions, Touch};
use crate::physics::rigid_box::{from_core, is_solid};
use crate::physics::rod_polygon::polygon_from;
use crate::physics::touch::box_from;
use crate::scene::Surface;

/// Overlaps up to this part of the rounding radius are rounding errors.
const SLACK: f32 = 1e-3;

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
fn seen(view: &View, sphere: u32, wall: Object, corner: u32) -> Option<Vec3> {
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

/// The contact of the solid of a box with a corner of a wall, also where they are apart; `None` for other objects. The parameter on the
/// wall is the number of the corner.
pub(crate) fn touch_corner(view: &View, solid: Object, wall: Object, corner: u32) -> Option<Touch> {
    let Object::Sphere(hub) = solid else { return None };
    if !is_solid(view, solid) {
        return None;
    }
    let body_box = view.box_of(solid)?;
    let (normal, distance) = from_core(&body_box, seen(view, hub, wall, corner)?);
    Some(Touch { normal, overlap: body_box.radius - distance, a: 0.0, b: corner as f32 })
}

/// Where the corner is that a solid touches, from the centre of the solid.
pub(super) fn place(view: &View, hub: u32, wall: Object, touch: &Touch) -> Option<Vec3> {
    seen(view, hub, wall, touch.b as u32)
}

/// The corners in the list of a solid that do not count: ids and features. `statics` are its boxes and polygons.
pub(super) fn hidden(view: &View, hub: u32, statics: &[Entry]) -> Vec<(u32, u32)> {
    let solid = Object::Sphere(hub);
    let is_hidden = |entry: &&Entry| {
        let wall = view.object(entry.id());
        let touch = touch_corner(view, solid, wall, entry.feature()).filter(|touch| touch.overlap > 0.0);
        touch.is_some_and(|touch| does_not_count(view, hub, entry, &touch, statics).unwrap_or(false))
    };
    statics.iter().filter(is_hidden).map(|entry| (entry.id(), entry.feature())).collect()
}

/// The vector from the middle of a wall to a corner.
fn outward(view: &View, wall: Object, corner: u32) -> Vec3 {
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

/// Whether another wall is in front of a corner, has a corner at its place and comes before, or continues the surface beyond it.
fn does_not_count(view: &View, hub: u32, entry: &Entry, touch: &Touch, statics: &[Entry]) -> Option<bool> {
    let radius = view.box_of(Object::Sphere(hub))?.radius;
    let corner = seen(view, hub, view.object(entry.id()), entry.feature())?;
    let (centre, slack) = (corner - radius * touch.normal, SLACK * radius);
    let mut walls: Vec<u32> = statics.iter().map(|other| other.id()).collect();
    walls.dedup();
    let own = walls.iter().position(|wall| *wall == entry.id())?;
    let outward = outward(view, view.object(entry.id()), entry.feature());
    let along = (outward - outward.dot(touch.normal) * touch.normal).normalize_or_zero();
    let overlap = |wall: u32| overlap_with(view, hub, view.object(wall), centre, radius);
    let goes_on = |wall: u32| overlap_with(view, hub, view.object(wall), centre + radius * along, radius) >= -slack;
    let is_off = overlap(entry.id()).abs() > slack;
    let others = walls.iter().enumerate().filter(|(number, _)| *number != own);
    let hides = |(number, wall): (usize, &u32)| {
        let overlap = overlap(*wall);
        overlap > slack || number < own && overlap >= -slack || goes_on(*wall)
    };
    Some(is_off || others.into_iter().any(hides))
}

/// The overlap of a sphere with a wall; minus infinity behind the plane of a parallelogram. `centre` is seen from the hub.
fn overlap_with(view: &View, hub: u32, wall: Object, centre: Vec3, radius: f32) -> f32 {
    let origin = Motions::place(view, hub);
    match wall {
        Object::Cuboid(cuboid) => radius - point_box(&box_from(view, &view.cuboid(cuboid), origin), centre, radius).1,
        Object::Polygon(polygon) => {
            let face = polygon_from(view, &view.polygon(polygon), origin);
            point_polygon(&face, centre, radius).map_or(f32::NEG_INFINITY, |(_, distance)| radius - distance)
        }
        Object::Sphere(_) | Object::Rod(_) => f32::NEG_INFINITY,
    }
}
