//! Distance and separation of convex vertex sets by trying everything, in double precision. Only for tests.

use glam::DVec3;

use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};

/// Vertices of a core in a pose.
pub(super) fn vertices(shape: &Shape, pose: &Pose) -> Vec<DVec3> {
    let turn = pose.turn.as_dquat().normalize();
    let signs = |k: usize| DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64) * 2.0 - 1.0;
    let inner: Vec<DVec3> = match &shape.core {
        Core::Point => vec![DVec3::ZERO],
        Core::Segment { half } => vec![DVec3::Y * *half as f64, -DVec3::Y * *half as f64],
        Core::Face { u, v, is_triangle: true, .. } => [*u, *v, -*u - *v].map(|p| p.as_dvec3()).to_vec(),
        Core::Face { u, v, .. } => vec![*u + *v, *u - *v, -*u - *v, *v - *u].into_iter().map(|p| p.as_dvec3()).collect(),
        Core::Box { half } => (0..8).map(|k| half.as_dvec3() * signs(k)).collect(),
        Core::Hull(hull) => hull.vertices.iter().map(|p| p.as_dvec3()).collect(),
        Core::HalfSpace | Core::Cone { .. } | Core::Bowl { .. } => Vec::new(),
    };
    inner.into_iter().map(|p| pose.position.as_dvec3() + turn * p).collect()
}

fn pairs(points: &[DVec3]) -> Vec<(DVec3, DVec3)> {
    (0..points.len()).flat_map(|i| (i + 1..points.len()).map(move |j| (points[i], points[j]))).collect()
}

fn triples(points: &[DVec3]) -> Vec<[DVec3; 3]> {
    let count = points.len();
    let all = (0..count).flat_map(move |i| (i + 1..count).flat_map(move |j| (j + 1..count).map(move |k| [i, j, k])));
    all.map(|numbers| numbers.map(|k| points[k])).collect()
}

fn segment_point((p, q): (DVec3, DVec3), x: DVec3) -> f64 {
    let along = q - p;
    let part = ((x - p).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    (p + along * part).distance(x)
}

fn triangle_point([p, q, r]: [DVec3; 3], x: DVec3) -> f64 {
    let normal = (q - p).cross(r - p);
    if normal.length_squared() == 0.0 {
        return f64::INFINITY;
    }
    let foot = x - normal * ((x - p).dot(normal) / normal.length_squared());
    let is_left = |s: DVec3, e: DVec3| (e - s).cross(foot - s).dot(normal) >= 0.0;
    if is_left(p, q) && is_left(q, r) && is_left(r, p) { foot.distance(x) } else { f64::INFINITY }
}

fn segment_segment(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> f64 {
    let ends = [segment_point(a, b.0), segment_point(a, b.1), segment_point(b, a.0), segment_point(b, a.1)];
    let least = ends.into_iter().fold(f64::INFINITY, f64::min);
    let (d, e) = (a.1 - a.0, b.1 - b.0);
    let normal = d.cross(e);
    let square = normal.length_squared();
    if square < 1e-20 * d.length_squared() * e.length_squared() {
        return least;
    }
    let way = b.0 - a.0;
    let (s, t) = (way.cross(e).dot(normal) / square, way.cross(d).dot(normal) / square);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) { least.min((way + e * t - d * s).length()) } else { least }
}

/// Distance of two sets that do not overlap.
pub(super) fn distance(a: &[DVec3], b: &[DVec3]) -> f64 {
    let mut least = f64::INFINITY;
    for p in a {
        b.iter().for_each(|q| least = least.min(p.distance(*q)));
        pairs(b).into_iter().for_each(|edge| least = least.min(segment_point(edge, *p)));
        triples(b).into_iter().for_each(|triangle| least = least.min(triangle_point(triangle, *p)));
    }
    for q in b {
        pairs(a).into_iter().for_each(|edge| least = least.min(segment_point(edge, *q)));
        triples(a).into_iter().for_each(|triangle| least = least.min(triangle_point(triangle, *q)));
    }
    for edge in pairs(a) {
        pairs(b).into_iter().for_each(|other| least = least.min(segment_segment(edge, other)));
    }
    least
}

/// The greatest separation along any axis of faces and pairs of edges: minus the depth of an overlap.
pub(super) fn separation(a: &[DVec3], b: &[DVec3]) -> f64 {
    let along = |axis: DVec3, points: &[DVec3]| points.iter().map(|p| p.dot(axis)).fold(f64::INFINITY, f64::min);
    let mut best = f64::NEG_INFINITY;
    let mut try_axis = |axis: DVec3, scale: f64| {
        if axis.length_squared() > 1e-14 * scale {
            let axis = axis.normalize();
            best = best.max(along(axis, b) + along(-axis, a)).max(along(axis, a) + along(-axis, b));
        }
    };
    for [p, q, r] in triples(a).into_iter().chain(triples(b)) {
        let normal = (q - p).cross(r - p);
        let scale = (q - p).length_squared() * (r - p).length_squared();
        try_axis(normal, scale);
        if a.len().min(b.len()) <= 4 {
            // Flat shapes have sides.
            [q - p, r - p, r - q].into_iter().for_each(|edge| try_axis(normal.cross(edge), scale * edge.length_squared()));
        }
    }
    for (p, q) in pairs(a) {
        for (r, s) in pairs(b) {
            try_axis((q - p).cross(s - r), (q - p).length_squared() * (s - r).length_squared());
        }
    }
    best
}

/// Distance, or minus the depth of the overlap.
pub(super) fn gap(a: &[DVec3], b: &[DVec3]) -> f64 {
    if a.len().max(b.len()) <= 2 {
        return distance(a, b);
    }
    let separation = separation(a, b);
    if separation > 0.0 { distance(a, b) } else { separation }
}
