//! Two boxes: the separating axes of both, and a clip in the plane of the reference face.

use glam::{Mat3, Vec3, Vec3A, Vec3Swizzles};

use crate::rigid::collide::clip::{Candidate, closest_of_lines, reduce};
use crate::rigid::collide::{Manifold, ids, polyhedra};
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};

/// Two boxes: half edges, axes of b in coordinates of a (columns), and the way from a to b.
struct Boxes {
    a: Vec3,
    b: Vec3,
    turn: Mat3,
    way: Vec3,
}

/// An axis that is normal to faces.
#[derive(Clone, Copy)]
struct Axis {
    separation: f32,
    /// Axis of a; 3 to 5 for those of b.
    index: usize,
}

/// Boxes without a radius.
pub(super) fn collide(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32) -> Option<Manifold> {
    let (Core::Box { half: half_a }, Core::Box { half: half_b }) = (&a.core, &b.core) else { return None };
    if a.radius + b.radius > 0.0 {
        return polyhedra::collide(a, b, b_in_a, reach);
    }
    let boxes = Boxes { a: *half_a, b: *half_b, turn: Mat3::from_quat(b_in_a.turn), way: b_in_a.position };
    let size = half_a.min_element().min(half_b.min_element());
    let face = boxes.face_axis(size, reach)?;
    let noise = 4.0 * f32::EPSILON * (boxes.way.abs().max_element() + half_a.max_element() + half_b.max_element());
    let edges = boxes.edge_separations(noise);
    let most = edges[0].max(edges[1]).max(edges[2]).max_element();
    if most > reach {
        return None;
    }
    let wins = most > face.separation + 0.05 * face.separation.abs() + 0.01 * size;
    let by_edges = |inset: f32| boxes.edge_contact(first_edge(&edges, most, size), reach, inset);
    let by_faces = || boxes.face_contact(face.index, reach);
    let nearest = || polyhedra::nearest(a, b, b_in_a, reach, 1e-3 * size + noise);
    if wins && let Some(found) = by_edges(0.0) {
        return Some(found);
    }
    let best = face.separation.max(most);
    match by_faces() {
        // The lowest corner lies beside the reference face: corners or edges face each other there.
        Some(found) if best > 0.0 && found.least() > best + 0.02 * size + noise => {
            nearest().filter(|other| other.least() < found.least() - 0.02 * size).or(Some(found))
        }
        Some(found) => Some(found),
        None if best > -0.01 * size - noise => nearest().or_else(|| by_edges(1e-3 * size)),
        None => by_edges(0.0).or_else(|| polyhedra::collide(a, b, b_in_a, reach)),
    }
}

/// The first pair of edges, in fixed order, that separates nearly as well as the best one.
fn first_edge(separations: &[Vec3A; 3], most: f32, size: f32) -> usize {
    let enough = most - 0.02 * most.abs() - 1e-3 * size;
    (0..9).find(|index| separations[index % 3][index / 3] >= enough).unwrap_or(0)
}

impl Boxes {
    /// The axis of a face with the greatest separation; `None` if that is beyond reach.
    fn face_axis(&self, size: f32, reach: f32) -> Option<Axis> {
        let absolute = self.absolute();
        let of_a = self.way.abs() - self.a - absolute * self.b;
        let of_b = (self.turn.transpose() * self.way).abs() - self.b - absolute.transpose() * self.a;
        if of_a.max_element().max(of_b.max_element()) > reach {
            return None;
        }
        let mut best = Axis { separation: of_a.x, index: 0 };
        for (index, separation) in [(1, of_a.y), (2, of_a.z), (3, of_b.x), (4, of_b.y), (5, of_b.z)] {
            if separation > best.separation + 0.02 * best.separation.abs() + 1e-3 * size {
                best = Axis { separation, index };
            }
        }
        Some(best)
    }

    fn absolute(&self) -> Mat3 {
        Mat3::from_cols(self.turn.x_axis.abs(), self.turn.y_axis.abs(), self.turn.z_axis.abs())
    }

