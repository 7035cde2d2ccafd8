//! Closest points of the convex hulls of two sets of vertices: the method of Gilbert, Johnson and Keerthi.

use glam::{DVec3, Vec3};

/// Closest points of two sets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    pub(super) on_a: DVec3,
    pub(super) on_b: DVec3,
    /// Distance of the points; 0 if the sets overlap.
    pub(super) distance: f64,
    /// The least numbers of the vertices that span the nearest features.
    pub(super) features: (usize, usize),
}

/// A vertex of the difference b - a.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    on_a: DVec3,
    on_b: DVec3,
    numbers: (usize, usize),
    /// Part of the closest point.
    weight: f64,
}

impl Corner {
    fn offset(&self) -> DVec3 {
        self.on_b - self.on_a
    }
}

/// The most rounds. A round finds a nearer point or is the last one; a few are usual.
const MOST_ROUNDS: usize = 40;

/// Closest points of the hulls of two sets of vertices.
pub(super) fn closest(a: &[Vec3], b: &[Vec3]) -> Closest {
    let mut simplex = [Corner::default(); 4];
    simplex[0] = support(a, b, (a[0] - b[0]).as_dvec3());
    simplex[0].weight = 1.0;
    let mut count = 1;
    let mut nearest = simplex[0].offset();
    for _ in 0..MOST_ROUNDS {
        let square = nearest.length_squared();
        let scale = simplex[..count].iter().map(|corner| corner.offset().length_squared()).fold(0.0, f64::max);
        // The origin is inside, up to rounding.
        if square <= 1e-24 * scale {
            break;
        }
        let next = support(a, b, -nearest);
        let is_known = simplex[..count].iter().any(|corner| corner.numbers == next.numbers);
        if is_known || square - nearest.dot(next.offset()) <= 1e-11 * square {
            break;
        }
        let before = (simplex, count);
        simplex[count] = next;
        count = reduce(&mut simplex, count + 1);
        let found: DVec3 = simplex[..count].iter().map(|corner| corner.offset() * corner.weight).sum();
        if found.length_squared() >= square {
            (simplex, count) = before;
            break;
        }
        nearest = found;
        if count == 4 {
            nearest = DVec3::ZERO;
            break;
        }
    }
    let used = &simplex[..count];
    let least = |number: fn(&Corner) -> usize| used.iter().map(number).min().unwrap_or(0);
    Closest {
        on_a: used.iter().map(|corner| corner.on_a * corner.weight).sum(),
        on_b: used.iter().map(|corner| corner.on_b * corner.weight).sum(),
        distance: nearest.length(),
        features: (least(|corner| corner.numbers.0), least(|corner| corner.numbers.1)),
    }
}

/// The vertex of b - a that is farthest along a direction.
fn support(a: &[Vec3], b: &[Vec3], direction: DVec3) -> Corner {
    let farthest = |points: &[Vec3], direction: DVec3| {
        let mut best = (f64::NEG_INFINITY, 0);
        for (number, point) in points.iter().enumerate() {
            let along = point.as_dvec3().dot(direction);
            if along > best.0 {
                best = (along, number);
            }
        }
        best.1
    };
    let numbers = (farthest(a, -direction), farthest(b, direction));
    Corner { on_a: a[numbers.0].as_dvec3(), on_b: b[numbers.1].as_dvec3(), numbers, weight: 0.0 }
}

/// Leaves the corners of the least face of the simplex that has its point nearest to the origin, with their weights.
fn reduce(simplex: &mut [Corner; 4], count: usize) -> usize {
    let corners = *simplex;
    let mut best = (f64::INFINITY, 0, [0.0; 4]);
    // All faces of the simplex, as sets of corners. The nearest valid point is the right one.
    for set in 1usize..1 << count {
        let Some(weights) = project(&corners, set) else { continue };
        let point: DVec3 = (0..4).map(|k| corners[k].offset() * weights[k]).sum();
        let square = if set == 15 { 0.0 } else { point.length_squared() };
        if square < best.0 {
            best = (square, set, weights);
        }
    }
    let mut kept = 0;
    for (k, corner) in corners.iter().enumerate() {
        if best.1 >> k & 1 == 1 {
            simplex[kept] = Corner { weight: best.2[k], ..*corner };
            kept += 1;
        }
    }
    kept
}

/// Weights of the foot of the origin on the plane of some corners; `None` if it is not among them.
fn project(corners: &[Corner; 4], set: usize) -> Option<[f64; 4]> {
    let mut numbers = [0; 4];
    let mut count = 0;
    for k in 0..4 {
        if set >> k & 1 == 1 {
            numbers[count] = k;
            count += 1;
        }
    }
    let point = |k: usize| corners[numbers[k]].offset();
    let mut weights = [0.0; 4];
    match count {
        1 => weights[numbers[0]] = 1.0,
        2 => {
            let (p, edge) = (point(0), point(1) - point(0));
            let part = -p.dot(edge) / edge.length_squared();
            (weights[numbers[0]], weights[numbers[1]]) = (1.0 - part, part);
        }
        3 => {
            let (p, q, r) = (point(0), point(1), point(2));
            let normal = (q - p).cross(r - p);
            let square = normal.length_squared();
            let part = |u: DVec3, v: DVec3| u.cross(v).dot(normal) / square;
            (weights[numbers[0]], weights[numbers[1]], weights[numbers[2]]) = (part(q, r), part(r, p), part(p, q));
        }
        _ => {
            let (p, q, r, s) = (point(0), point(1), point(2), point(3));
            let volume = (q - p).dot((r - p).cross(s - p));
            let part = |u: DVec3, v: DVec3, w: DVec3| u.dot(v.cross(w)) / volume;
            weights = [part(q, s, r), part(p, r, s), part(p, s, q), part(p, q, r)];
            weights = if weights.iter().sum::<f64>() < 0.0 { weights.map(|weight| -weight) } else { weights };
        }
    }
    // Not a number for corners that lie on a line or in a plane.
    let is_inside = numbers[..count].iter().all(|k| weights[*k] > 0.0 && weights[*k] <= 1.0 + 1e-9);
    is_inside.then_some(weights)
}
