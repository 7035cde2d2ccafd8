//! The narrow phase in f64, from docs/physics section 2, with the slack of every decision.
//!
//! A condition is a number that is positive when the condition holds. The minimum of several conditions is their `and`, and the
//! maximum their `or`. The absolute value is the slack: the distance from the value at which the decision changes.

use glam::DVec3;

use crate::bodies::{Block, Bodies, Kind, Round};

/// An overlap of two objects, or the geometry of two objects that may overlap.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub(crate) kind: &'static str,
    pub(crate) feature: usize,
    /// Unit normal from A to B.
    pub(crate) n: DVec3,
    pub(crate) overlap: f64,
    /// Parameters on A and B, if they are rods.
    pub(crate) a: f64,
    pub(crate) b: f64,
    /// Whether the objects overlap, as a condition.
    pub(crate) holds: f64,
    /// Whether there is a contact line, as a condition. The objects may be apart (docs/physics section 2.10).
    pub(crate) line: f64,
    /// Slack of the decisions on which the normal and the overlap depend.
    pub(crate) sure: f64,
}

impl Touch {
    fn new(kind: &'static str, n: DVec3, overlap: f64, holds: f64) -> Self {
        Self { kind, feature: 0, n, overlap, a: 0.0, b: 0.0, holds, line: f64::INFINITY, sure: f64::INFINITY }
    }
}

/// The condition 0 <= t <= 1.
fn inside(t: f64) -> f64 {
    t.min(1.0 - t)
}

/// Returns the slack of the decision whether two segments are parallel, from the sine of their angle. They are parallel up to
/// 1e-4. Angles of up to 0.02 are badly conditioned and count as ambiguous, too.
fn parallel_slack(sine: f64) -> f64 {
    if (1e-5..=0.02).contains(&sine) { 0.0 } else { 1.0 }
}

struct Closest {
    a: f64,
    b: f64,
    d: DVec3,
    holds: f64,
    parallel: bool,
    sure: f64,
}

fn segments([a1, a2]: [DVec3; 2], [b1, b2]: [DVec3; 2]) -> Closest {
    let (u, v, c) = (a2 - a1, b2 - b1, b1 - a1);
    let n = u.cross(v);
    let sine = n.length() / (u.length() * v.length());
    let parallel = sine <= 1e-4;
    let (a, b, holds) = if parallel {
        let [t0, t1] = [b1, b2].map(|end| (end - a1).dot(u) / u.length_squared());
        let (low, high) = (t0.min(t1).max(0.0), t0.max(t1).min(1.0));
        let a = 0.5 * (low + high);
        let b = (a1 + a * u - b1).dot(v) / v.length_squared();
        (a, b.clamp(0.0, 1.0), high - low)
    } else {
        // The points of closest approach of the two lines, from the two equations D.u = 0 and D.v = 0.
        let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
        let det = uu * vv - uv * uv;
        let (cu, cv) = (c.dot(u), c.dot(v));
        let (a, b) = ((cu * vv - cv * uv) / det, (cu * uv - cv * uu) / det);
        (a, b, inside(a).min(inside(b)))
    };
    let d = c + b * v - a * u;
    Closest { a, b, d, holds, parallel, sure: parallel_slack(sine) }
}

/// Returns the signed geometry of the pair of `found`, in the state of `bodies` (docs/physics section 2.10). For a rod and a
/// box it refers to the same edge or vertex as `found`.
pub(crate) fn signed(bodies: &Bodies, a: usize, b: usize, found: &Touch) -> Touch {
    let mut all = touches(bodies, a, b);
    match (bodies.kind(a), bodies.kind(b)) {
        (Kind::Bar(_), Kind::Block(_)) => all.swap_remove(found.feature + if is_vertex(found) { EDGES } else { 0 }),
        _ => all.swap_remove(0),
    }
}

/// The kind of a touch of a ball and the face of a polygon.
const FACE: &str = "sphere-polygon face";

/// Number of edges of a box. In the list of touches of a rod and a box, the edges come before the vertices.
pub(crate) const EDGES: usize = 12;

/// Whether a touch is that of a rod and a vertex of a box.
pub(crate) fn is_vertex(touch: &Touch) -> bool {
    touch.kind.starts_with("rod-box vertex")
}

