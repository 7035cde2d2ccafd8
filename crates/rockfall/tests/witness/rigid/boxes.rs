//! Manifolds of two sharp boxes (docs/physics section 11.13, "Box with box").

use rockfall::glam::{DMat3, DVec3};

use super::closest;
use super::polyhedra::{self, reduced};
use super::shapes::{Core, EPSILON, Manifold, Place, sgn};

/// Both boxes, the second one at `p` turned by `r`.
struct Boxes {
    a: DVec3,
    b: DVec3,
    p: DVec3,
    r: DMat3,
    /// Least half edge of both.
    least: f64,
    /// Allowance for rounding.
    nu: f64,
    reach: f64,
}

fn next(i: usize) -> usize {
    (i + 1) % 3
}

fn last(i: usize) -> usize {
    (i + 2) % 3
}

pub(crate) fn manifold(a: DVec3, b: DVec3, p: DVec3, r: DMat3, reach: f64) -> Option<Manifold> {
    let least = a.min_element().min(b.min_element());
    let nu = 4.0 * EPSILON * (p.abs().max_element() + a.max_element() + b.max_element());
    let pair = Boxes { a, b, p, r, least, nu, reach };
    let (axis, face) = pair.face_axis()?;
    let edges = pair.edge_axis()?;
    let edge = edges.map_or(f64::NEG_INFINITY, |(_, _, value)| value);
    let contact = |inset: f64| edges.and_then(|(i, j, _)| pair.edges(i, j, inset));
    if edge > face + 0.05 * face.abs() + 0.01 * least
        && let Some(found) = contact(0.0)
    {
        return Some(found);
    }
    let (both, d0) = (edge.max(face), 1e-3 * least + nu);
    let near = || closest::contact(&Core::Cuboid(a), &Core::Cuboid(b), p, r, reach, d0);
    match pair.face(axis) {
        Some(found) if both > 0.0 && found.least() > both + 0.02 * least + nu => {
            Some(near().filter(|other| other.least() < found.least() - 0.02 * least).unwrap_or(found))
        }
        Some(found) => Some(found),
        None if both > -0.01 * least - nu => near().or_else(|| contact(1e-3 * least)),
        None => contact(0.0).or_else(|| polyhedra::manifold(&Core::Cuboid(a), &Core::Cuboid(b), p, r, reach)),
    }
}

impl Boxes {
    /// The best axis of a face, 0 to 2 of a and 3 to 5 of b, and its separation. `None` beyond the reach.
    fn face_axis(&self) -> Option<(usize, f64)> {
        let Self { a, b, p, r, .. } = self;
        let back = r.transpose();
        let (of_a, of_b) = (back.transpose(), back * *p);
        let along_a = |i: usize| p[i].abs() - a[i] - of_a.row(i).abs().dot(*b);
        let along_b = |j: usize| of_b[j].abs() - b[j] - r.col(j).abs().dot(*a);
        let mut best: Option<(usize, f64)> = None;
        for k in 0..6 {
            let value = if k < 3 { along_a(k) } else { along_b(k - 3) };
            if value > self.reach {
                return None;
            }
            if best.is_none_or(|(_, f)| value > f + 0.02 * f.abs() + 1e-3 * self.least) {
                best = Some((k, value));
            }
        }
        best
    }

    /// E of edges i and j.
    fn edge_separation(&self, i: usize, j: usize) -> f64 {
        let Self { a, b, p, r, .. } = self;
        let (c, at) = (r.col(j), |row: usize, column: usize| r.col(column)[row]);
        let q = c[next(i)].powi(2) + c[last(i)].powi(2);
        if q < 1e-6 {
            return f64::NEG_INFINITY;
        }
        let mine = a[next(i)] * c[last(i)].abs() + a[last(i)] * c[next(i)].abs();
        let other = b[next(j)] * at(i, last(j)).abs() + b[last(j)] * at(i, next(j)).abs();
        (p.cross(c)[i].abs() - mine - other - self.nu) / q.sqrt()
    }

    /// The edges whose axis is best, and the greatest E. The outer `None` is beyond the reach.
    #[expect(clippy::option_option, reason = "no manifold, and no axis of edges")]
    fn edge_axis(&self) -> Option<Option<(usize, usize, f64)>> {
        let all = || (0..9).map(|k| (k / 3, k % 3, self.edge_separation(k / 3, k % 3)));
        let greatest = all().map(|(_, _, value)| value).fold(f64::NEG_INFINITY, f64::max);
        if greatest > self.reach {
            return None;
        }
        let enough = greatest - 0.02 * greatest.abs() - 1e-3 * self.least;
        let found = all().find(|&(_, _, value)| value >= enough).filter(|_| greatest > f64::NEG_INFINITY);
        Some(found.map(|(i, j, _)| (i, j, greatest)))
    }

