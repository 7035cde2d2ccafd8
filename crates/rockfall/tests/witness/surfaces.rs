//! All boxes and polygons as one surface: which contacts of a sphere are hidden (docs/physics section 2.11).

use std::cmp::Ordering;

use rockfall::glam::DVec3;

use crate::geometry::{Feature, Line, Pair, Thing, in_box, is_on_face};
use crate::world::{Mistake, World};

/// A shape is behind another one if its nearest point is at most this part of the radius in front of the other's tangent plane.
const BEHIND: f64 = 1e-5;
/// Normals that differ by at most this angle count as the same.
const SAME_NORMAL: f64 = 0.01;
/// Distance from an edge, as a part of the radius of a rod, at which another box is looked for.
const BESIDE: f64 = 1e-3;

/// A box or a polygon that a sphere overlaps.
struct Candidate {
    thing: Thing,
    /// Place in the list of contacts.
    place: usize,
    /// Signed distance from the centre of the sphere.
    d: f64,
    /// Whether the nearest point is on a face, not on an edge or a corner.
    on_face: bool,
    n: DVec3,
    /// Whether it is a polygon, and the numbers of its corner and edges.
    geometry: (bool, Vec<f64>),
    /// Corner and edges, seen from the centre of the sphere.
    corner: DVec3,
    edges: Vec<DVec3>,
    is_triangle: bool,
}

impl Candidate {
    fn before(&self, other: &Self) -> Ordering {
        let numbers = |one: &Self, two: &Self| one.geometry.partial_cmp(&two.geometry).expect("finite numbers");
        let key = |one: &Self| if one.on_face || one.d < 0.0 { one.d } else { one.d * (1.0 + 2e-6) };
        key(self).total_cmp(&key(other)).then_with(|| numbers(self, other))
    }

    /// Depth behind the centre, along a direction, of the vertex that is least deep.
    fn least_depth(&self, n: DVec3) -> f64 {
        if self.is_triangle {
            return self.edges.iter().fold(self.corner.dot(n), |depth, edge| depth.min((self.corner + *edge).dot(n)));
        }
        self.edges.iter().fold(self.corner.dot(n), |depth, edge| depth + edge.dot(n).min(0.0))
    }

    fn is_hidden_by(&self, other: &Self, radius: f64, mesh_angle: f64) -> bool {
        let angle = if self.is_triangle && other.is_triangle { mesh_angle } else { SAME_NORMAL };
        let depth = if other.d < 0.0 { self.least_depth(other.n) } else { self.d * self.n.dot(other.n) };
        depth >= other.d - BEHIND * radius || self.n.dot(other.n) >= angle.cos()
    }
}

impl World {
    /// Removes the contacts with shapes that another shape hides.
    pub(crate) fn without_hidden(&self, found: Vec<(Pair, Line)>) -> Vec<(Pair, Line)> {
        if self.made(Mistake::Hidden) {
            return found;
        }
        let mut keeps = vec![true; found.len()];
        for ball in 0..self.balls.len() {
            let radius = self.balls[ball].radius;
            let mut candidates = self.candidates(ball, &found);
            candidates.sort_by(Candidate::before);
            let mut kept: Vec<Candidate> = Vec::new();
            for candidate in candidates {
                let of_body = |earlier: &&Candidate| self.are_one_body(candidate.thing, earlier.thing);
                if kept.iter().filter(of_body).any(|earlier| candidate.is_hidden_by(earlier, radius, self.mesh_angle)) {
                    keeps[candidate.place] = false;
                } else {
                    kept.push(candidate);
                }
            }
        }
        let seen = found.into_iter().zip(keeps).filter_map(|(contact, keep)| keep.then_some(contact));
        seen.filter(|(pair, line)| !self.is_seam(pair, line)).collect()
    }

    /// Whether a rod touches an edge or a vertex of a box where another box continues a face.
    fn is_seam(&self, pair: &Pair, line: &Line) -> bool {
        let (Thing::Bar(bar), Thing::Block(block)) = (pair.a, pair.b) else { return false };
        let (radius, [one, two]) = (self.bars[bar].radius, self.ends(bar));
        let x = one.lerp(two, line.at[0]) + (radius - line.o) * line.n;
        let outward: Vec<DVec3> = (0..3)
            .filter(|axis| !matches!(pair.feature, Feature::Edge(edge) if edge / 4 == *axis))
            .map(|axis| {
                let far = in_box(&self.blocks[block], x)[axis] >= 0.5;
                BESIDE * radius * self.blocks[block].edges[axis].normalize() * if far { 1.0 } else { -1.0 }
            })
            .collect();
        let mut points = vec![(x, false)];
        for step in outward {
            points = points.into_iter().flat_map(|(point, outside)| [(point + step, true), (point - step, outside)]).collect();
        }
        let contains =
            |other: usize, point: DVec3| in_box(&self.blocks[other], point).into_iter().all(|t| (0.0..=1.0).contains(&t));
        let joins = |other: &usize| *other != block && self.are_one_body(Thing::Block(block), Thing::Block(*other));
        let others = (0..self.blocks.len()).filter(joins).filter(|other| self.may_touch(pair.a, Thing::Block(*other)));
        others.into_iter().any(|other| points.iter().any(|(point, outside)| *outside && contains(other, *point)))
    }

    fn candidates(&self, ball: usize, found: &[(Pair, Line)]) -> Vec<Candidate> {
        let numbers = |vectors: &[DVec3]| vectors.iter().flat_map(DVec3::to_array).collect::<Vec<f64>>();
        let geometry = |thing: Thing| match thing {
            Thing::Block(block) => {
                let block = &self.blocks[block];
                let [i, j, k] = block.edges;
                Some((false, vec![block.corner, i, j, k]))
            }
            Thing::Face(face) => {
                let face = &self.faces[face];
                Some((true, vec![face.corner, face.left, face.right]))
            }
            Thing::Ball(_) | Thing::Bar(_) => None,
        };
        let own =
            found.iter().enumerate().filter(|(_, (pair, _))| pair.a == Thing::Ball(ball) && pair.feature == Feature::None);
        own.filter_map(|(place, (pair, line))| {
            let (is_face, vectors) = geometry(pair.b)?;
            Some(Candidate {
                thing: pair.b,
                place,
                d: self.balls[ball].radius - line.o,
                on_face: is_on_face(self, &self.balls[ball], pair.b),
                n: line.n,
                geometry: (is_face, numbers(&vectors)),
                corner: vectors[0] - self.balls[ball].x,
                edges: vectors[1..].to_vec(),
                is_triangle: matches!(pair.b, Thing::Face(face) if self.faces[face].is_triangle),
            })
        })
        .collect()
    }
}
