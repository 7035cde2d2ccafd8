//! A ball against everything.

use glam::{Vec2, Vec3};

use crate::rigid::collide::Manifold;
use crate::rigid::collide::solid::face_corners;
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Hull, Shape};

/// The place of a core nearest to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    /// The place, on the surface of the core.
    pub(crate) place: Vec3,
    /// Unit vector from the core towards the point; outwards if the point is inside.
    pub(crate) normal: Vec3,
}

/// A ball b and any shape a.
pub(super) fn collide(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32) -> Option<Manifold> {
    let centre = b_in_a.position;
    let Nearest { place, normal } = nearest(&a.core, centre)?;
    let separation = (centre - place).dot(normal) - a.radius - b.radius;
    (separation <= reach).then(|| Manifold::single(normal, (place, centre), (a.radius, b.radius), 0))
}

/// The place of a core nearest to a point; `None` on the far side of what is touched from one side only, and for facets.
pub(crate) fn nearest(core: &Core, point: Vec3) -> Option<Nearest> {
    Some(match core {
        Core::Point => away(Vec3::ZERO, point, Vec3::Y),
        Core::Segment { half } => away(Vec3::new(0.0, point.y.clamp(-half, *half), 0.0), point, Vec3::X),
        Core::HalfSpace => Nearest { place: Vec3::new(point.x, 0.0, point.z), normal: Vec3::Y },
        Core::Box { half } => on_box(*half, point),
        Core::Cone { half, radii, inside } => return on_cone(*half, *radii, *inside, point),
        Core::Bowl { radius } => {
            let distance = point.length();
            if distance > *radius {
                return None;
            }
            let outward = if distance > 0.0 { point / distance } else { Vec3::Y };
            Nearest { place: outward * *radius, normal: -outward }
        }
        Core::Face { is_facet: true, .. } => return None,
        Core::Face { u, v, is_triangle, one_sided, .. } => {
            if *one_sided && point.z < 0.0 {
                return None;
            }
            let side = if point.z < 0.0 { -Vec3::Z } else { Vec3::Z };
            let (corners, count) = face_corners(*u, *v, *is_triangle);
            away(on_face(&corners[..count], point), point, side)
        }
        Core::Hull(hull) => on_hull(hull, point),
    })
}

/// The place of a cone nearest to a point on its touched side: in the half-plane that the axis bounds and that contains the point.
fn on_cone(half: f32, radii: [f32; 2], inside: bool, point: Vec3) -> Option<Nearest> {
    let beside = Vec3::new(point.x, 0.0, point.z);
    let distance = beside.length();
    let out = if distance > 0.0 { beside / distance } else { Vec3::X };
    // In coordinates (distance from the axis, y).
    let start = Vec2::new(radii[0], -half);
    let along = Vec2::new(radii[1] - radii[0], 2.0 * half);
    let from = Vec2::new(distance, point.y) - start;
    let away_from_axis = Vec2::new(along.y, -along.x) / along.length();
    let normal = if inside { -away_from_axis } else { away_from_axis };
    if from.dot(normal) < 0.0 {
        return None;
    }
    let place = start + along * (from.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let in_space = |flat: Vec2| out * flat.x + Vec3::Y * flat.y;
    Some(away(in_space(place), point, in_space(normal)))
}

/// The direction from a place to a point, or `otherwise` where they are one.
fn away(place: Vec3, point: Vec3, otherwise: Vec3) -> Nearest {
    let offset = point - place;
    let length = offset.length();
    // Below the rounding error of the coordinates a direction means nothing.
    let noise = 2.0 * f32::EPSILON * point.abs().max_element();
    let normal = if length > noise && length > f32::MIN_POSITIVE.sqrt() { offset / length } else { otherwise };
    Nearest { place, normal }
}

fn on_box(half: Vec3, point: Vec3) -> Nearest {
    let place = point.clamp(-half, half);
    let mut depth = half - point.abs();
    if depth.min_element() < 0.0 {
        let offset = point - place;
        // Scaled, so that tiny gaps do not underflow.
        let size = offset.abs().max_element();
        return Nearest { place, normal: (offset / size).normalize() };
    }
    // Inside: the face of least depth, the first of equal ones.
    let axis = depth.min_position();
    depth = Vec3::ZERO;
    depth[axis] = if point[axis] < 0.0 { -1.0 } else { 1.0 };
    let mut place = point;
    place[axis] = depth[axis] * half[axis];
    Nearest { place, normal: depth }
}

/// The place of a face in the plane z = 0 nearest to a point. Its corners go round counterclockwise.
fn on_face(corners: &[Vec3], point: Vec3) -> Vec3 {
    let foot = Vec3::new(point.x, point.y, 0.0);
    let sides = (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]));
    if sides.clone().all(|(start, end)| (end - start).cross(foot - start).z >= 0.0) {
        return foot;
    }
    let places = sides.map(|(start, end)| on_segment(start, end, foot));
    places.min_by(|a, b| a.distance_squared(foot).total_cmp(&b.distance_squared(foot))).unwrap_or(foot)
}

/// The place of a segment nearest to a point.
pub(super) fn on_segment(start: Vec3, end: Vec3, point: Vec3) -> Vec3 {
    let along = end - start;
    let square = along.length_squared();
    let part = if square > 0.0 { ((point - start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    start + along * part
}

fn on_hull(hull: &Hull, point: Vec3) -> Nearest {
    let mut least = (f32::NEG_INFINITY, 0);
    let mut best: Option<(f32, Nearest)> = None;
    for (face, (normal, corners)) in hull.faces.iter().enumerate() {
        let height = (point - hull.vertices[corners[0] as usize]).dot(*normal);
        if height > least.0 {
            least = (height, face);
        }
        if height > 0.0 {
            let found = on_polygon(hull, corners, *normal, height, point);
            let square = found.place.distance_squared(point);
            if best.is_none_or(|(known, _)| square < known) {
                best = Some((square, found));
            }
        }
    }
    best.map_or_else(
        || {
            let normal = hull.faces[least.1].0;
            Nearest { place: point - normal * least.0, normal }
        },
        |(_, found)| found,
    )
}

/// The place of a face nearest to a point in front of it.
fn on_polygon(hull: &Hull, corners: &[u8], normal: Vec3, height: f32, point: Vec3) -> Nearest {
    let foot = point - normal * height;
    let mut best: Option<(f32, Vec3)> = None;
    for k in 0..corners.len() {
        let start = hull.vertices[corners[k] as usize];
        let end = hull.vertices[corners[(k + 1) % corners.len()] as usize];
        if (foot - start).dot((end - start).cross(normal)) > 0.0 {
            let place = on_segment(start, end, point);
            let square = place.distance_squared(point);
            if best.is_none_or(|(known, _)| square < known) {
                best = Some((square, place));
            }
        }
    }
    best.map_or(Nearest { place: foot, normal }, |(_, place)| away(place, point, normal))
}
