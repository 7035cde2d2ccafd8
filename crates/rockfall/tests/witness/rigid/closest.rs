//! Closest points (docs/physics section 11.13, "Lines" and "Closest points").

use rockfall::glam::{DMat3, DVec3};

use super::polyhedra::Poly;
use super::shapes::{Core, Manifold};

/// Where two lines x + s d and y + t e with unit directions are closest.
pub(crate) fn lines(x: DVec3, d: DVec3, y: DVec3, e: DVec3) -> Option<(f64, f64)> {
    let (w, across) = (y - x, d.cross(e));
    let q = across.length_squared();
    (q >= 1e-7).then(|| (w.cross(e).dot(across) / q, w.cross(d).dot(across) / q))
}

/// A pair of vertices, and the offset between them.
#[derive(Clone, Copy)]
struct Corner {
    i: usize,
    j: usize,
    offset: DVec3,
}

/// The closest points of two sets of vertices, and the least numbers of vertices that take part.
pub(crate) struct Closest {
    pub(crate) x: DVec3,
    pub(crate) y: DVec3,
    pub(crate) i: usize,
    pub(crate) j: usize,
}

/// Weights of the foot of the origin in the plane of corners; `None` if they are not independent.
fn weights(corners: &[Corner]) -> Option<Vec<f64>> {
    let first = corners[0].offset;
    let edges: Vec<DVec3> = corners[1..].iter().map(|corner| corner.offset - first).collect();
    let rest: Vec<f64> = match edges[..] {
        [] => vec![],
        [e] => vec![-first.dot(e) / e.length_squared()],
        [e, f] => {
            let n = e.cross(f);
            let q = n.length_squared();
            vec![f.cross(n).dot(-first) / q, n.cross(e).dot(-first) / q]
        }
        [e, f, g] => {
            let volume = e.dot(f.cross(g));
            vec![-first.dot(f.cross(g)) / volume, -first.dot(g.cross(e)) / volume, -first.dot(e.cross(f)) / volume]
        }
        _ => return None,
    };
    let all: Vec<f64> = [1.0 - rest.iter().sum::<f64>()].into_iter().chain(rest).collect();
    all.iter().all(|weight| weight.is_finite() && *weight > 0.0).then_some(all)
}

/// The part of a simplex that is nearest to the origin, its weights and its point.
fn nearest(simplex: &[Corner]) -> Option<(Vec<Corner>, Vec<f64>, DVec3)> {
    let mut best: Option<(Vec<Corner>, Vec<f64>, DVec3)> = None;
    for set in 1_usize..1 << simplex.len() {
        let part: Vec<Corner> = (0..simplex.len()).filter(|k| set >> k & 1 == 1).map(|k| simplex[k]).collect();
        let Some(weights) = weights(&part) else { continue };
        let z: DVec3 = part.iter().zip(&weights).map(|(corner, weight)| corner.offset * *weight).sum();
        let z = if part.len() == 4 { DVec3::ZERO } else { z };
        if best.as_ref().is_none_or(|(_, _, old)| z.length_squared() < old.length_squared()) {
            best = Some((part, weights, z));
        }
    }
    best
}

/// The method of Gilbert, Johnson and Keerthi.
pub(crate) fn points(a: &[DVec3], b: &[DVec3]) -> Closest {
    let first = |all: &[DVec3], d: DVec3| {
        let most = all.iter().map(|v| v.dot(d)).fold(f64::NEG_INFINITY, f64::max);
        all.iter().position(|v| v.dot(d) == most).expect("vertices")
    };
    let far = |d: DVec3| {
        let (i, j) = (first(a, -d), first(b, d));
        Corner { i, j, offset: b[j] - a[i] }
    };
    let mut simplex = vec![far(a[0] - b[0])];
    let (mut found, mut z) = (vec![1.0], simplex[0].offset);
    for _ in 0..40 {
        let most = simplex.iter().map(|corner| corner.offset.length_squared()).fold(0.0, f64::max);
        if z.length_squared() <= 1e-24 * most {
            break;
        }
        let corner = far(-z);
        let has = simplex.iter().any(|old| (old.i, old.j) == (corner.i, corner.j));
        if has || z.length_squared() - z.dot(corner.offset) <= 1e-11 * z.length_squared() {
            break;
        }
        let more: Vec<Corner> = simplex.iter().copied().chain([corner]).collect();
        let Some((part, weights, nearer)) = nearest(&more) else { break };
        if nearer.length_squared() >= z.length_squared() {
            break;
        }
        (simplex, found, z) = (part, weights, nearer);
    }
    let sum = |of: &dyn Fn(&Corner) -> DVec3| simplex.iter().zip(&found).map(|(corner, weight)| of(corner) * *weight).sum();
    let i = simplex.iter().map(|corner| corner.i).min().expect("a corner");
    let j = simplex.iter().map(|corner| corner.j).min().expect("a corner");
    Closest { x: sum(&|corner| a[corner.i]), y: sum(&|corner| b[corner.j]), i, j }
}

/// The contact of the closest points with a least distance d0.
pub(crate) fn contact(a: &Core, b: &Core, p: DVec3, r: DMat3, bar: f64, d0: f64) -> Option<Manifold> {
    let Closest { x, y, i, j } = points(&Poly::of(a).vertices, &Poly::of(b).placed(p, r).vertices);
    let distance = x.distance(y);
    if distance > bar || distance <= d0 {
        return None;
    }
    Manifold::one((y - x) / distance, x, y, ((i as u32) << 12) + j as u32)
}
