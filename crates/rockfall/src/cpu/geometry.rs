//! Closest points (physics.md section 2; thesis 2.1-2.5).

use glam::Vec3;

use crate::cpu::view::{BoxWords, PolygonWords, TINY};

/// Where two segments come closest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentPair {
    /// Parameter on A, in [0, 1].
    pub(crate) a: f32,
    /// Parameter on B, in [0, 1].
    pub(crate) b: f32,
    /// From A's point to B's.
    pub(crate) d: Vec3,
    /// The common normal; `None` for parallel segments.
    pub(crate) normal: Option<Vec3>,
}

/// `None` where the closest points of the lines lie beyond an end, or a segment has no length.
pub(crate) fn segment_segment(a1: Vec3, a2: Vec3, b1: Vec3, b2: Vec3) -> Option<SegmentPair> {
    let (a_axis, b_axis, c) = (a2 - a1, b2 - b1, b1 - a1);
    let (aa, bb) = (a_axis.length_squared(), b_axis.length_squared());
    if aa <= TINY || bb <= TINY {
        return None;
    }
    let normal = a_axis.cross(b_axis);
    let nn = normal.length_squared();
    if nn <= 1e-8 * aa * bb {
        return parallel_segments(a_axis, b_axis, c);
    }
    let a = c.dot(b_axis.cross(normal)) / nn;
    let b = c.dot(a_axis.cross(normal)) / nn;
    let inside = (0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b);
    inside.then(|| SegmentPair { a, b, d: c + b * b_axis - a * a_axis, normal: Some(normal / nn.sqrt()) })
}

/// The middle of the overlapping stretch.
fn parallel_segments(a_axis: Vec3, b_axis: Vec3, c: Vec3) -> Option<SegmentPair> {
    let aa = a_axis.length_squared();
    let t0 = c.dot(a_axis) / aa;
    let t1 = (c + b_axis).dot(a_axis) / aa;
    let low = t0.min(t1).max(0.0);
    let high = t0.max(t1).min(1.0);
    if low > high {
        return None;
    }
    let a = 0.5 * (low + high);
    let b = ((a * a_axis - c).dot(b_axis) / b_axis.length_squared()).clamp(0.0, 1.0);
    Some(SegmentPair { a, b, d: c + b * b_axis - a * a_axis, normal: None })
}

/// Parameter on the segment and the vector from the point to it (2.4, 2.5); `None` beyond the ends.
pub(crate) fn point_segment(p: Vec3, a1: Vec3, a2: Vec3) -> Option<(f32, Vec3)> {
    let axis = a2 - a1;
    let aa = axis.length_squared();
    if aa <= TINY {
        return None;
    }
    let c = p - a1;
    let a = axis.dot(c) / aa;
    (0.0..=1.0).contains(&a).then(|| (a, a * axis - c))
}

/// Parameters of a point along the three edges of a box.
pub(crate) fn box_parameters(cuboid: &BoxWords, p: Vec3) -> Vec3 {
    let t = p - cuboid.corner;
    Vec3::from_array(cuboid.edges.map(|edge| t.dot(edge) / edge.length_squared()))
}

/// Whether a point lies in a box, its surface included.
pub(crate) fn box_contains(cuboid: &BoxWords, p: Vec3) -> bool {
    let t = box_parameters(cuboid, p);
    t.cmpge(Vec3::ZERO).all() && t.cmple(Vec3::ONE).all()
}

/// Unit vector from a sphere's centre into the box along which they touch, and the centre's distance from the surface,
/// negative inside.
pub(crate) fn point_box(cuboid: &BoxWords, p: Vec3) -> (Vec3, f32) {
    let t = box_parameters(cuboid, p);
    let clamped = t.clamp(Vec3::ZERO, Vec3::ONE);
    let [i, j, k] = cuboid.edges;
    let d = cuboid.corner + clamped.x * i + clamped.y * j + clamped.z * k - p;
    let dd = d.length_squared();
    if clamped == t || dd <= TINY {
        return nearest_face(cuboid, clamped);
    }
    let distance = dd.sqrt();
    (d / distance, distance)
}

/// From inside, the way out is through the nearest face; the first one on ties.
fn nearest_face(cuboid: &BoxWords, t: Vec3) -> (Vec3, f32) {
    let mut nearest = (Vec3::Y, f32::INFINITY);
    for (axis, edge) in cuboid.edges.into_iter().enumerate() {
        let length = edge.length();
        let outward = edge / length;
        for (inward, depth) in [(outward, t[axis] * length), (-outward, (1.0 - t[axis]) * length)] {
            if depth < nearest.1 {
                nearest = (inward, depth);
            }
        }
    }
    (nearest.0, -nearest.1)
}

/// Unit normal of a polygon's face and the height of a point above it; `None` beside the polygon.
pub(crate) fn point_polygon(polygon: &PolygonWords, p: Vec3) -> Option<(Vec3, f32)> {
    let normal = polygon.left.cross(polygon.right);
    let nn = normal.length_squared();
    let t = p - polygon.corner;
    let l = t.cross(polygon.right).dot(normal) / nn;
    let k = polygon.left.cross(t).dot(normal) / nn;
    let face = normal / nn.sqrt();
    let inside = (0.0..=1.0).contains(&l) && (0.0..=1.0).contains(&k);
    inside.then(|| (face, t.dot(face)))
}

/// An edge of a box, and which way is out at it.
pub(crate) struct BoxEdge {
    pub(crate) start: Vec3,
    pub(crate) end: Vec3,
    pub(crate) outward: Vec3,
}

/// Edge 0..12: four along each of I, J, K.
pub(crate) fn box_edge(cuboid: &BoxWords, edge: u32) -> BoxEdge {
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

/// Vertex 0..8 of a box, and which way is out at it.
pub(crate) fn box_vertex(cuboid: &BoxWords, vertex: u32) -> (Vec3, Vec3) {
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