    /// The separations along the cross products of edges: of edge j of b in vector j, of edge i of a in lane i. Minus infinity
    /// for parallel edges: the faces beside them decide.
    fn edge_separations(&self, noise: f32) -> [Vec3A; 3] {
        let (way, half) = (Vec3A::from(self.way), Vec3A::from(self.a));
        let columns = [self.turn.x_axis, self.turn.y_axis, self.turn.z_axis].map(Vec3A::from);
        let absolute = columns.map(Vec3A::abs);
        [0, 1, 2].map(|j| {
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            let (next, last) = (absolute[j].yzx(), absolute[j].zxy());
            let along = way.cross(columns[j]).abs();
            let extent_a = half.yzx() * last + half.zxy() * next;
            let extent_b = absolute[j2] * self.b[j1] + absolute[j1] * self.b[j2];
            let square = next * next + last * last;
            let gap = (along - extent_a - extent_b - noise) / square.max(Vec3A::splat(1e-6)).sqrt();
            Vec3A::select(square.cmplt(Vec3A::splat(1e-6)), Vec3A::NEG_INFINITY, gap)
        })
    }

    /// One point between two edges; `None` if the nearest points of their lines are beyond the edges or nearer than `inset` to
    /// their ends.
    fn edge_contact(&self, index: usize, reach: f32, inset: f32) -> Option<Manifold> {
        let (i, j) = (index / 3, index % 3);
        let normal = Vec3::AXES[i].cross(self.turn.col(j)).try_normalize()?;
        let normal = if normal.dot(self.way) < 0.0 { -normal } else { normal };
        let sign = |value: f32| if value < 0.0 { -1.0 } else { 1.0 };
        let mut on_a = self.a * Vec3::new(sign(normal.x), sign(normal.y), sign(normal.z));
        on_a[i] = 0.0;
        let mut on_b = self.way;
        let mut code = (j + 3 * i) * 16;
        for k in 0..3 {
            let axis = self.turn.col(k);
            let side = sign(-normal.dot(axis));
            if k != j {
                on_b += axis * (side * self.b[k]);
                code |= ((side > 0.0) as usize) << if k == (j + 1) % 3 { 2 } else { 3 };
            }
            if k != i {
                code |= ((normal[k] > 0.0) as usize) << if k == (i + 1) % 3 { 0 } else { 1 };
            }
        }
        let (s, t) = closest_of_lines(on_a, Vec3::AXES[i], on_b, self.turn.col(j))?;
        let slack = 1.0 + 1e-4;
        if s.abs() > self.a[i] * slack - inset || t.abs() > self.b[j] * slack - inset {
            return None;
        }
        let cores = (on_a + Vec3::AXES[i] * s, on_b + self.turn.col(j) * t);
        let separation = (cores.1 - cores.0).dot(normal);
        (separation <= reach).then(|| Manifold::single(normal, cores, (0.0, 0.0), ids::edges(code, 0)))
    }

    /// Points of a face of one box that lie above a face of the other one.
    fn face_contact(&self, index: usize, reach: f32) -> Option<Manifold> {
        if index < 3 {
            return self.clip(index, false, reach);
        }
        let back = self.turn.transpose();
        let swapped = Boxes { a: self.b, b: self.a, turn: back, way: -(back * self.way) };
        let mut manifold = swapped.clip(index - 3, true, reach)?;
        let outer = |point: Vec3| self.way + self.turn * point;
        manifold.normal = -(self.turn * manifold.normal);
        for point in &mut manifold.points[..manifold.count] {
            (point.on_a, point.on_b) = (outer(point.on_b), outer(point.on_a));
        }
        Some(manifold)
    }

