//! Boxes and polygons as one surface, in f64: which contacts of a sphere another shape hides (docs/physics section 2.11).

use std::cmp::Ordering;

use glam::DVec3;

use crate::bodies::{Bodies, Kind, Round};
use crate::decisions::{Contact, Findings, LIMIT};
use crate::narrow::{is_on_face, is_vertex};

/// A shape is behind a plane from this part of the radius in front of it.
const BEHIND: f64 = 1e-5;
/// Cosine of the angle up to which normals count as the same: 0.01.
const SAME: f64 = 0.999_950_000_416_665;
/// Least slack of the two conditions. Flush shapes have a slack of 1e-5 in the first one and of 5e-5 in the second one, so that both
/// limits are below that of other decisions.
const BEHIND_LIMIT: f64 = 4e-6;
const SAME_LIMIT: f64 = 1e-6;
/// Distance from an edge, as a part of the radius of a rod, at which another box is looked for.
const BESIDE: f64 = 1e-3;
/// Least distance, in units, of these points from the surface of the other box.
const SEAM_LIMIT: f64 = 1e-6;

/// A box or a polygon that a sphere overlaps.
struct Shape {
    /// Place in the list of contacts.
    place: usize,
    /// Signed distance from the centre of the sphere.
    d: f64,
    n: DVec3,
    is_polygon: bool,
    is_triangle: bool,
    round: Option<Round>,
    on_face: bool,
    numbers: Vec<f64>,
    /// Centre of the sphere.
    x: DVec3,
}

impl Shape {
    fn of(bodies: &Bodies, place: usize, contact: &Contact) -> Option<(usize, Self)> {
        let Kind::Ball(ball) = bodies.kind(contact.a) else { return None };
        let (mut is_triangle, mut round) = (false, None);
        let (is_polygon, vectors) = match bodies.kind(contact.b) {
            Kind::Block(block) => {
                let block = &bodies.blocks[block];
                (false, [&[block.corner][..], &block.edges].concat())
            }
            Kind::Face(face) => {
                let face = &bodies.faces[face];
                is_triangle = face.is_triangle();
                round = face.round();
                (true, vec![face.corner, face.left, face.right])
            }
            Kind::Ball(_) | Kind::Bar(_) => return None,
        };
        let d = bodies.balls[ball].radius - contact.touch.overlap;
        let numbers = vectors.into_iter().flat_map(|vector| vector.to_array()).collect();
        Some((
            ball,
            Self {
                place,
                d,
                n: contact.touch.n,
                is_polygon,
                is_triangle,
                round,
                on_face: is_on_face(&contact.touch),
                numbers,
                x: bodies.balls[ball].x,
            },
        ))
    }

    /// Whether equal distances from two shapes are equal numbers on every backend: the shapes are boxes along the axes whose
    /// touched faces have the same coordinate, and it follows from the same numbers. Of a face that the corner is on, it follows
    /// from the corner alone if the centre is outside.
    fn ties(&self, other: &Self) -> bool {
        let Some(axis) = (0..3).find(|axis| self.d == other.d && self.n[*axis].abs() > 1.0 - 1e-9) else { return false };
        let is_level = |shape: &Self| {
            let edges: Vec<&[f64]> = shape.numbers[3..].chunks(3).collect();
            !shape.is_polygon && edges.iter().all(|edge| edge.iter().filter(|number| **number != 0.0).count() == 1)
        };
        let along = |shape: &Self| {
            let edges = shape.numbers[3..].chunks(3);
            edges.map(|edge| edge[axis]).find(|number| *number != 0.0)
        };
        let is_outward = |shape: &Self| shape.d > 0.0 && along(shape).is_some_and(|edge| edge * shape.n[axis] > 0.0);
        is_level(self)
            && is_level(other)
            && self.n.dot(other.n) > 0.0
            && self.numbers[axis] == other.numbers[axis]
            && (along(self) == along(other) || is_outward(self) && is_outward(other))
    }

    fn order(&self, other: &Self) -> Ordering {
        let by_numbers = || self.numbers.partial_cmp(&other.numbers).expect("finite numbers");
        self.key().total_cmp(&other.key()).then(self.is_polygon.cmp(&other.is_polygon)).then_with(by_numbers)
    }

    /// The number by which shapes are ordered: an edge comes later than a face.
    fn key(&self) -> f64 {
        if self.on_face || self.d < 0.0 { self.d } else { self.d * (1.0 + 2e-6) }
    }

    /// The least of (q - x) n over the vertices q.
    fn depth_of_foremost(&self, n: DVec3) -> f64 {
        let vectors: Vec<DVec3> = self.numbers.chunks(3).map(DVec3::from_slice).collect();
        let corner = (vectors[0] - self.x).dot(n);
        if let Some(Round { axis, radii, .. }) = self.round {
            // The foremost points of the rims, or of the ball.
            let across = axis.map_or(n, |axis| n.reject_from(axis));
            let ends = [DVec3::ZERO, axis.unwrap_or_default()].into_iter().zip(radii);
            return ends.map(|(end, radius)| corner + end.dot(n) - radius * across.length()).fold(f64::INFINITY, f64::min);
        }
        let along = vectors[1..].iter().map(|edge| edge.dot(n).min(0.0));
        corner + if self.is_triangle { along.fold(0.0, f64::min) } else { along.sum() }
    }

