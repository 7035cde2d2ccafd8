//! Contacts of the axis of a rod with the edges and vertices of polygons, and which of them are no edges of the surface
//! (docs/physics section 2.19).

use rockfall::glam::DVec3;

use crate::geometry::{Line, PARALLEL, Thing, on_segment, place_over, without_rounding};
use crate::world::{Face, World};

/// Distance, as a part of the radius of a rod, up to which places are one, and at which the surface beside an edge is looked for.
const NEAR: f64 = 1e-3;
/// Room along the edges of a polygon, as a part of that distance.
const ROOM: f64 = 0.3;
/// The sine of the angle up to which a bent surface has no edge.
const BENT: f64 = 0.01;
/// Cosine of the least angle between two polygons of which one goes on at the edge of the other.
const FOLDED: f64 = 0.5;
/// An edge leads towards a rod if the cosine of its angle with the normal is less than this.
const TOWARDS: f64 = -1e-3;

/// An edge of a polygon: its start, and the vector to its end.
#[derive(Clone, Copy)]
struct Rim {
    start: DVec3,
    along: DVec3,
}

impl Rim {
    fn all(face: &Face) -> Vec<Self> {
        let &Face { corner, left, right, is_triangle, .. } = face;
        let rim = |start: DVec3, along: DVec3| Self { start, along };
        if is_triangle {
            return vec![rim(corner, left), rim(corner, right), rim(corner + left, right - left)];
        }
        vec![rim(corner, left), rim(corner + right, left), rim(corner, right), rim(corner + left, right)]
    }

    fn ends(&self) -> [DVec3; 2] {
        [self.start, self.start + self.along]
    }

    fn distance(&self, point: DVec3) -> f64 {
        let at = (point - self.start).dot(self.along) / self.along.length_squared();
        (self.start + at.clamp(0.0, 1.0) * self.along).distance(point)
    }
}

/// The contact of a rod with one edge of a polygon.
#[derive(Clone, Copy)]
pub(crate) struct Rimmed {
    pub(crate) line: Line,
    /// The point of the edge.
    place: DVec3,
    is_vertex: bool,
}

/// The contact of an axis with an edge, also where they are apart.
fn axis_rim(ends: [DVec3; 2], radius: f64, face: &Face, rim: Rim) -> Option<Rimmed> {
    let (axis, to_start) = (ends[1] - ends[0], rim.start - ends[0]);
    let (aa, ee) = (axis.length_squared(), rim.along.length_squared());
    let n = axis.cross(rim.along);
    if aa == 0.0 || ee == 0.0 || n.length_squared() <= PARALLEL * aa * ee {
        return None;
    }
    let b = to_start.dot(axis.cross(n)) / n.length_squared();
    let is_vertex = !on_segment(b);
    let place = rim.start + if is_vertex { b.clamp(0.0, 1.0) } else { b } * rim.along;
    let a = if is_vertex { (place - ends[0]).dot(axis) / aa } else { to_start.dot(rim.along.cross(n)) / n.length_squared() };
    if !on_segment(a) {
        return None;
    }
    let way = place - ends[0] - a * axis;
    let d = if is_vertex { way - way.dot(axis) / aa * axis } else { n * (way.dot(n) / n.length_squared()) };
    let d = without_rounding(d, aa + ee, radius);
    let front = face.left.cross(face.right);
    if !face.is_triangle && d.dot(front) > 0.0 {
        return None;
    }
    let n = if d == DVec3::ZERO { -front.normalize() } else { d.normalize() };
    Some(Rimmed { line: Line::new(n, radius - d.length(), [a, 0.0]), place, is_vertex })
}

impl World {
    /// The contact of a rod with a feature of a polygon, also where they are apart.
    pub(crate) fn rimmed(&self, bar: usize, face: usize, feature: usize) -> Option<Rimmed> {
        let rim = *Rim::all(&self.faces[face]).get(feature)?;
        axis_rim(self.ends(bar), self.bars[bar].radius, &self.faces[face], rim)
    }

