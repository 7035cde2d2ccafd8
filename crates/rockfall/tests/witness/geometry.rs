//! Closest points and signed overlaps (docs/physics section 2).

use rockfall::glam::DVec3;

use crate::world::{Ball, Bar, Block, Face, World};

/// A distance shorter than this fraction of its operands has no direction,
const ROUNDED: f64 = 5e-7;
/// unless it is longer than this fraction of the distance at which the two objects begin to touch.
const SMALL: f64 = 0.01;
/// A parameter beyond an end by at most this much belongs to the end.
const AT_END: f64 = 1e-6;
/// Squared sine of the angle below which two lines count as parallel.
pub(crate) const PARALLEL: f64 = 1e-8;

/// An object on one side of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Thing {
    Ball(usize),
    Bar(usize),
    Block(usize),
    Face(usize),
}

/// Feature of a box or polygon that a rod touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    None,
    Edge(usize),
    Vertex(usize),
}

/// Two objects that may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pair {
    pub(crate) a: Thing,
    pub(crate) b: Thing,
    pub(crate) feature: Feature,
}

/// A contact line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Unit normal from A to B.
    pub(crate) n: DVec3,
    /// Overlap; negative where the two are apart.
    pub(crate) o: f64,
    /// Parameters on A and on B, for rods.
    pub(crate) at: [f64; 2],
}

impl Line {
    pub(crate) fn new(n: DVec3, o: f64, at: [f64; 2]) -> Self {
        Self { n, o, at }
    }
}

pub(crate) fn on_segment(parameter: f64) -> bool {
    (-AT_END..=1.0 + AT_END).contains(&parameter)
}

/// Returns a distance vector, or 0 where it is only the rounding error of vectors whose squared lengths sum to
/// `squared`.
pub(crate) fn without_rounding(d: DVec3, squared: f64, reach: f64) -> DVec3 {
    let least = (ROUNDED * ROUNDED * squared).min((SMALL * reach).powi(2));
    if d.length_squared() <= least { DVec3::ZERO } else { d }
}

/// Parameter of the foot of a point on a segment, and the vector from the point to the foot. `None` beyond the ends.
fn point_segment(point: DVec3, from: DVec3, to: DVec3, reach: f64) -> Option<(f64, DVec3)> {
    let (axis, c) = (to - from, point - from);
    let squared = axis.length_squared();
    let a = axis.dot(c) / squared;
    (squared > 0.0 && on_segment(a)).then(|| (a, without_rounding(a * axis - c, squared + c.length_squared(), reach)))
}

/// Closest points of two segments.
pub(crate) struct Closest {
    pub(crate) a: f64,
    pub(crate) b: f64,
    pub(crate) d: DVec3,
    /// Common normal of segments that are not parallel.
    pub(crate) common: Option<DVec3>,
}

pub(crate) fn segment_segment(a: [DVec3; 2], b: [DVec3; 2], reach: f64) -> Option<Closest> {
    let (along_a, along_b, c) = (a[1] - a[0], b[1] - b[0], b[0] - a[0]);
    let (aa, bb) = (along_a.length_squared(), along_b.length_squared());
    if aa == 0.0 || bb == 0.0 {
        return None;
    }
    let n = along_a.cross(along_b);
    let squared = aa + bb + c.length_squared();
    if n.length_squared() <= PARALLEL * aa * bb {
        let ends = [c, c + along_b].map(|end| end.dot(along_a) / aa);
        let (low, high) = (ends[0].min(ends[1]).max(0.0), ends[0].max(ends[1]).min(1.0));
        if low > high {
            return None;
        }
        let at = 0.5 * (low + high);
        let other = (at * along_a - c).dot(along_b) / bb;
        let d = c + other * along_b - at * along_a;
        let d = d - d.dot(along_a) / aa * along_a;
        return Some(Closest { a: at, b: other, d: without_rounding(d, squared, reach), common: None });
    }
    let at = c.dot(along_b.cross(n)) / n.length_squared();
    let other = c.dot(along_a.cross(n)) / n.length_squared();
    let d = without_rounding(c + other * along_b - at * along_a, squared, reach);
    (on_segment(at) && on_segment(other)).then(|| Closest { a: at, b: other, d, common: Some(n.normalize()) })
}

/// Contact of two round objects with the distance vector `d`.
fn round(d: DVec3, reach: f64, default_n: DVec3, at: [f64; 2]) -> Line {
    Line::new(if d == DVec3::ZERO { default_n } else { d.normalize() }, reach - d.length(), at)
}

fn sphere_sphere(one: &Ball, two: &Ball) -> Line {
    let reach = one.radius + two.radius;
    let squared = one.x.length_squared() + two.x.length_squared();
    round(without_rounding(two.x - one.x, squared, reach), reach, DVec3::Y, [0.0; 2])
}

