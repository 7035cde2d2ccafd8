//! Closest points (docs/physics sections 2.3 to 2.9; equations (2.1) to (2.5) of the thesis).

use glam::Vec3;

use crate::model::view::{BoxRecord, PolygonRecord, TINY};
pub(crate) use crate::physics::rounding::{AT_END, ROUNDED, SMALL, unrounded};
use crate::physics::smooth::point_round;
use crate::scene::Surface;

/// Returns a vector without its component along an axis. `squared` is the squared length of the axis. A distance vector from a
/// line has such a component only because the parameter is rounded. The component would change the direction of a very short
/// distance.
fn across(v: Vec3, axis: Vec3, squared: f32) -> Vec3 {
    v - v.dot(axis) / squared * axis
}

/// Whether a parameter belongs to a segment.
pub(super) fn on_segment(parameter: f32) -> bool {
    (-AT_END..=1.0 + AT_END).contains(&parameter)
}

/// The closest points of two segments.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentPair {
    /// Parameter on A, in [0, 1] up to rounding errors.
    pub(crate) a: f32,
    /// Parameter on B, in [0, 1] up to rounding errors.
    pub(crate) b: f32,
    /// From A's point to B's.
    pub(crate) d: Vec3,
    /// The common normal; `None` for parallel segments.
    pub(crate) normal: Option<Vec3>,
}

/// Returns the closest points of two segments, or `None` when the closest points of the lines lie beyond an end or a segment
/// has no length. `reach` is the distance at which the pair begins to touch.
pub(crate) fn segment_segment([a1, a2]: [Vec3; 2], [b1, b2]: [Vec3; 2], reach: f32) -> Option<SegmentPair> {
    let (a_axis, b_axis, c) = (a2 - a1, b2 - b1, b1 - a1);
    let (aa, bb) = (a_axis.length_squared(), b_axis.length_squared());
    if aa <= TINY || bb <= TINY {
        return None;
    }
    let [a_scale, b_scale] = [a_axis, b_axis].map(scale);
    let (a_scaled, b_scaled) = (a_scale * a_axis, b_scale * b_axis);
    let normal = a_scaled.cross(b_scaled);
    let nn = normal.length_squared();
    if nn <= 1e-8 * a_scaled.length_squared() * b_scaled.length_squared() {
        return parallel_segments(a_axis, b_axis, c, reach);
    }
    let a = a_scale * (c.dot(b_scaled.cross(normal)) / nn);
    let b = b_scale * (c.dot(a_scaled.cross(normal)) / nn);
    let normal = normal / nn.sqrt();
    // The distance is along the common normal. Its other components are rounding errors of a and b.
    let d = (c + b * b_axis - a * a_axis).dot(normal) * normal;
    let d = unrounded(d, aa + bb, reach);
    (on_segment(a) && on_segment(b)).then_some(SegmentPair { a, b, d, normal: Some(normal) })
}

/// Returns the contact of parallel segments, at the middle of the interval in which they lie side by side.
fn parallel_segments(a_axis: Vec3, b_axis: Vec3, c: Vec3, reach: f32) -> Option<SegmentPair> {
    let aa = a_axis.length_squared();
    let t0 = c.dot(a_axis) / aa;
    let t1 = (c + b_axis).dot(a_axis) / aa;
    let low = t0.min(t1).max(0.0);
    let high = t0.max(t1).min(1.0);
    if low > high + AT_END {
        return None;
    }
    let a = 0.5 * (low + high);
    let b = ((a * a_axis - c).dot(b_axis) / b_axis.length_squared()).clamp(0.0, 1.0);
    let d = unrounded(c + b * b_axis - a * a_axis, aa + b_axis.length_squared(), reach);
    Some(SegmentPair { a, b, d, normal: None })
}

/// Returns the parameter on a segment and the vector from a point to it (2.4, 2.5), or `None` beyond the ends. `reach` is the
/// distance at which the pair begins to touch.
pub(crate) fn point_segment(p: Vec3, [a1, a2]: [Vec3; 2], reach: f32) -> Option<(f32, Vec3)> {
    let axis = a2 - a1;
    let aa = axis.length_squared();
    if aa <= TINY {
        return None;
    }
    let c = p - a1;
    let a = axis.dot(c) / aa;
    on_segment(a).then(|| (a, unrounded(across(a * axis - c, axis, aa), aa, reach)))
}

/// Returns the parameters of a point along the three edges of a box.
pub(crate) fn box_parameters(cuboid: &BoxRecord, p: Vec3) -> Vec3 {
    let t = p - cuboid.corner;
    Vec3::from_array(cuboid.edges.map(|edge| t.dot(edge) / edge.length_squared()))
}

