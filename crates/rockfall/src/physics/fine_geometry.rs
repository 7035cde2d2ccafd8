//! Distances of static objects from positions that have a low part (docs/physics section 5.8). Differences of large numbers are
//! computed in `f64`, and the distances are rounded to `f32`.

use glam::{DVec3, Vec3};

use crate::fine::Fine;
use crate::model::view::{BoxRecord, PolygonRecord, TINY};
use crate::physics::geometry::{OnEdges, from_edges, is_inside, nearest_face, nearest_on_edges, unrounded};
use crate::physics::smooth::point_round;

/// Returns the unit normal from sphere A to sphere B, and their overlap.
pub(super) fn fine_spheres(a: Fine, b: Fine, radii: [f32; 2]) -> (Vec3, f32) {
    let d = b.wide() - a.wide();
    let (reach, distance) = (f64::from(radii[0]) + f64::from(radii[1]), d.length());
    if distance * distance <= TINY.into() {
        return (Vec3::Y, reach as f32);
    }
    ((d / distance).as_vec3(), (reach - distance) as f32)
}

/// Returns the unit normal from a sphere to a box, and the overlap.
pub(super) fn fine_box(cuboid: &BoxRecord, centre: Fine, radius: f32) -> (Vec3, f32) {
    let edges = cuboid.edges.map(Vec3::as_dvec3);
    let from_corner = centre.wide() - cuboid.corner.as_dvec3();
    let t = DVec3::from_array(edges.map(|edge| from_corner.dot(edge) / edge.length_squared()));
    let clamped = t.clamp(DVec3::ZERO, DVec3::ONE);
    let nearest = clamped.x * edges[0] + clamped.y * edges[1] + clamped.z * edges[2];
    let mut d = nearest - from_corner;
    for (axis, edge) in edges.into_iter().enumerate() {
        if clamped[axis] == t[axis] {
            d -= d.dot(edge) / edge.length_squared() * edge;
        }
    }
    let largest = cuboid.edges.map(Vec3::length_squared).into_iter().fold(0.0, f32::max);
    if clamped == t || unrounded(d.as_vec3(), largest, radius).length_squared() <= TINY {
        let (normal, distance) = nearest_face(cuboid, clamped.as_vec3());
        return (normal, radius - distance);
    }
    let distance = d.length();
    ((d / distance).as_vec3(), (f64::from(radius) - distance) as f32)
}

/// Returns the unit normal from a sphere to a polygon, and the overlap. `None` behind the plane of a
/// parallelogram.
pub(super) fn fine_polygon(polygon: &PolygonRecord, centre: Fine, radius: f32) -> Option<(Vec3, f32)> {
    if polygon.surface.is_round() {
        let (normal, distance) = point_round(polygon, centre.wide() - polygon.corner.as_dvec3(), radius)?;
        return Some((normal, (f64::from(radius) - distance) as f32));
    }
    let (mut face, mut overlap, place) = over_plane(polygon, centre, radius);
    let is_behind = overlap > f64::from(radius);
    if overlap.is_nan() || (is_behind && !polygon.is_triangle()) {
        return None;
    }
    if is_behind {
        (face, overlap) = (-face, 2.0 * f64::from(radius) - overlap);
    }
    if is_inside(polygon, place) {
        return Some((-face, overlap as f32));
    }
    let [left, right] = [polygon.left, polygon.right].map(Vec3::as_dvec3);
    let t = centre.wide() - polygon.corner.as_dvec3();
    let OnEdges { l, k, edge } = nearest_on_edges(polygon, place, t.as_vec3());
    let mut d = f64::from(l) * left + f64::from(k) * right - t;
    if let Some(edge) = edge.map(Vec3::as_dvec3) {
        d -= d.dot(edge) / edge.length_squared() * edge;
    }
    if from_edges(polygon, d.as_vec3(), None, radius).is_none() {
        return Some((-face, radius));
    }
    Some(((d / d.length()).as_vec3(), (f64::from(radius) - d.length()) as f32))
}

/// Returns the unit normal of a polygon's face, the overlap of a sphere with its plane, and the parameters of the centre along the edges.
fn over_plane(polygon: &PolygonRecord, centre: Fine, radius: f32) -> (Vec3, f64, [f32; 2]) {
    let [left, right] = [polygon.left, polygon.right].map(Vec3::as_dvec3);
    let normal = left.cross(right);
    let nn = normal.length_squared();
    let t = centre.wide() - polygon.corner.as_dvec3();
    let l = t.cross(right).dot(normal) / nn;
    let k = left.cross(t).dot(normal) / nn;
    let face = normal / nn.sqrt();
    let overlap = f64::from(radius) - t.dot(face);
    (face.as_vec3(), overlap, [l as f32, k as f32])
}