fn sphere_rod(ball: &Ball, bar: &Bar, ends: [DVec3; 2]) -> Option<Line> {
    let reach = ball.radius + bar.radius;
    let (a, d) = point_segment(ball.x, ends[0], ends[1], reach)?;
    Some(round(d, reach, DVec3::Y, [0.0, a]))
}

fn rod_rod(one: &Bar, a: [DVec3; 2], two: &Bar, b: [DVec3; 2]) -> Option<Line> {
    let reach = one.radius + two.radius;
    let closest = segment_segment(a, b, reach)?;
    Some(round(closest.d, reach, closest.common.unwrap_or(DVec3::Y), [closest.a, closest.b]))
}

/// Parameters of a point along the edges of a box.
pub(crate) fn in_box(block: &Block, point: DVec3) -> [f64; 3] {
    block.edges.map(|edge| (point - block.corner).dot(edge) / edge.length_squared())
}

pub(crate) fn sphere_box(ball: &Ball, block: &Block) -> Line {
    let t = in_box(block, ball.x);
    let closest: DVec3 = block.corner + (0..3).map(|k| t[k].clamp(0.0, 1.0) * block.edges[k]).sum::<DVec3>();
    let squared = (ball.x - block.corner).length_squared() + block.edges.iter().map(|e| e.length_squared()).sum::<f64>();
    let d = without_rounding(closest - ball.x, squared, ball.radius);
    // Inside by the parameters of the centre: the distance of a centre inside the box is only a rounding error of the
    // edges.
    let inside = t.into_iter().all(|t| (0.0..=1.0).contains(&t));
    if d != DVec3::ZERO && !inside {
        return Line::new(d.normalize(), ball.radius - d.length(), [0.0; 2]);
    }
    let mut way = (f64::INFINITY, DVec3::Y);
    for (t, edge) in t.into_iter().zip(block.edges) {
        for (depth, inward) in [(t * edge.length(), edge), ((1.0 - t) * edge.length(), -edge)] {
            if depth < way.0 {
                way = (depth, inward.normalize());
            }
        }
    }
    Line::new(way.1, ball.radius + way.0, [0.0; 2])
}

/// Parameters of a point in the plane of a polygon, along L and R, and the unit normal.
pub(crate) fn place_over(point: DVec3, face: &Face) -> ([f64; 2], DVec3) {
    let n = face.left.cross(face.right);
    let p = point - face.corner;
    let l = p.cross(face.right).dot(n) / n.length_squared();
    let k = face.left.cross(p).dot(n) / n.length_squared();
    ([l, k], n.normalize())
}

/// Whether the point of a box or polygon that is nearest to a sphere's centre is on a face.
pub(crate) fn is_on_face(world: &World, ball: &Ball, thing: Thing) -> bool {
    match thing {
        Thing::Block(block) => {
            in_box(&world.blocks[block], ball.x).into_iter().filter(|t| !(0.0..=1.0).contains(t)).count() == 1
        }
        Thing::Face(face) => {
            let face = &world.faces[face];
            let ([l, k], _) = place_over(ball.x, face);
            on_segment(l) && on_segment(k) && (!face.is_triangle || on_segment(l + k))
        }
        Thing::Ball(_) | Thing::Bar(_) => false,
    }
}

/// Contact with the nearest point of a polygon. There is none behind the plane of a parallelogram.
pub(crate) fn sphere_face(ball: &Ball, face: &Face) -> Option<Line> {
    let (place, mut up) = place_over(ball.x, face);
    let mut height = (ball.x - face.corner).dot(up);
    if height < 0.0 {
        if !face.is_triangle {
            return None;
        }
        (up, height) = (-up, -height);
    }
    let on_triangle = !face.is_triangle || on_segment(place[0] + place[1]);
    if place.into_iter().all(on_segment) && on_triangle {
        return Some(Line::new(-up, ball.radius - height, [0.0; 2]));
    }
    let beyond = |at: f64, side: DVec3| face.corner + if at > 1.0 { side } else { DVec3::ZERO };
    let edges = if face.is_triangle {
        let third = (face.corner + face.left, face.right - face.left);
        vec![(face.corner, face.left), (face.corner, face.right), third]
    } else {
        let two = [(place[0], face.left, face.right), (place[1], face.right, face.left)];
        two.into_iter().filter(|(at, ..)| !on_segment(*at)).map(|(at, side, edge)| (beyond(at, side), edge)).collect()
    };
    let mut nearest: Option<DVec3> = None;
    for (start, edge) in edges {
        let along = (ball.x - start).dot(edge) / edge.length_squared();
        let mut d = start + along.clamp(0.0, 1.0) * edge - ball.x;
        if (0.0..=1.0).contains(&along) {
            d -= d.dot(edge) / edge.length_squared() * edge;
        }
        if nearest.is_none_or(|known| d.length() < known.length()) {
            nearest = Some(d);
        }
    }
    let d = without_rounding(nearest?, face.left.length_squared().max(face.right.length_squared()), ball.radius);
    let n = if d == DVec3::ZERO { -up } else { d.normalize() };
    Some(Line::new(n, ball.radius - d.length(), [0.0; 2]))
}