/// Returns all touches of the objects `a < b`, whether or not the objects overlap there.
pub(crate) fn touches(bodies: &Bodies, a: usize, b: usize) -> Vec<Touch> {
    if !bodies.may_touch(a, b) {
        return Vec::new();
    }
    match (bodies.kind(a), bodies.kind(b)) {
        (Kind::Ball(a), Kind::Ball(b)) => vec![sphere_sphere(bodies, a, b)],
        (Kind::Ball(a), Kind::Bar(b)) => vec![sphere_rod(bodies, a, b)],
        (Kind::Bar(a), Kind::Bar(b)) => vec![rod_rod(bodies, a, b)],
        (Kind::Ball(a), Kind::Block(b)) => vec![sphere_box(bodies, a, &bodies.blocks[b])],
        (Kind::Ball(a), Kind::Face(b)) => vec![sphere_polygon(bodies, a, b)],
        (Kind::Bar(a), Kind::Block(b)) => rod_box(bodies, a, &bodies.blocks[b]),
        _ => Vec::new(),
    }
}

fn sphere_sphere(bodies: &Bodies, a: usize, b: usize) -> Touch {
    let (a, b) = (&bodies.balls[a], &bodies.balls[b]);
    let d = b.x - a.x;
    let overlap = a.radius + b.radius - d.length();
    Touch::new("sphere-sphere", d.normalize(), overlap, overlap)
}

fn sphere_rod(bodies: &Bodies, ball: usize, bar: usize) -> Touch {
    let (end1, end2) = (bodies.segment(bar)[0], bodies.segment(bar)[1]);
    let (ball, bar) = (&bodies.balls[ball], &bodies.bars[bar]);
    let axis = end2 - end1;
    let b = axis.dot(ball.x - end1) / axis.length_squared();
    let d = end1 + b * axis - ball.x;
    let overlap = ball.radius + bar.radius - d.length();
    let touch = Touch::new("sphere-rod", d.normalize(), overlap, overlap.min(inside(b)));
    Touch { b, line: inside(b), ..touch }
}

fn rod_rod(bodies: &Bodies, a: usize, b: usize) -> Touch {
    let closest = segments(bodies.segment(a), bodies.segment(b));
    let overlap = bodies.bars[a].radius + bodies.bars[b].radius - closest.d.length();
    let touch = Touch::new(
        if closest.parallel { "rod-rod parallel" } else { "rod-rod" },
        closest.d.normalize(),
        overlap,
        overlap.min(closest.holds),
    );
    Touch { a: closest.a, b: closest.b, line: closest.holds, sure: closest.sure, ..touch }
}

/// Returns the parameters of a point along the edges of a box.
fn parameters(block: &Block, p: DVec3) -> [f64; 3] {
    block.edges.map(|edge| (p - block.corner).dot(edge) / edge.length_squared())
}

fn sphere_box(bodies: &Bodies, ball: usize, block: &Block) -> Touch {
    let ball = &bodies.balls[ball];
    let t = parameters(block, ball.x);
    let within = t.map(inside).into_iter().fold(f64::INFINITY, f64::min);
    if within < 0.0 {
        let nearest: DVec3 = (0..3).map(|k| t[k].clamp(0.0, 1.0) * block.edges[k]).sum();
        let d = block.corner + nearest - ball.x;
        let overlap = ball.radius - d.length();
        let outside = t.iter().filter(|t| inside(**t) < 0.0).count();
        let kind = ["", "sphere-box face", "sphere-box edge", "sphere-box vertex"][outside];
        let touch = Touch::new(kind, d.normalize(), overlap, overlap);
        return Touch { sure: -within, ..touch };
    }
    let mut depths: Vec<(f64, DVec3)> = Vec::new();
    for (t, edge) in t.into_iter().zip(block.edges) {
        depths.push((t * edge.length(), -edge.normalize()));
        depths.push(((1.0 - t) * edge.length(), edge.normalize()));
    }
    depths.sort_by(|one, other| one.0.total_cmp(&other.0));
    let (depth, exit) = depths[0];
    let touch = Touch::new("sphere-box inside", -exit, ball.radius + depth, ball.radius + depth);
    Touch { sure: within.min(depths[1].0 - depth), ..touch }
}

