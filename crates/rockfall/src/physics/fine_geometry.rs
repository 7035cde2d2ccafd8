//! Distances of static objects from positions that have a low part (docs/physics.md section 5.8). Differences of large numbers are
//! computed in `f64`, and the distances are rounded to `f32`.

use glam::{DVec3, Vec3};

use crate::fine::Fine;
use crate::model::view::{BoxRecord, PolygonRecord, TINY};
use crate::physics::geometry::{across, nearest_face, on_segment, unrounded};

/// Returns the unit normal from a sphere to a box, and the distance of the sphere's centre from the surface, negative inside.
pub(super) fn fine_point_box(cuboid: &BoxRecord, centre: Fine, radius: f32) -> (Vec3, f32) {
    let edges = cuboid.edges.map(Vec3::as_dvec3);
    let from_corner = centre.wide() - cuboid.corner.as_dvec3();
    let t = DVec3::from_array(edges.map(|edge| from_corner.dot(edge) / edge.length_squared()));
    let clamped = t.clamp(DVec3::ZERO, DVec3::ONE);
    let nearest = clamped.x * edges[0] + clamped.y * edges[1] + clamped.z * edges[2];
    let mut d = (nearest - from_corner).as_vec3();
    let squares = cuboid.edges.map(Vec3::length_squared);
    for (axis, edge) in cuboid.edges.into_iter().enumerate() {
        if clamped[axis] == t[axis] {
            d = across(d, edge, squares[axis]);
        }
    }
    let d = unrounded(d, squares.into_iter().fold(0.0, f32::max), radius);
    let dd = d.length_squared();
    if clamped == t || dd <= TINY {
        return nearest_face(cuboid, clamped.as_vec3());
    }
    (d / dd.sqrt(), dd.sqrt())
}

/// Returns the unit normal of a polygon's face, the height of a point above its plane, and whether the point is over the polygon and
/// not beside it.
pub(super) fn fine_point_polygon(polygon: &PolygonRecord, point: Fine) -> (Vec3, f32, bool) {
    let [left, right] = [polygon.left, polygon.right].map(Vec3::as_dvec3);
    let normal = left.cross(right);
    let nn = normal.length_squared();
    let t = point.wide() - polygon.corner.as_dvec3();
    let l = t.cross(right).dot(normal) / nn;
    let k = left.cross(t).dot(normal) / nn;
    let face = normal / nn.sqrt();
    (face.as_vec3(), t.dot(face) as f32, on_segment(l as f32) && on_segment(k as f32))
}
