//! Polygons, segments and the choice of four points.

use glam::Vec3;

use crate::rigid::collide::Manifold;

/// A point that may become a contact: points of both cores.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Candidate {
    pub(super) on_a: Vec3,
    pub(super) on_b: Vec3,
    /// Of the cores, along the normal.
    pub(super) separation: f32,
    pub(super) id: u32,
}

/// A tilt below which the first point is extreme along the fixed direction; above it, the deepest is the first.
const FLAT: f32 = 1e-3;

/// At most four of the candidates: the deepest (of flat contacts the extreme one along `along`), the farthest from it, the one
/// of the largest triangle, and the farthest on the other side. The first of nearly equal candidates counts.
pub(super) fn reduce(candidates: &[Candidate], normal: Vec3, along: Vec3, radii: (f32, f32)) -> Option<Manifold> {
    let mut manifold = Manifold::empty(normal);
    let mut push = |index: usize| {
        let chosen = &candidates[index];
        manifold.push((chosen.on_a, chosen.on_b), radii, chosen.id);
    };
    if candidates.len() <= 4 {
        (0..candidates.len()).for_each(push);
        return manifold.some();
    }
    let place = |index: usize| candidates[index].on_a;
    let count = candidates.len();
    let spread = (1..count).map(|k| place(k).distance_squared(place(0))).fold(0.0, f32::max).sqrt();
    let first = greatest(count, |k| -candidates[k].separation - FLAT * place(k).dot(along), 0.0, 0.5 * FLAT * spread)?.1;
    let second = greatest(count, |k| place(k).distance_squared(place(first)), 0.01, 0.0)?.1;
    let edge = place(second) - place(first);
    let area = |k: usize| edge.cross(place(k) - place(first)).dot(normal);
    let (size, third) = greatest(count, |k| area(k).abs(), 0.01, 0.0)?;
    push(first);
    push(second);
    // Points on a line: two are enough.
    let thin = 1e-5 * edge.length_squared();
    if size > thin {
        push(third);
        let side = area(third).signum();
        let beyond = |k: usize| beyond([first, second, third].map(place), place(k), normal * side);
        let (size, fourth) = greatest(count, beyond, 0.01, 0.0)?;
        if size > thin {
            push(fourth);
        }
    }
    manifold.some()
}

/// How far a point lies outside of a triangle that runs counterclockwise about the normal: twice the largest area beyond an
/// edge.
fn beyond([p, q, r]: [Vec3; 3], point: Vec3, normal: Vec3) -> f32 {
    let out = |start: Vec3, end: Vec3| (point - start).cross(end - start).dot(normal);
    out(p, q).max(out(q, r)).max(out(r, p))
}

/// The index of the first value that is nearly the greatest, up to a part of it and an absolute margin, so that rounding does
/// not change the choice.
fn greatest(count: usize, value: impl Fn(usize) -> f32, part: f32, margin: f32) -> Option<(f32, usize)> {
    let most = (0..count).map(&value).fold(f32::NEG_INFINITY, f32::max);
    let enough = most - part * most.abs() - margin;
    (0..count).map(|index| (value(index), index)).find(|(value, _)| *value >= enough)
}

/// How far from their origins the nearest points of two lines with unit directions are; `None` if the lines are parallel.
pub(super) fn closest_of_lines(origin: Vec3, along: Vec3, other: Vec3, across: Vec3) -> Option<(f32, f32)> {
    // Nearly parallel lines need double precision, and directions of that length.
    let (origin, along) = (origin.as_dvec3(), along.as_dvec3().normalize_or_zero());
    let (other, across) = (other.as_dvec3(), across.as_dvec3().normalize_or_zero());
    let cosine = along.dot(across);
    let square = along.cross(across).length_squared();
    if square < 1e-7 {
        return None;
    }
    let way = other - origin;
    let (s, t) = (way.dot(along), way.dot(across));
    Some((((s - t * cosine) / square) as f32, ((s * cosine - t) / square) as f32))
}

/// Greatest number of corners of a clipped polygon: those of two faces of hulls, rounded up.
pub(super) const MOST_CORNERS: usize = 64;

/// A convex polygon: its corners, and the label of the edge after each.
pub(super) struct Polygon {
    corners: [(Vec3, u8); MOST_CORNERS],
    count: usize,
}

impl Polygon {
    /// A polygon whose edges have their numbers as labels. Two corners are a segment.
    pub(super) fn new(corners: impl IntoIterator<Item = Vec3>) -> Self {
        let mut polygon = Self { corners: [(Vec3::ZERO, 0); MOST_CORNERS], count: 0 };
        for (label, corner) in corners.into_iter().take(MOST_CORNERS).enumerate() {
            polygon.corners[label] = (corner, label as u8);
            polygon.count += 1;
        }
        polygon
    }

    /// Corners, each with the labels of the edges before and after it.
    pub(super) fn corners(&self) -> impl Iterator<Item = (Vec3, (u8, u8))> {
        let before = |k: usize| self.corners[(k + self.count - 1) % self.count].1;
        self.corners[..self.count].iter().enumerate().map(move |(k, (corner, label))| (*corner, (before(k), *label)))
    }

    /// Removes what lies above a plane. The new edge gets a label.
    pub(super) fn cut(&mut self, normal: Vec3, offset: f32, label: u8) {
        let height = |k: usize| self.corners[k].0.dot(normal) - offset;
        if (0..self.count).all(|k| height(k) <= 0.0) {
            return;
        }
        let mut kept = [(Vec3::ZERO, 0); MOST_CORNERS];
        let mut count = 0;
        let mut put = |corner: (Vec3, u8)| {
            // A cut of a convex polygon adds at most one corner. Rounding of thin ones must not add more.
            if count < MOST_CORNERS {
                kept[count] = corner;
                count += 1;
            }
        };
        let edges = if self.count == 2 { 1 } else { self.count };
        for k in 0..edges {
            let next = (k + 1) % self.count;
            let ((from, edge), (to, last)) = (self.corners[k], self.corners[next]);
            let (above, below) = (height(k), height(next));
            if above <= 0.0 {
                put((from, edge));
            }
            if (above > 0.0) != (below > 0.0) {
                put((from + (to - from) * (above / (above - below)), if above > 0.0 { edge } else { label }));
            }
            if self.count == 2 && below <= 0.0 {
                put((to, last));
            }
        }
        (self.corners, self.count) = (kept, count);
    }
}