/// Whether a point lies in a box or on its surface, up to rounding errors (docs/physics section 2.9). `distance` is its
/// distance from an edge or vertex of the box.
pub(crate) fn box_contains(cuboid: &BoxRecord, p: Vec3, distance: f32) -> bool {
    let t = box_parameters(cuboid, p);
    let rounded =
        (ROUNDED * p.distance(cuboid.corner)).min(SMALL * distance) / Vec3::from_array(cuboid.edges.map(Vec3::length));
    t.cmpge(-rounded).all() && t.cmple(Vec3::ONE + rounded).all()
}

/// Returns the unit normal from a sphere to a box, and the distance of the sphere's centre `p` from the surface, negative
/// inside.
pub(crate) fn point_box(cuboid: &BoxRecord, p: Vec3, radius: f32) -> (Vec3, f32) {
    let t = box_parameters(cuboid, p);
    let clamped = t.clamp(Vec3::ZERO, Vec3::ONE);
    let [i, j, k] = cuboid.edges;
    let squares = cuboid.edges.map(Vec3::length_squared);
    let mut d = cuboid.corner + clamped.x * i + clamped.y * j + clamped.z * k - p;
    for (axis, edge) in cuboid.edges.into_iter().enumerate() {
        if clamped[axis] == t[axis] {
            d = across(d, edge, squares[axis]);
        }
    }
    let d = unrounded(d, squares.into_iter().fold(0.0, f32::max), radius);
    let dd = d.length_squared();
    if clamped == t || dd <= TINY {
        return nearest_face(cuboid, clamped);
    }
    let distance = dd.sqrt();
    (d / distance, distance)
}

/// The result of [`point_box`] for a centre in the box. The sphere leaves through the nearest face. Among equally near faces it
/// is the first one.
pub(super) fn nearest_face(cuboid: &BoxRecord, t: Vec3) -> (Vec3, f32) {
    let mut nearest = (Vec3::Y, f32::INFINITY);
    for (axis, edge) in cuboid.edges.into_iter().enumerate() {
        let length = edge.length();
        let outward = edge / length;
        for (inward, depth) in [(outward, t[axis] * length), (-outward, (1.0 - t[axis]) * length)] {
            if depth < (1.0 - AT_END) * nearest.1 {
                nearest = (inward, depth);
            }
        }
    }
    (nearest.0, -nearest.1)
}

/// Returns a power of two near 1 / |v| (docs/physics section 2.3). Products of vectors that are multiplied by it neither overflow nor underflow, and are
/// rounded as without it. 0 for a vector that is not finite.
pub(crate) fn scale(v: Vec3) -> f32 {
    f32::from_bits(254_u32.saturating_sub(v.abs().max_element().to_bits() >> 23) << 23)
}

/// The face of a polygon.
pub(super) struct Face {
    /// L and R, scaled.
    edges: [Vec3; 2],
    scales: [f32; 2],
    /// L x R of the scaled edges.
    across: Vec3,
    /// Unit normal.
    pub(super) normal: Vec3,
}

impl Face {
    pub(super) fn of(polygon: &PolygonRecord) -> Self {
        let scales = [polygon.left, polygon.right].map(scale);
        let edges = [scales[0] * polygon.left, scales[1] * polygon.right];
        let across = edges[0].cross(edges[1]);
        Self { edges, scales, across, normal: across / across.length_squared().sqrt() }
    }

    /// Returns the parameters along L and R of a vector from the corner, or of a velocity.
    pub(super) fn along_edges(&self, v: Vec3) -> [f32; 2] {
        let Self { edges: [left, right], scales, across, .. } = self;
        let squared = across.length_squared();
        [scales[0] * (v.cross(*right).dot(*across) / squared), scales[1] * (left.cross(v).dot(*across) / squared)]
    }
}

/// Returns the unit normal of a polygon's face, the height of a point above its plane, and whether the point is over the
/// polygon and not beside it.
pub(crate) fn point_over_polygon(polygon: &PolygonRecord, p: Vec3) -> (Vec3, f32, bool) {
    let face = Face::of(polygon);
    let t = p - polygon.corner;
    (face.normal, t.dot(face.normal), is_inside(polygon, face.along_edges(t)))
}

/// Whether a point with these parameters along L and R is over the polygon.
pub(super) fn is_inside(polygon: &PolygonRecord, [l, k]: [f32; 2]) -> bool {
    let on_parallelogram = on_segment(l) && on_segment(k) && (!polygon.is_triangle() || on_segment(l + k));
    on_parallelogram || polygon.surface == Surface::Plane
}

/// A point on the edges of a polygon, P + l L + k R.
pub(super) struct OnEdges {
    pub(super) l: f32,
    pub(super) k: f32,
    /// The edge that the point is on, if it is not a corner.
    pub(super) edge: Option<Vec3>,
}

