//! Which corners of walls in the list of the solid of a box do not count (docs/physics.md section 2.16).

use glam::Vec3;

use crate::model::lists::Entry;
use crate::model::view::{Object, View};
use crate::physics::corners::{outward, seen};
use crate::physics::geometry::{point_box, point_polygon};
use crate::physics::motions::{Motions, Touch, box_from};
use crate::physics::rigid_box::touch_corner;
use crate::physics::rod_polygon::polygon_from;

/// Overlaps up to this part of the rounding radius are rounding errors.
const SLACK: f32 = 1e-3;

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

/// Whether another wall is in front of a corner, has a corner at its place and comes before, or continues the surface beyond it.
fn does_not_count(view: &View, hub: u32, entry: &Entry, touch: &Touch, statics: &[Entry]) -> Option<bool> {
    let radius = view.box_of(Object::Sphere(hub))?.radius;
    let corner = seen(view, hub, view.object(entry.id()), entry.feature())?;
    let (centre, slack) = (corner - radius * touch.normal, SLACK * radius);
    let mut walls: Vec<u32> = statics.iter().map(|other| other.id()).collect();
    walls.dedup();
    let own = walls.iter().position(|wall| *wall == entry.id())?;
    let from_middle = outward(view, view.object(entry.id()), entry.feature());
    let along = (from_middle - from_middle.dot(touch.normal) * touch.normal).normalize_or_zero();
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