/// Ends of an edge of a box, and the outward direction there. There are four edges along each of I, J and K.
fn edge_of(block: &Block, edge: usize) -> ([DVec3; 2], DVec3) {
    let (along, side) = (edge / 4, edge % 4);
    let (one, two) = ((along + 1) % 3, (along + 2) % 3);
    let (p, q) = ((side & 1) as f64, (side >> 1) as f64);
    let from = block.corner + p * block.edges[one] + q * block.edges[two];
    let out = (2.0 * p - 1.0) * block.edges[one].normalize() + (2.0 * q - 1.0) * block.edges[two].normalize();
    ([from, from + block.edges[along]], out.normalize())
}

pub(crate) fn vertex_of(block: &Block, vertex: usize) -> (DVec3, DVec3) {
    let bits = [0, 1, 2].map(|k| ((vertex >> k) & 1) as f64);
    let place = block.corner + (0..3).map(|k| bits[k] * block.edges[k]).sum::<DVec3>();
    let out: DVec3 = (0..3).map(|k| (2.0 * bits[k] - 1.0) * block.edges[k].normalize()).sum();
    (place, out.normalize())
}

/// Contact of a rod with an edge or a vertex of a box, and the distance of the rod's axis from it.
fn rod_box(bar: &Bar, ends: [DVec3; 2], block: &Block, feature: Feature, slack: f64) -> Option<(Line, f64)> {
    let (a, d, out) = match feature {
        Feature::Edge(edge) => {
            let (edge, out) = edge_of(block, edge);
            let closest = segment_segment(ends, edge, bar.radius)?;
            (closest.a, closest.d, out)
        }
        Feature::Vertex(vertex) => {
            let (place, out) = vertex_of(block, vertex);
            let (a, d) = point_segment(place, ends[0], ends[1], bar.radius)?;
            (a, -d, out)
        }
        Feature::None => return None,
    };
    let axis_point = ends[0].lerp(ends[1], a);
    let inside = in_box(block, axis_point).into_iter().all(|t| (-slack..=1.0 + slack).contains(&t));
    let (r, far) = (bar.radius, d.length());
    let (n, o) = match (d == DVec3::ZERO, inside) {
        (true, _) => (-out, r),
        (false, true) => (-d.normalize(), r + far),
        (false, false) => (d.normalize(), r - far),
    };
    Some((Line::new(n, o, [a, 0.0]), far))
}

impl World {
    pub(crate) fn ends(&self, bar: usize) -> [DVec3; 2] {
        self.bars[bar].ends.map(|end| self.balls[end].x)
    }

    /// Contact line of a pair, whether or not it overlaps. `None` beyond the ends of rods (docs/physics section
    /// 2.10).
    pub(crate) fn line(&self, pair: &Pair) -> Option<Line> {
        match (pair.a, pair.b) {
            (Thing::Ball(a), Thing::Ball(b)) => Some(sphere_sphere(&self.balls[a], &self.balls[b])),
            (Thing::Ball(a), Thing::Bar(b)) => sphere_rod(&self.balls[a], &self.bars[b], self.ends(b)),
            (Thing::Ball(a), Thing::Block(b)) => Some(sphere_box(&self.balls[a], &self.blocks[b])),
            (Thing::Ball(a), Thing::Face(b)) => sphere_face(&self.balls[a], &self.faces[b]),
            (Thing::Bar(a), Thing::Bar(b)) => rod_rod(&self.bars[a], self.ends(a), &self.bars[b], self.ends(b)),
            (Thing::Bar(a), Thing::Block(b)) => {
                rod_box(&self.bars[a], self.ends(a), &self.blocks[b], pair.feature, self.slack).map(|found| found.0)
            }
            (Thing::Bar(a), Thing::Face(b)) => match pair.feature {
                Feature::Edge(edge) => self.rimmed(a, b, edge).map(|found| found.line),
                _ => None,
            },
            _ => None,
        }
    }

    /// The ball of a contact with a face, over which its centre is. Such a contact keeps the plane of the face when it is moved back
    /// (docs/physics section 2.10).
    pub(crate) fn on_face(&self, pair: &Pair) -> Option<usize> {
        let Thing::Ball(ball) = pair.a else { return None };
        is_on_face(self, &self.balls[ball], pair.b).then_some(ball)
    }

