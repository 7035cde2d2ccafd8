//! All boxes and polygons as one surface: which contacts of a sphere are hidden (docs/physics.md section 2.11).

use std::cmp::Ordering;

use rockfall::glam::DVec3;

use crate::geometry::{Line, Pair, Thing};
use crate::world::{Mistake, World};

/// A shape is behind another one if its nearest point is at most this part of the radius in front of the other's tangent plane.
const BEHIND: f64 = 1e-5;
/// Normals that differ by at most this angle count as the same.
const SAME_NORMAL: f64 = 0.01;

/// A box or a polygon that a sphere overlaps.
struct Candidate {
    /// Place in the list of contacts.
    place: usize,
    /// Signed distance from the centre of the sphere.
    d: f64,
    n: DVec3,
    /// Whether it is a polygon, and the numbers of its corner and edges.
    geometry: (bool, Vec<f64>),
    /// Corner and edges, seen from the centre of the sphere.
    corner: DVec3,
    edges: Vec<DVec3>,
}

impl Candidate {
    fn before(&self, other: &Self) -> Ordering {
        let numbers = |one: &Self, two: &Self| one.geometry.partial_cmp(&two.geometry).expect("finite numbers");
        self.d.total_cmp(&other.d).then_with(|| numbers(self, other))
    }

    /// Depth behind the centre, along a direction, of the vertex that is least deep.
    fn least_depth(&self, n: DVec3) -> f64 {
        self.edges.iter().fold(self.corner.dot(n), |depth, edge| depth + edge.dot(n).min(0.0))
    }

    fn is_hidden_by(&self, other: &Self, radius: f64) -> bool {
        let depth = if other.d < 0.0 { self.least_depth(other.n) } else { self.d * self.n.dot(other.n) };
        depth >= other.d - BEHIND * radius || self.n.dot(other.n) >= SAME_NORMAL.cos()
    }
}

impl World {
    /// Removes the contacts of spheres with shapes that another shape hides.
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
                if kept.iter().any(|earlier| candidate.is_hidden_by(earlier, radius)) {
                    keeps[candidate.place] = false;
                } else {
                    kept.push(candidate);
                }
            }
        }
        found.into_iter().zip(keeps).filter_map(|(contact, keep)| keep.then_some(contact)).collect()
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
        let own = found.iter().enumerate().filter(|(_, (pair, _))| pair.a == Thing::Ball(ball));
        own.filter_map(|(place, (pair, line))| {
            let (is_face, vectors) = geometry(pair.b)?;
            Some(Candidate {
                place,
                d: self.balls[ball].radius - line.o,
                n: line.n,
                geometry: (is_face, numbers(&vectors)),
                corner: vectors[0] - self.balls[ball].x,
                edges: vectors[1..].to_vec(),
            })
        })
        .collect()
    }
}
