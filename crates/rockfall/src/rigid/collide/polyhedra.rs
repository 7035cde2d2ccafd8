//! Any two of box, hull and face, with radii.

use glam::Vec3;

use crate::rigid::collide::clip::{Candidate, MOST_CORNERS, Polygon, closest_of_lines, reduce};
use crate::rigid::collide::closest::closest;
use crate::rigid::collide::solid::Solid;
use crate::rigid::collide::{Manifold, ids};
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, MOST_FACES, Shape};

/// Normals whose product is greater are those of contacts that lie flat.
const FLAT: f32 = 0.99;

/// Two polyhedra in coordinates of a, with what all steps need.
struct Pair<'a> {
    a: Solid<'a>,
    b: Solid<'a>,
    radii: (f32, f32),
    /// The greatest separation of the cores.
    reach: f32,
    /// The least edge, for preferences.
    size: f32,
    /// Rounding error of a separation.
    noise: f32,
}

/// A face whose plane separates best.
#[derive(Clone, Copy)]
struct FaceAxis {
    separation: f32,
    of_b: bool,
    face: usize,
}

/// Two edges whose common normal separates best.
#[derive(Clone, Copy)]
struct EdgeAxis {
    separation: f32,
    normal: Vec3,
    of_a: usize,
    of_b: usize,
}

/// Two polyhedra: the best of all axes, then a clip. If they are apart and have no points there, the closest points.
pub(super) fn collide(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32) -> Option<Manifold> {
    let pair = Pair::new(a, b, b_in_a, reach);
    match (&a.core, &b.core) {
        (Core::Face { one_sided: true, .. }, Core::Face { .. }) | (Core::Face { .. }, Core::Face { one_sided: true, .. }) => {
            None
        }
        (Core::Face { one_sided: true, .. }, _) => pair.above_face(b_in_a.position),
        _ => pair.manifold(),
    }
}

/// One point between the closest points of two shapes apart; `None` beyond reach, or if their cores are nearer than `least`.
pub(super) fn nearest(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32, least: f32) -> Option<Manifold> {
    Pair::new(a, b, b_in_a, reach).nearest(least)
}

impl<'a> Pair<'a> {
    fn new(a: &'a Shape, b: &'a Shape, b_in_a: &Pose, reach: f32) -> Self {
        let (solid_a, solid_b) = (Solid::new(&a.core, &Pose::IDENTITY), Solid::new(&b.core, b_in_a));
        let scale = solid_a.scale() + solid_b.scale() + b_in_a.position.abs().max_element();
        Self {
            a: solid_a,
            b: solid_b,
            radii: (a.radius, b.radius),
            reach: reach + a.radius + b.radius,
            size: 0.5 * a.width().min(b.width()),
            noise: 4.0 * f32::EPSILON * scale,
        }
    }

    fn manifold(&self) -> Option<Manifold> {
        let face = self.face_axis(1.0)?;
        let edge = self.edge_axis(1.0)?;
        let by_edges = || edge.and_then(|edge| self.edge_contact(&edge));
        let wins = edge.is_some_and(|edge| edge.separation > face.separation + 0.05 * face.separation.abs() + 0.01 * self.size);
        let first = if wins { by_edges().or_else(|| self.edge_contact(&self.edge_axis(0.0)??)) } else { None };
        let found = match (first, self.face_contact(&face)) {
            (Some(edges), Some(flat)) if lies_flat(&flat, &edges, 0.01 * self.size + self.noise) => Some(flat),
            (first, flat) => first.or(flat),
        };
        let best = edge.map_or(face.separation, |edge| edge.separation.max(face.separation));
        let radii = self.radii.0 + self.radii.1;
        let tiny = 1e-3 * self.size + self.noise;
        match found {
            // Shapes with radii are round at corners and edges: there the true direction counts.
            Some(found) if best > 0.0 && radii > 0.0 => {
                let other = self.nearest(0.0)?;
                let is_same = (other.least() - found.least()).abs() <= 1e-3 * (best + self.size) + self.noise;
                Some(if is_same { found } else { other })
            }
            // The lowest corner lies beside the reference face: corners or edges face each other there.
            Some(found) if best > 0.0 && found.least() > best + 20.0 * tiny => {
                self.nearest(tiny).filter(|other| other.least() < found.least() - 20.0 * tiny).or(Some(found))
            }
            // Likewise of shapes that overlap, beside a feature that is preferred to a slightly better one.
            Some(found) if best <= 0.0 && found.least() + radii > best + 0.1 * best.abs() + 20.0 * tiny => {
                self.strict().filter(|other| other.least() < found.least()).or(Some(found))
            }
            Some(found) => Some(found),
            None if best > -10.0 * tiny => self.nearest(tiny).or_else(by_edges),
            None => self.strict(),
        }
    }

    /// The very best axis of shapes that overlap, without preferences. Never nothing.
    fn strict(&self) -> Option<Manifold> {
        let face = self.face_axis(0.0)?;
        let by_faces = || self.face_contact(&face);
        let edge = self.edge_axis(0.0)?;
        let by_edges = || self.edge_contact(&edge?);
        let found = match edge {
            Some(edge) if edge.separation > face.separation => by_edges().or_else(by_faces),
            _ => by_faces().or_else(by_edges),
        };
        found.or_else(|| self.common_point(&face))
    }