    /// Contact line of a pair after a collision. For a rod that has moved away from a box it is that of the edge or the
    /// vertex with this number, whichever is nearer (docs/physics section 2.10).
    pub(crate) fn nearer_line(&self, pair: &Pair) -> Option<Line> {
        let has_both = |pair: &Pair| matches!((pair.a, pair.b), (Thing::Bar(_), Thing::Block(_)));
        let number = match pair.feature {
            Feature::Edge(number) | Feature::Vertex(number) if number < 8 && has_both(pair) => number,
            _ => return self.line(pair),
        };
        let of = |feature| self.line(&Pair { feature, ..*pair });
        match (of(Feature::Edge(number)), of(Feature::Vertex(number))) {
            (Some(edge), Some(vertex)) if edge.o > 0.0 || edge.o > vertex.o => Some(edge),
            (Some(edge), None) => Some(edge),
            (_, vertex) => vertex,
        }
    }

    /// All pairs that overlap in the present state, without those that other shapes hide.
    pub(crate) fn touches(&self) -> Vec<(Pair, Line)> {
        let things = self.things();
        let mut found = Vec::new();
        for (place, &a) in things.iter().enumerate() {
            for &b in &things[place + 1..] {
                if self.may_touch(a, b) {
                    self.touch(a, b, &mut found);
                }
            }
        }
        self.without_hidden(found)
    }

    fn things(&self) -> Vec<Thing> {
        let balls = (0..self.balls.len()).map(Thing::Ball);
        let bars = (0..self.bars.len()).map(Thing::Bar);
        let blocks = (0..self.blocks.len()).map(Thing::Block);
        let faces = (0..self.faces.len()).map(Thing::Face);
        balls.chain(bars).chain(blocks).chain(faces).collect()
    }

    /// Radius of a sphere or rod.
    pub(crate) fn radius(&self, thing: Thing) -> Option<f64> {
        match thing {
            Thing::Ball(ball) => Some(self.balls[ball].radius),
            Thing::Bar(bar) => Some(self.bars[bar].radius),
            Thing::Block(_) | Thing::Face(_) => None,
        }
    }

    fn group(&self, thing: Thing) -> u16 {
        match thing {
            Thing::Ball(ball) => self.balls[ball].group,
            Thing::Bar(bar) => self.bars[bar].group,
            Thing::Block(block) => self.blocks[block].group,
            Thing::Face(face) => self.faces[face].group,
        }
    }

    fn can_move(&self, thing: Thing) -> bool {
        match thing {
            Thing::Ball(ball) => !self.balls[ball].fixed,
            Thing::Bar(bar) => self.bars[bar].ends.into_iter().any(|end| !self.balls[end].fixed),
            Thing::Block(_) | Thing::Face(_) => false,
        }
    }

    /// Whether two objects may touch: they are in one group, and at least one can move.
    pub(crate) fn may_touch(&self, a: Thing, b: Thing) -> bool {
        let related = match (a, b) {
            (Thing::Ball(a), Thing::Ball(b)) => {
                self.bars.iter().any(|bar| bar.length.is_some() && (bar.ends == [a, b] || bar.ends == [b, a]))
            }
            (Thing::Ball(a), Thing::Bar(b)) => self.bars[b].ends.contains(&a),
            (Thing::Bar(a), Thing::Bar(b)) => self.bars[a].ends.iter().any(|end| self.bars[b].ends.contains(end)),
            _ => false,
        };
        !related && self.group(a) == self.group(b) && (self.can_move(a) || self.can_move(b))
    }

    fn touch(&self, a: Thing, b: Thing, found: &mut Vec<(Pair, Line)>) {
        let plain = Pair { a, b, feature: Feature::None };
        match (a, b) {
            (Thing::Bar(bar), Thing::Block(block)) => {
                let (rod, ends) = (&self.bars[bar], self.ends(bar));
                let hit = |feature: Feature| {
                    let (line, far) = rod_box(rod, ends, &self.blocks[block], feature, self.slack)?;
                    (far < rod.radius).then_some((Pair { feature, ..plain }, line))
                };
                let before = found.len();
                found.extend((0..12).filter_map(|edge| hit(Feature::Edge(edge))));
                if found.len() == before {
                    found.extend((0..8).filter_map(|vertex| hit(Feature::Vertex(vertex))));
                }
            }
            (Thing::Bar(bar), Thing::Face(face)) => {
                let all = self.rims(bar, face).into_iter();
                found.extend(all.map(|(edge, line)| (Pair { feature: Feature::Edge(edge), ..plain }, line)));
            }
            _ => {
                let line = self.line(&plain).filter(|line| line.o > 0.0 && !self.is_covered(&plain, line));
                found.extend(line.map(|line| (plain, line)));
            }
        }
    }
}