    /// The incident face of b, clipped above the face of a along an axis.
    fn clip(&self, axis: usize, is_swapped: bool, reach: f32) -> Option<Manifold> {
        let side = if self.way[axis] < 0.0 { -1.0 } else { 1.0 };
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        // The face of b whose normal is most against that of the reference face.
        let facing = Vec3::new(self.turn.x_axis[axis], self.turn.y_axis[axis], self.turn.z_axis[axis]) * side;
        let mut along = 0;
        for k in 1..3 {
            if facing[k].abs() > facing[along].abs() + 1e-4 {
                along = k;
            }
        }
        let sign = if facing[along] > 0.0 { -1.0 } else { 1.0 };
        let (p, q) = ((along + 1) % 3, (along + 2) % 3);
        let middle = self.way + self.turn.col(along) * (sign * self.b[along]);
        let (edge_p, edge_q) = (self.turn.col(p) * self.b[p], self.turn.col(q) * self.b[q]);
        // In coordinates (u, v, height above the reference face).
        let flat = |w: Vec3| Vec3::new(w[u], w[v], w[axis] * side);
        let (middle, edge_p, edge_q) = (flat(middle) - Vec3::Z * self.a[axis], flat(edge_p), flat(edge_q));
        let mut polygon =
            Quad::new([middle - edge_p - edge_q, middle + edge_p - edge_q, middle + edge_p + edge_q, middle - edge_p + edge_q]);
        let size = self.a.min_element().min(self.b.min_element());
        polygon.cut(self.a[u], self.a[v], 1e-4 * size);
        // Corners that touch, as those of diagonal neighbours in a lattice, must not hold each other.
        if polygon.is_thinner(1e-3 * size) {
            return None;
        }

        let incident = 2 * along + (sign < 0.0) as usize;
        let reference = 2 * axis + (side < 0.0) as usize;
        let mut found = [Candidate::default(); 8];
        let mut count = 0;
        for k in 0..polygon.count {
            let (point, label) = polygon.corners[k];
            if point.z > reach {
                continue;
            }
            let before = polygon.corners[(k + polygon.count - 1) % polygon.count].1;
            let mut on_b = Vec3::ZERO;
            (on_b[u], on_b[v], on_b[axis]) = (point.x, point.y, (point.z + self.a[axis]) * side);
            let mut on_a = on_b;
            on_a[axis] = self.a[axis] * side;
            let id = ids::clip(is_swapped, reference, incident, (before, label));
            found[count] = Candidate { on_a, on_b, separation: point.z, id };
            count += 1;
        }
        reduce(&found[..count], Vec3::AXES[axis] * side, Vec3::AXES[u], (0.0, 0.0))
    }
}

/// A convex polygon: its corners, and the label of the edge after each. Edges of the incident face are 0 to 3, cuts 4 to 7.
struct Quad {
    corners: [(Vec3, u8); 8],
    count: usize,
}

impl Quad {
    fn new(corners: [Vec3; 4]) -> Self {
        let mut quad = Self { corners: [(Vec3::ZERO, 0); 8], count: 4 };
        for (k, corner) in corners.into_iter().enumerate() {
            quad.corners[k] = (corner, k as u8);
        }
        quad
    }

    /// Keeps what lies within |x| <= u, |y| <= v. Corners that lie beyond by less than the slack stay: in a stack of equal
    /// boxes, rounding must not decide which edges meet.
    fn cut(&mut self, u: f32, v: f32, slack: f32) {
        // Most faces lie within the other one along at least one direction.
        let (low, high) = self.bounds();
        for (beyond, axis, sign, bound, label) in [
            (high.x > u + slack, 0, 1.0, u, 4),
            (low.x < -u - slack, 0, -1.0, u, 5),
            (high.y > v + slack, 1, 1.0, v, 6),
            (low.y < -v - slack, 1, -1.0, v, 7),
        ] {
            if beyond && self.count > 0 {
                self.cut_one(|point| point[axis] * sign - bound, axis, sign * bound, label);
            }
        }
    }

    /// Whether it is thinner than a width along an axis, or empty.
    fn is_thinner(&self, width: f32) -> bool {
        let (low, high) = self.bounds();
        high.x - low.x < width || high.y - low.y < width
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        let corners = self.corners[..self.count].iter().map(|(corner, _)| *corner);
        corners.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), corner| (low.min(corner), high.max(corner)))
    }

    /// Removes what has a positive height over one border.
    fn cut_one(&mut self, height: impl Fn(Vec3) -> f32, axis: usize, border: f32, label: u8) {
        let mut kept = [(Vec3::ZERO, 0); 8];
        let mut count = 0;
        let mut put = |corner: (Vec3, u8)| {
            // A cut of a convex polygon adds at most one corner; rounding of degenerate ones must not add more.
            if count < 8 {
                kept[count] = corner;
                count += 1;
            }
        };
        for k in 0..self.count {
            let (from, edge) = self.corners[k];
            let (to, _) = self.corners[(k + 1) % self.count];
            let (above, below) = (height(from), height(to));
            if above <= 0.0 {
                put((from, edge));
            }
            if (above > 0.0) != (below > 0.0) {
                let mut crossing = from + (to - from) * (above / (above - below));
                crossing[axis] = border;
                put((crossing, if above > 0.0 { edge } else { label }));
            }
        }
        (self.corners, self.count) = (kept, count);
    }
}