    /// The closest points of the cores, unless these are nearer than `least`.
    fn nearest(&self, least: f32) -> Option<Manifold> {
        let found = closest(self.a.vertices(), self.b.vertices());
        let distance = found.distance as f32;
        if distance > self.reach || distance <= least {
            return None;
        }
        let normal = ((found.on_b - found.on_a) / found.distance).as_vec3().normalize();
        let id = ids::nearest(found.features.0, found.features.1);
        Some(Manifold::single(normal, (found.on_a.as_vec3(), found.on_b.as_vec3()), self.radii, id))
    }

    /// A one-sided face and what is in front of it.
    fn above_face(&self, centre: Vec3) -> Option<Manifold> {
        let separation = self.b.least(Vec3::Z);
        if separation > self.reach || centre.z < 0.0 {
            return None;
        }
        self.face_contact(&FaceAxis { separation, of_b: false, face: 0 })
    }

    /// The face that separates best; `None` if that is beyond reach. A later one must win by a margin times `bias`.
    fn face_axis(&self, bias: f32) -> Option<FaceAxis> {
        let mut best: Option<FaceAxis> = None;
        for (of_b, own, other) in [(false, &self.a, &self.b), (true, &self.b, &self.a)] {
            for (face, normal) in own.normals().iter().enumerate() {
                let separation = other.least(*normal) - own.anchor(face).dot(*normal);
                if separation > self.reach {
                    return None;
                }
                let is_better = |best: &FaceAxis| {
                    separation > best.separation + bias * (0.02 * best.separation.abs() + 1e-3 * self.size + self.noise)
                };
                if best.as_ref().is_none_or(is_better) {
                    best = Some(FaceAxis { separation, of_b, face });
                }
            }
        }
        best
    }

    /// A common point of shapes that overlap, pushed out of a face: never nothing.
    fn common_point(&self, axis: &FaceAxis) -> Option<Manifold> {
        let own = if axis.of_b { &self.b } else { &self.a };
        let normal = own.normals()[axis.face];
        let point = closest(self.a.vertices(), self.b.vertices()).on_b.as_vec3();
        let foot = point - normal * (point - own.anchor(axis.face)).dot(normal);
        let (normal, cores) = if axis.of_b { (-normal, (point, foot)) } else { (normal, (foot, point)) };
        Some(Manifold::single(normal, cores, self.radii, 0))
    }

    /// The pair of edges that separates best; the outer `None` if that is beyond reach, the inner one without such a pair.
    /// Only edges whose arcs cross on the sphere of normals make a face of the difference of the shapes.
    fn edge_axis(&self, bias: f32) -> Option<Option<EdgeAxis>> {
        let mut best: Option<EdgeAxis> = None;
        // The plane of an arc is perpendicular to its edge. Both arcs must lie on both sides of the other's plane, and not
        // opposite to each other. Which side the faces of the other shape are on is kept in bits.
        let mut sides = [Sides::default(); MOST_EDGES];
        for (of_b, edge) in self.b.edges.iter().enumerate() {
            sides[of_b] = Sides::new(self.a.normals(), line(&self.b, edge).1);
        }
        for (of_a, edge_a) in self.a.edges.iter().enumerate() {
            let (n1, n2) = (self.a.normals()[edge_a[2] as usize], self.a.normals()[edge_a[3] as usize]);
            let (start, along) = line(&self.a, edge_a);
            let own = Sides::new(self.b.normals(), along);
            for (of_b, edge_b) in self.b.edges.iter().enumerate() {
                if !own.differ(edge_b) || !sides[of_b].differ(edge_a) {
                    continue;
                }
                let (m1, m2) = (-self.b.normals()[edge_b[2] as usize], -self.b.normals()[edge_b[3] as usize]);
                let (other, across) = line(&self.b, edge_b);
                let normal = along.cross(across);
                let square = normal.length_squared();
                if square < 1e-6 {
                    continue;
                }
                let length = square.sqrt();
                let normal = normal / length;
                let (of_n, of_m) = (normal.dot(n1 + n2), normal.dot(m1 + m2));
                if of_n * of_m <= 0.0 {
                    continue;
                }
                let normal = if of_n < 0.0 { -normal } else { normal };
                let separation = (other - start).dot(normal) - self.noise / length;
                if separation > self.reach {
                    return None;
                }
                let is_better =
                    |best: &EdgeAxis| separation > best.separation + bias * (0.02 * best.separation.abs() + 1e-3 * self.size);
                if best.as_ref().is_none_or(is_better) {
                    best = Some(EdgeAxis { separation, normal, of_a, of_b });
                }
            }
        }
        Some(best)
    }

