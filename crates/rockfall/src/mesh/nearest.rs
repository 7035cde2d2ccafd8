//! The points of segments and triangles that are nearest to a point.

use glam::DVec3;

/// The point of a segment that is nearest to a point.
pub(crate) fn on_segment(point: DVec3, [one, other]: &[DVec3; 2]) -> DVec3 {
    let along = other - one;
    let share = (point - one).dot(along) / along.length_squared();
    one + along * if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
}

/// The point of a triangle that is nearest to a point: its foot if that is inside, otherwise the nearest point of an edge.
pub(crate) fn on_triangle(point: DVec3, [a, b, c]: &[DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let inside = [[a, b], [b, c], [c, a]].iter().all(|[from, to]| (*to - *from).cross(point - *from).dot(normal) >= 0.0);
    if inside {
        return point - normal * ((point - a).dot(normal) / normal.length_squared());
    }
    let edges = [[*a, *b], [*b, *c], [*c, *a]].map(|edge| on_segment(point, &edge));
    edges.into_iter().min_by(|p, q| point.distance_squared(*p).total_cmp(&point.distance_squared(*q))).unwrap_or(*a)
}