/// A cone is the segment of its nearest half-plane, which is turned about the axis.
fn sphere_round(radius: f64, round: &Round, t: DVec3) -> Touch {
    let Some(axis) = round.axis else {
        let height = round.side * (t.length() - round.radii[0]);
        let touch = Touch::new("sphere-ball wall", -round.side * t.normalize(), radius - height, (radius - height).min(height));
        return Touch { line: height, ..touch };
    };
    let along = axis.normalize();
    let e = t.reject_from_normalized(along).normalize();
    let (start, end) = (round.radii[0] * e, axis + round.radii[1] * e);
    let segment = end - start;
    let k = (t - start).dot(segment) / segment.length_squared();
    let out = e.reject_from_normalized(segment.normalize()).normalize();
    let height = round.side * (t - start).dot(out);
    let to_rim = start + k.clamp(0.0, 1.0) * segment - t;
    let (kind, n, distance) = if inside(k) >= 0.0 {
        ("sphere-cone", -round.side * out, height)
    } else {
        ("sphere-cone rim", to_rim.normalize(), to_rim.length())
    };
    let overlap = radius - distance;
    Touch { line: height, sure: inside(k).abs(), ..Touch::new(kind, n, overlap, overlap.min(height)) }
}

fn sphere_polygon(bodies: &Bodies, ball: usize, face: usize) -> Touch {
    let (ball, face) = (&bodies.balls[ball], &bodies.faces[face]);
    let t = ball.x - face.corner;
    if let Some(round) = face.round() {
        return sphere_round(ball.radius, &round, t);
    }
    let front = face.left.cross(face.right).normalize();
    let n = if face.is_triangle() && t.dot(front) < 0.0 { -front } else { front };
    // t - (t.n) n = l L + k R, by the components of both sides along L and R.
    let (ll, rr, lr) = (face.left.length_squared(), face.right.length_squared(), face.left.dot(face.right));
    let (tl, tr) = (t.dot(face.left), t.dot(face.right));
    let det = ll * rr - lr * lr;
    let (l, k) = ((tl * rr - tr * lr) / det, (tr * ll - tl * lr) / det);
    let height = t.dot(n);
    let over = inside(l).min(inside(k)).min(if face.is_triangle() { inside(l + k) } else { f64::INFINITY });
    let (kind, normal, distance) = if over >= 0.0 {
        (FACE, -n, height)
    } else {
        // The nearest of the points of all edges.
        let corners = match face.is_triangle() {
            true => vec![DVec3::ZERO, face.left, face.right],
            false => vec![DVec3::ZERO, face.left, face.left + face.right, face.right],
        };
        let next = corners.iter().cycle().skip(1);
        let to = corners.iter().zip(next).map(|(from, to)| {
            let edge = *to - *from;
            let along = (t - *from).dot(edge) / edge.length_squared();
            *from + along.clamp(0.0, 1.0) * edge - t
        });
        let d = to.min_by(|one, other| one.length().total_cmp(&other.length())).unwrap_or_default();
        ("sphere-polygon edge", d.normalize(), d.length())
    };
    let overlap = ball.radius - distance;
    let touch = Touch::new(kind, normal, overlap, overlap.min(height));
    // On the plane, rounding decides on which side of a triangle the centre is.
    let side = if face.is_triangle() { height } else { f64::INFINITY };
    Touch { line: height, sure: over.abs().min(side), ..touch }
}

/// Whether a contact is that of a ball over a face, whose plane it keeps when it is moved back (docs/physics section 2.10).
pub(crate) fn is_on_face(touch: &Touch) -> bool {
    ["sphere-box face", FACE].contains(&touch.kind)
}

/// Slack of the decision whether a ball is over a face of a box: the smallest distance of a parameter from an end.
pub(crate) fn face_slack(bodies: &Bodies, a: usize, b: usize) -> f64 {
    match (bodies.kind(a), bodies.kind(b)) {
        (Kind::Ball(ball), Kind::Block(block)) => {
            let t = parameters(&bodies.blocks[block], bodies.balls[ball].x);
            t.map(|t| inside(t).abs()).into_iter().fold(f64::INFINITY, f64::min)
        }
        _ => f64::INFINITY,
    }
}