    /// One point between two edges; `None` if the nearest points of their lines are beyond the edges.
    fn edge_contact(&self, axis: &EdgeAxis) -> Option<Manifold> {
        let (edge_a, edge_b) = (&self.a.edges[axis.of_a], &self.b.edges[axis.of_b]);
        let ((start, along), (other, across)) = (line(&self.a, edge_a), line(&self.b, edge_b));
        let (s, t) = closest_of_lines(start, along, other, across)?;
        let length = |solid: &Solid, edge: &[u8; 4]| solid.vertex(edge[0]).distance(solid.vertex(edge[1]));
        let is_within = |at: f32, length: f32| at > -1e-4 * length && at < (1.0 + 1e-4) * length;
        if !is_within(s, length(&self.a, edge_a)) || !is_within(t, length(&self.b, edge_b)) {
            return None;
        }
        let cores = (start + along * s, other + across * t);
        let is_near = (cores.1 - cores.0).dot(axis.normal) <= self.reach;
        is_near.then(|| Manifold::single(axis.normal, cores, self.radii, ids::edges(axis.of_a, axis.of_b)))
    }

    /// Points of the other shape's face above a face. Sides of a flat face have only an edge, which is clipped instead.
    fn face_contact(&self, axis: &FaceAxis) -> Option<Manifold> {
        let (own, other) = if axis.of_b { (&self.b, &self.a) } else { (&self.a, &self.b) };
        let normal = own.normals()[axis.face];
        let incident = other.face_against(normal);
        let outward = if axis.of_b { -normal } else { normal };
        let mut found = [Candidate::default(); MOST_CORNERS];
        let mut count = 0;
        let mut put = |on_own: Vec3, on_other: Vec3, separation: f32, labels: (u8, u8)| {
            if separation <= self.reach && count < MOST_CORNERS {
                let (on_a, on_b) = if axis.of_b { (on_other, on_own) } else { (on_own, on_other) };
                found[count] = Candidate { on_a, on_b, separation, id: ids::clip(axis.of_b, axis.face, incident, labels) };
                count += 1;
            }
        };
        if own.loop_of(axis.face).len() == 2 {
            let (against, anchor) = (other.normals()[incident], other.anchor(incident));
            let slope = against.dot(normal);
            let polygon = clip(own, axis.face, other, incident, normal, self.noise);
            for (corner, labels) in polygon.corners().filter(|_| slope < -1e-3) {
                let separation = (anchor - corner).dot(against) / slope;
                put(corner, corner + normal * separation, separation, labels);
            }
        } else {
            let anchor = own.anchor(axis.face);
            let polygon = clip(other, incident, own, axis.face, normal, self.noise);
            for (corner, labels) in polygon.corners() {
                let separation = (corner - anchor).dot(normal);
                put(corner - normal * separation, corner, separation, labels);
            }
        }
        let along = own.vertex(own.loop_of(axis.face)[1]) - own.anchor(axis.face);
        reduce(&found[..count], outward, along.normalize_or(Vec3::X), self.radii)
    }
}

/// Whether the contact of a face has the place of a contact of edges, and others: corners of a plate that lies over an edge touch, too.
fn lies_flat(flat: &Manifold, edges: &Manifold, slack: f32) -> bool {
    flat.count > 1 && flat.normal.dot(edges.normal) > FLAT && flat.least() <= edges.least() + slack
}

/// Greatest number of edges of a polyhedron with 32 faces.
const MOST_EDGES: usize = 3 * MOST_FACES - 6;

/// On which side of a plane through the origin some normals lie.
#[derive(Clone, Copy, Default)]
struct Sides {
    above: u32,
    below: u32,
}

impl Sides {
    fn new(normals: &[Vec3], axis: Vec3) -> Self {
        let mut sides = Self::default();
        for (face, normal) in normals.iter().enumerate() {
            let height = normal.dot(axis);
            sides.above |= ((height > 0.0) as u32) << face;
            sides.below |= ((height < 0.0) as u32) << face;
        }
        sides
    }

    /// Whether the two faces of an edge lie on different sides.
    fn differ(&self, edge: &[u8; 4]) -> bool {
        let (first, second) = (edge[2], edge[3]);
        (self.above >> first & self.below >> second | self.below >> first & self.above >> second) & 1 == 1
    }
}

/// An edge: its start and its direction.
fn line(solid: &Solid, edge: &[u8; 4]) -> (Vec3, Vec3) {
    let start = solid.vertex(edge[0]);
    (start, (solid.vertex(edge[1]) - start).normalize_or_zero())
}

/// What of a face lies between the sides of another face, which stand on it along `normal`, up to rounding errors.
fn clip(solid: &Solid, face: usize, sides: &Solid, within: usize, normal: Vec3, noise: f32) -> Polygon {
    let mut polygon = Polygon::new(solid.loop_of(face).iter().map(|corner| solid.vertex(*corner)));
    let corners = sides.loop_of(within);
    let turn = sides.normals()[within].dot(normal).signum();
    for k in 0..corners.len() {
        let (start, end) = (sides.vertex(corners[k]), sides.vertex(corners[(k + 1) % corners.len()]));
        if let Some(out) = ((end - start).cross(normal) * turn).try_normalize() {
            polygon.cut(out, start.dot(out) + noise, 32 + k as u8);
        }
    }
    polygon
}