/// Returns the point of a polygon's edges that is nearest to a point beside its face. `t` is that point as seen from the corner, and
/// `place` its parameters along L and R.
pub(super) fn nearest_on_edges(polygon: &PolygonRecord, place: [f32; 2], t: Vec3) -> OnEdges {
    if polygon.is_triangle() {
        return nearest_on_triangle(polygon, t);
    }
    let (mut nearest, mut least) = (OnEdges { l: 0.0, k: 0.0, edge: None }, f32::INFINITY);
    let edges = [polygon.left, polygon.right];
    for side in 0..2 {
        if on_segment(place[side]) {
            continue;
        }
        // The edge across this side is beyond its start or beyond its end.
        let (beyond, edge) = (if place[side] > 0.5 { 1.0 } else { 0.0 }, edges[1 - side]);
        let from_start = t - beyond * edges[side];
        let along = from_start.dot(edge) / edge.length_squared();
        let clamped = along.clamp(0.0, 1.0);
        let squared = (clamped * edge - from_start).length_squared();
        if squared < least {
            let [l, k] = if side == 0 { [beyond, clamped] } else { [clamped, beyond] };
            (nearest, least) = (OnEdges { l, k, edge: (clamped == along).then_some(edge) }, squared);
        }
    }
    nearest
}

/// The point of a triangle's edges that is nearest to the point `t`, as seen from the corner.
fn nearest_on_triangle(polygon: &PolygonRecord, t: Vec3) -> OnEdges {
    let (left, right) = (polygon.left, polygon.right);
    let sides = [(Vec3::ZERO, left), (Vec3::ZERO, right), (left, right - left)];
    let found = sides.map(|(start, edge)| {
        let along = (t - start).dot(edge) / edge.length_squared();
        let clamped = along.clamp(0.0, 1.0);
        ((start + clamped * edge - t).length_squared(), clamped, (clamped == along).then_some(edge))
    });
    let nearest = (1..3).fold(0, |nearest, side| if found[side].0 < found[nearest].0 { side } else { nearest });
    let (_, along, edge) = found[nearest];
    let [l, k] = [[along, 0.0], [0.0, along], [1.0 - along, along]][nearest];
    OnEdges { l, k, edge }
}

/// Returns the unit normal from a sphere to a polygon, and the distance of the sphere's centre `p` from it. `None` behind the plane of a
/// surface that has one side.
pub(crate) fn point_polygon(polygon: &PolygonRecord, p: Vec3, radius: f32) -> Option<(Vec3, f32)> {
    let t = p - polygon.corner;
    if polygon.surface.is_round() {
        return point_round(polygon, t.as_dvec3(), radius).map(|(normal, distance)| (normal, distance as f32));
    }
    let face = Face::of(polygon);
    let (place, height) = (face.along_edges(t), t.dot(face.normal));
    let is_behind = height < 0.0;
    if height.is_nan() || (is_behind && !polygon.is_triangle()) {
        return None;
    }
    let inwards = if is_behind { face.normal } else { -face.normal };
    if is_inside(polygon, place) {
        return Some((inwards, height.abs()));
    }
    let OnEdges { l, k, edge } = nearest_on_edges(polygon, place, t);
    let d = polygon.corner + l * polygon.left + k * polygon.right - p;
    Some(from_edges(polygon, d, edge, radius).map_or((inwards, 0.0), |d| (d / d.length(), d.length())))
}

/// The distance vector from a sphere to a point on the edges of a polygon without rounding errors, `None` if it is 0.
pub(super) fn from_edges(polygon: &PolygonRecord, d: Vec3, edge: Option<Vec3>, radius: f32) -> Option<Vec3> {
    let squared = polygon.left.length_squared().max(polygon.right.length_squared());
    let d = unrounded(edge.map_or(d, |edge| across(d, edge, edge.length_squared())), squared, radius);
    (d.length_squared() > TINY).then_some(d)
}

/// An edge of a box, and its outward direction.
pub(crate) struct BoxEdge {
    pub(crate) start: Vec3,
    pub(crate) end: Vec3,
    pub(crate) outward: Vec3,
}

/// Returns edge 0 to 11 of a box: four along each of I, J, K.
pub(crate) fn box_edge(cuboid: &BoxRecord, edge: u32) -> BoxEdge {
    let along = (edge / 4) as usize;
    let offset = |bit: u32, axis: usize| {
        let set = ((edge % 4) >> bit) & 1 == 1;
        let side = cuboid.edges[axis % 3];
        if set { (side, side.normalize()) } else { (Vec3::ZERO, -side.normalize()) }
    };
    let ((shift1, out1), (shift2, out2)) = (offset(0, along + 1), offset(1, along + 2));
    let start = cuboid.corner + shift1 + shift2;
    BoxEdge { start, end: start + cuboid.edges[along], outward: (out1 + out2).normalize() }
}

/// Returns vertex 0 to 7 of a box, and its outward direction.
pub(crate) fn box_vertex(cuboid: &BoxRecord, vertex: u32) -> (Vec3, Vec3) {
    let mut place = cuboid.corner;
    let mut outward = Vec3::ZERO;
    for (axis, edge) in cuboid.edges.into_iter().enumerate() {
        if vertex >> axis & 1 == 1 {
            place += edge;
            outward += edge.normalize();
        } else {
            outward -= edge.normalize();
        }
    }
    (place, outward.normalize())
}