    /// Contact of edges.
    fn edges(&self, i: usize, j: usize, inset: f64) -> Option<Manifold> {
        let Self { a, b, p, r, .. } = self;
        let (d, e) = (DVec3::AXES[i], r.col(j));
        let mut n = d.cross(e).try_normalize()?;
        if n.dot(*p) < 0.0 {
            n = -n;
        }
        let tau = |k: usize| sgn(-n.dot(r.col(k)));
        let one: DVec3 = [next(i), last(i)].map(|k| sgn(n[k]) * a[k] * DVec3::AXES[k]).into_iter().sum();
        let other: DVec3 = *p + [next(j), last(j)].map(|k| tau(k) * b[k] * r.col(k)).into_iter().sum::<DVec3>();
        let (s, t) = closest::lines(one, d, other, e)?;
        if s.abs() > 1.0001 * a[i] - inset || t.abs() > 1.0001 * b[j] - inset {
            return None;
        }
        let (x, y) = (one + s * d, other + t * e);
        if (y - x).dot(n) > self.reach {
            return None;
        }
        let bit = |is: bool, value: u32| if is { value } else { 0 };
        let sides =
            bit(n[next(i)] > 0.0, 1) + bit(n[last(i)] > 0.0, 2) + bit(tau(next(j)) > 0.0, 4) + bit(tau(last(j)) > 0.0, 8);
        let number = 16 * (3 * i + j) as u32 + sides;
        Manifold::one(n, x, y, (1 << 31) + (number << 12))
    }

    /// Contact of the face of an axis.
    fn face(&self, axis: usize) -> Option<Manifold> {
        if axis < 3 {
            return self.own_face(axis, 0);
        }
        let back = self.r.transpose();
        let other = Self { a: self.b, b: self.a, p: -(back * self.p), r: back, ..*self };
        Some(other.own_face(axis - 3, 1)?.turned_back(self.p, self.r))
    }

    fn own_face(&self, i: usize, w: u32) -> Option<Manifold> {
        let Self { a, b, p, r, least, .. } = self;
        let sigma = sgn(p[i]);
        let mut k = 0;
        for other in 1..3 {
            if r.col(other)[i].abs() > r.col(k)[i].abs() + 1e-4 {
                k = other;
            }
        }
        let tau = if sigma * r.col(k)[i] > 0.0 { -1.0 } else { 1.0 };
        let (m, one, other) = (*p + tau * b[k] * r.col(k), b[next(k)] * r.col(next(k)), b[last(k)] * r.col(last(k)));
        let four = [m - one - other, m + one - other, m + one + other, m - one + other];
        let mut polygon: Vec<(DVec3, u32)> = four.into_iter().zip(0..).collect();
        for (number, (along, side)) in
            [(next(i), 1.0), (next(i), -1.0), (last(i), 1.0), (last(i), -1.0)].into_iter().enumerate()
        {
            if four.iter().any(|y| side * y[along] > a[along] + 1e-4 * least) {
                polygon = cut(&polygon, 4 + number as u32, |y| side * y[along] - a[along]);
            }
        }
        let extent = |along: usize| {
            let all = polygon.iter().map(|(y, _)| y[along]);
            all.clone().fold(f64::NEG_INFINITY, f64::max) - all.fold(f64::INFINITY, f64::min)
        };
        if polygon.is_empty() || extent(next(i)) < 1e-3 * least || extent(last(i)) < 1e-3 * least {
            return None;
        }
        let features = (1 << 30)
            + (w << 24)
            + ((2 * i as u32 + u32::from(sigma < 0.0)) << 18)
            + ((2 * k as u32 + u32::from(tau < 0.0)) << 12);
        let mut places = Vec::new();
        for (at, &(y, after)) in polygon.iter().enumerate() {
            let before = polygon[(at + polygon.len() - 1) % polygon.len()].1;
            let mut x = y;
            x[i] = sigma * a[i];
            if sigma * y[i] - a[i] <= self.reach {
                places.push(Place { x, y, id: features + (before << 6) + after });
            }
        }
        let n = sigma * DVec3::AXES[i];
        Manifold::new(n, reduced(places, n, DVec3::AXES[next(i)]))
    }
}

/// Cuts a polygon, whose corners have the labels of the edges after them, where `beyond` is positive.
pub(crate) fn cut(polygon: &[(DVec3, u32)], label: u32, beyond: impl Fn(DVec3) -> f64) -> Vec<(DVec3, u32)> {
    let mut left = Vec::new();
    for (at, &(y, edge)) in polygon.iter().enumerate() {
        let to = polygon[(at + 1) % polygon.len()].0;
        let (here, there) = (beyond(y), beyond(to));
        if here <= 0.0 {
            left.push((y, edge));
        }
        if (here > 0.0) != (there > 0.0) {
            let crossing = y + (to - y) * (here / (here - there));
            left.push((crossing, if here > 0.0 { edge } else { label }));
        }
    }
    left
}