/// Contacts of the axis of a rod with a polygon have no reference here: where the rod may touch an edge, a cone or a ball, all is
/// ambiguous. `rod_walls.rs` compares the backends there.
pub(crate) fn rod_polygon_slack(bodies: &Bodies, a: usize, b: usize) -> f64 {
    let (Kind::Bar(bar), Kind::Face(face)) = (bodies.kind(a), bodies.kind(b)) else { return f64::INFINITY };
    if bodies.groups[a] != bodies.groups[b] {
        return f64::INFINITY;
    }
    let (segment, radius, face) = (bodies.segment(bar), bodies.bars[bar].radius, &bodies.faces[face]);
    // Only the end spheres of a rod touch the inside of a cone or ball.
    if face.round().is_some_and(|round| round.side < 0.0) {
        return f64::INFINITY;
    }
    let (corner, left, right) = (face.corner, face.left, face.right);
    let of_triangle = [(corner, left), (corner, right), (corner + left, right - left)];
    let of_parallelogram = [(corner, left), (corner, right), (corner + left, right), (corner + right, left)];
    let edges = if face.is_triangle() { &of_triangle[..] } else { &of_parallelogram };
    let distance = |point: DVec3| match face.round() {
        Some(round) => radius - sphere_round(radius, &round, point - corner).overlap,
        None => {
            let apart = edges.iter().map(|&(start, edge)| {
                let t = (point - start).dot(edge) / edge.length_squared();
                (start + t.clamp(0.0, 1.0) * edge).distance(point)
            });
            apart.fold(f64::INFINITY, f64::min)
        }
    };
    let least = (0..=64).map(|k| distance(segment[0].lerp(segment[1], f64::from(k) / 64.0))).fold(f64::INFINITY, f64::min);
    (least - radius - segment[0].distance(segment[1]) / 64.0).max(0.0)
}

/// Returns the ends of one of the twelve edges of a box, numbered as in list entries: edge f runs along edge vector f/4.
fn box_edge(block: &Block, feature: usize) -> [DVec3; 2] {
    let along = feature / 4;
    let mut start = block.corner;
    for bit in 0..2 {
        if feature >> bit & 1 == 1 {
            start += block.edges[(along + 1 + bit) % 3];
        }
    }
    [start, start + block.edges[along]]
}

fn box_vertex(block: &Block, feature: usize) -> DVec3 {
    let steps = (0..3).filter(|axis| feature >> axis & 1 == 1);
    block.corner + steps.map(|axis| block.edges[axis]).sum::<DVec3>()
}

fn rod_box(bodies: &Bodies, bar: usize, block: &Block) -> Vec<Touch> {
    let (segment, radius) = (bodies.segment(bar), bodies.bars[bar].radius);
    let at_feature = |feature: usize, a: f64, d: DVec3, kinds: [&'static str; 2], reach: f64, line: f64| {
        let point = segment[0].lerp(segment[1], a);
        let within = parameters(block, point).map(inside).into_iter().fold(f64::INFINITY, f64::min);
        let distance = d.length();
        let holds = reach.min(radius - distance);
        let touch = if within < 0.0 {
            Touch::new(kinds[0], d.normalize(), radius - distance, holds)
        } else {
            Touch::new(kinds[1], -d.normalize(), radius + distance, holds)
        };
        Touch { feature, a, line, sure: within.abs(), ..touch }
    };
    let mut all: Vec<Touch> = (0..12)
        .map(|feature| {
            let Closest { a, d, holds, sure, .. } = segments(segment, box_edge(block, feature));
            let touch = at_feature(feature, a, d, ["rod-box edge", "rod-box edge inside"], holds, holds);
            Touch { sure: touch.sure.min(sure), ..touch }
        })
        .collect();
    let any_edge = all.iter().map(|touch| touch.holds).fold(f64::NEG_INFINITY, f64::max);
    let axis = segment[1] - segment[0];
    all.extend((0..8).map(|feature| {
        let vertex = box_vertex(block, feature);
        let a = axis.dot(vertex - segment[0]) / axis.length_squared();
        let d = vertex - segment[0].lerp(segment[1], a);
        let alone = inside(a).min(-any_edge);
        at_feature(feature, a, d, ["rod-box vertex", "rod-box vertex inside"], alone, inside(a))
    }));
    all
}