    /// Whether an earlier shape hides this one with the default angle of a mesh, as a condition whose limit is [`LIMIT`].
    fn hidden_by(&self, earlier: &Self, radius: f64) -> f64 {
        let depth = if earlier.d < 0.0 { self.depth_of_foremost(earlier.n) } else { self.d * self.n.dot(earlier.n) };
        let behind = (depth - earlier.d) / radius + BEHIND;
        let same =
            self.n.dot(earlier.n) - if self.is_triangle && earlier.is_triangle { 10.0_f64.to_radians().cos() } else { SAME };
        (LIMIT / BEHIND_LIMIT * behind).max(LIMIT / SAME_LIMIT * same)
    }
}

/// Removes the contacts of spheres with shapes that another shape hides.
pub(crate) fn without_hidden(bodies: &Bodies, contacts: Vec<Contact>, findings: &mut Findings) -> Vec<Contact> {
    let mut of_balls: Vec<Vec<Shape>> = bodies.balls.iter().map(|_| Vec::new()).collect();
    for (ball, shape) in contacts.iter().enumerate().filter_map(|(place, contact)| Shape::of(bodies, place, contact)) {
        of_balls[ball].push(shape);
    }
    let mut is_hidden = vec![false; contacts.len()];
    for (ball, shapes) in of_balls.into_iter().enumerate() {
        for place in hidden(ball, bodies.balls[ball].radius, shapes, findings) {
            is_hidden[place] = true;
            findings.count(format!("{} hidden", contacts[place].touch.kind));
        }
    }
    let mut is_seam = |contact: &Contact| {
        let condition = seam(bodies, contact);
        findings.decide("seam", contact.a, LIMIT / SEAM_LIMIT * condition);
        if condition > 0.0 {
            findings.count(format!("{} at a seam", contact.touch.kind));
        }
        condition > 0.0
    };
    let seen = contacts.into_iter().zip(is_hidden).filter_map(|(contact, is_hidden)| (!is_hidden).then_some(contact));
    seen.filter(|contact| !is_seam(contact)).collect()
}

/// Whether another box continues a face at the edge or vertex of a box that a rod touches, as a condition in units.
fn seam(bodies: &Bodies, contact: &Contact) -> f64 {
    let (Kind::Bar(bar), Kind::Block(block)) = (bodies.kind(contact.a), bodies.kind(contact.b)) else {
        return f64::NEG_INFINITY;
    };
    let (radius, touch, block) = (bodies.bars[bar].radius, &contact.touch, &bodies.blocks[block]);
    let [one, two] = bodies.segment(bar);
    let place = one.lerp(two, touch.a) + (radius - touch.overlap) * touch.n;
    let free = if is_vertex(touch) { 3 } else { touch.feature / 4 };
    let mut strongest = f64::NEG_INFINITY;
    for signs in 0..27 {
        let digits = [signs % 3, signs / 3 % 3, signs / 9].map(|digit| f64::from(digit) - 1.0);
        let across = (0..3).filter(|axis| *axis != free);
        if (0..3).any(|axis| (digits[axis] == 0.0) != (axis == free)) || across.clone().all(|axis| digits[axis] < 0.0) {
            continue;
        }
        let middle = block.corner + block.edges.iter().sum::<DVec3>() / 2.0;
        let step = |axis: usize| {
            let outward = block.edges[axis].normalize();
            digits[axis] * outward * (place - middle).dot(outward).signum()
        };
        let point = place + BESIDE * radius * across.map(step).sum::<DVec3>();
        for (other, id) in bodies.blocks.iter().zip(bodies.movers()..) {
            if id != contact.b && bodies.may_touch(contact.a, id) {
                let depth = |edge: &DVec3| {
                    let along = (point - other.corner).dot(edge.normalize());
                    along.min(edge.length() - along)
                };
                strongest = strongest.max(other.edges.iter().map(depth).fold(f64::INFINITY, f64::min));
            }
        }
    }
    strongest
}

/// Returns the places of the hidden shapes of a sphere.
fn hidden(ball: usize, radius: f64, mut shapes: Vec<Shape>, findings: &mut Findings) -> Vec<usize> {
    shapes.sort_by(Shape::order);
    let (mut kept, mut hidden): (Vec<Shape>, Vec<usize>) = (Vec::new(), Vec::new());
    for shape in shapes {
        let mut strongest = f64::NEG_INFINITY;
        for earlier in &kept {
            let hides = shape.hidden_by(earlier, radius);
            // The order of two shapes matters if the later one would hide the earlier one if it came first.
            let matters = hides.max(earlier.hidden_by(&shape, radius)) > -LIMIT;
            if matters && shape.ties(earlier) {
                findings.count("equal distances".to_owned());
            } else if matters {
                findings.decide("the order of shapes", ball, shape.key() - earlier.key());
            }
            strongest = strongest.max(hides);
        }
        if !kept.is_empty() {
            findings.decide("hidden", ball, strongest);
        }
        if strongest >= 0.0 {
            hidden.push(shape.place);
        } else {
            kept.push(shape);
        }
    }
    if kept.len() > 1 {
        findings.count("several surfaces".to_owned());
    }
    hidden
}