    /// The contact where the rod overlaps the feature, unless its end spheres carry it there.
    fn carried(&self, bar: usize, face: usize, feature: usize) -> Option<Rimmed> {
        let radius = self.bars[bar].radius;
        let rim = *Rim::all(&self.faces[face]).get(feature)?;
        let lies_along = self.ends(bar).into_iter().all(|end| rim.distance(end) < radius);
        self.rimmed(bar, face, feature).filter(|found| found.line.o > 0.0 && !lies_along)
    }

    /// The features of a polygon that a rod touches, without those that are no edges of the surface.
    pub(crate) fn rims(&self, bar: usize, face: usize) -> Vec<(usize, Line)> {
        let of = |feature| self.carried(bar, face, feature).map(|found| (feature, found));
        let seen = (0..4).filter_map(of).filter(|(feature, found)| !self.is_rim_hidden(bar, (face, *feature), found));
        seen.map(|(feature, found)| (feature, found.line)).collect()
    }

    fn is_rim_hidden(&self, bar: usize, own: (usize, usize), found: &Rimmed) -> bool {
        let near = NEAR * self.bars[bar].radius;
        let joins = |face: &usize| self.are_one_body(Thing::Face(own.0), Thing::Face(*face));
        let may_meet = |face: &usize| self.faces[*face].group == self.bars[bar].group && joins(face);
        (0..self.faces.len()).filter(may_meet).any(|other| {
            let features = 0..Rim::all(&self.faces[other]).len();
            let comes_first = |feature: usize| {
                let their = self.carried(bar, other, feature).filter(|their| their.place.distance(found.place) <= near);
                their.is_some_and(|their| (their.is_vertex, other, feature) < (found.is_vertex, own.0, own.1))
            };
            other != own.0 && self.goes_on(other, own, found, near)
                || features.clone().any(comes_first)
                || found.is_vertex && Rim::all(&self.faces[other]).iter().any(|rim| leads_nearer(rim, found, near))
        })
    }

    /// Whether a polygon goes on at the edge of another one.
    fn goes_on(&self, other: usize, own: (usize, usize), found: &Rimmed, near: f64) -> bool {
        let (face, own_face) = (&self.faces[other], &self.faces[own.0]);
        let edge = Rim::all(own_face)[own.1].along.normalize();
        let across = edge.cross(face.left.cross(face.right).normalize());
        if across.length_squared() < 1e-6 {
            return false;
        }
        // The middle of a polygon is on the inner side of each of its edges.
        let share = if own_face.is_triangle { 1.0 / 3.0 } else { 0.5 };
        let inward = own_face.corner + share * (own_face.left + own_face.right) - found.place;
        let w = (inward - inward.dot(edge) * edge).normalize();
        [across.normalize(), -across.normalize()]
            .into_iter()
            .any(|v| v.dot(w) <= FOLDED && found.line.n.dot(w + v) <= BENT && belongs(face, found.place + near * v, near))
    }
}

/// Whether a point belongs to a polygon, with some room.
fn belongs(face: &Face, point: DVec3, near: f64) -> bool {
    let (at, normal) = place_over(point, face);
    let room = [face.left, face.right].map(|edge| ROOM * near / edge.length());
    let is_in = (0..2).all(|k| (-room[k]..=1.0 + room[k]).contains(&at[k]));
    let is_on_triangle = !face.is_triangle || at[0] + at[1] <= 1.0 + room[0].max(room[1]);
    (point - face.corner).dot(normal).abs() <= near && is_in && is_on_triangle
}

/// Whether an edge leads from a vertex towards the rod.
fn leads_nearer(rim: &Rim, found: &Rimmed, near: f64) -> bool {
    let leads = |end: DVec3| {
        let way = end - found.place;
        way.length() > near && found.line.n.dot(way.normalize()) < TOWARDS
    };
    rim.distance(found.place) <= near && rim.ends().into_iter().any(leads)
}
