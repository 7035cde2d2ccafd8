//! A segment with a radius against segments and polyhedra.

use glam::Vec3;

use crate::rigid::collide::ball::on_segment;
use crate::rigid::collide::clip::{Polygon, closest_of_lines};
use crate::rigid::collide::closest::closest;
use crate::rigid::collide::solid::Solid;
use crate::rigid::collide::{Manifold, ids};
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Shape};

/// A segment with its ends.
#[derive(Clone, Copy)]
struct Segment {
    start: Vec3,
    end: Vec3,
}

impl Segment {
    fn new(half: f32, pose: &Pose) -> Self {
        let along = pose.turn * Vec3::new(0.0, half, 0.0);
        Self { start: pose.position - along, end: pose.position + along }
    }

    fn along(&self) -> Vec3 {
        (self.end - self.start).normalize_or_zero()
    }
}

/// Two capsules.
pub(super) fn with_capsule(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32) -> Option<Manifold> {
    let (Core::Segment { half: half_a }, Core::Segment { half: half_b }) = (&a.core, &b.core) else { return None };
    let (first, second) = (Segment::new(*half_a, &Pose::IDENTITY), Segment::new(*half_b, b_in_a));
    let radii = (a.radius, b.radius);
    let reach = reach + radii.0 + radii.1;
    let cores = closest_of_segments(&first, &second);
    let offset = cores.1 - cores.0;
    let distance = offset.length();
    if distance > reach {
        return None;
    }
    if let Some(found) = side_by_side(&first, &second, radii, reach, ids::edges(0, 0)) {
        return Some(found);
    }
    let across = first.along().cross(second.along()).normalize_or(Vec3::X);
    let across = if across.dot(b_in_a.position) < 0.0 { -across } else { across };
    let noise = 4.0 * f32::EPSILON * (half_a + half_b + b_in_a.position.abs().max_element());
    let normal = if distance > noise { offset / distance } else { across };
    Some(Manifold::single(normal, cores, radii, 0))
}

/// The closest points of two segments.
fn closest_of_segments(a: &Segment, b: &Segment) -> (Vec3, Vec3) {
    let (along, across) = (a.along(), b.along());
    if let Some((s, t)) = closest_of_lines(a.start, along, b.start, across)
        && s >= 0.0
        && s <= a.start.distance(a.end)
        && t >= 0.0
        && t <= b.start.distance(b.end)
    {
        return (a.start + along * s, b.start + across * t);
    }
    // At least one of the points is an end.
    let mut best = (a.start, on_segment(b.start, b.end, a.start));
    let others = [
        (a.end, on_segment(b.start, b.end, a.end)),
        (on_segment(a.start, a.end, b.start), b.start),
        (on_segment(a.start, a.end, b.end), b.end),
    ];
    for pair in others {
        if pair.0.distance_squared(pair.1) < best.0.distance_squared(best.1) {
            best = pair;
        }
    }
    best
}

/// Two points at the ends of the common extent of two segments that are nearly parallel there.
fn side_by_side(a: &Segment, b: &Segment, radii: (f32, f32), reach: f32, id: u32) -> Option<Manifold> {
    let (along, across) = (a.along(), b.along());
    let cosine = along.dot(across);
    if cosine.abs() < 0.99 {
        return None;
    }
    let (low, high) = (0.0, a.start.distance(a.end));
    let (from, to) = ((b.start - a.start).dot(along), (b.end - a.start).dot(along));
    let (from, to) = (from.min(to).max(low), from.max(to).min(high));
    if to - from < 1e-3 * high.min(b.start.distance(b.end)) {
        return None;
    }
    let feet = [from, to].map(|at| a.start + along * at);
    // Where b passes a foot, at the same coordinate along a.
    let offsets = feet.map(|foot| b.start + across * ((foot - b.start).dot(along) / cosine) - foot);
    let normal = (offsets[0] + offsets[1]).try_normalize()?;
    let least = if radii.0 > 0.0 { radii.0.min(radii.1) } else { radii.1 };
    let is_aligned = |offset: &Vec3| offset.dot(normal) > 0.0 && offset.reject_from_normalized(normal).length() < 0.01 * least;
    if !offsets.iter().all(is_aligned) {
        return None;
    }
    let mut manifold = Manifold::empty(normal);
    for (number, (foot, offset)) in feet.iter().zip(&offsets).enumerate() {
        let separation = offset.dot(normal);
        if separation <= reach {
            manifold.push((*foot, *foot + normal * separation), radii, id + 1 + number as u32);
        }
    }
    manifold.some()
}

/// A capsule b and a box, hull or face a.
pub(super) fn with_polyhedron(a: &Shape, b: &Shape, b_in_a: &Pose, reach: f32) -> Option<Manifold> {
    let Core::Segment { half } = b.core else { return None };
    let solid = Solid::new(&a.core, &Pose::IDENTITY);
    let noise = 2.0 * f32::EPSILON * (solid.scale() + half + b_in_a.position.abs().max_element());
    let pair = Pair {
        solid,
        segment: Segment::new(half, b_in_a),
        middle: b_in_a.position,
        radii: (a.radius, b.radius),
        reach: reach + a.radius + b.radius,
        noise,
        sides: match a.core {
            Core::Face { one_sided: true, .. } => Sides::One,
            Core::Face { .. } => Sides::Two,
            _ => Sides::Inside,
        },
    };
    if pair.sides == Sides::One && pair.middle.z < 0.0 {
        return None;
    }
    let found = closest(pair.solid.vertices(), &[pair.segment.start, pair.segment.end]);
    let distance = found.distance as f32;
    if distance > pair.reach {
        return None;
    }
    if distance <= pair.noise {
        return pair.overlap(found.on_b.as_vec3());
    }
    let normal = ((found.on_b - found.on_a) / found.distance).as_vec3().normalize();
    if pair.sides == Sides::One && normal.z < 1e-3 {
        return None;
    }
    let single = || Manifold::single(normal, (found.on_a.as_vec3(), found.on_b.as_vec3()), pair.radii, 0);
    Some(pair.along_face(normal, distance).or_else(|| pair.along_edge(normal, distance)).unwrap_or_else(single))
}

/// What a polyhedron is like inside.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sides {
    /// A body.
    Inside,
    /// A flat face, touched on both sides.
    Two,
    /// A flat face, touched on one side.
    One,
}

/// A polyhedron a and a segment b.
struct Pair<'a> {
    solid: Solid<'a>,
    segment: Segment,
    /// Middle of the segment.
    middle: Vec3,
    radii: (f32, f32),
    /// The greatest separation of the cores.
    reach: f32,
    /// Rounding error of a coordinate.
    noise: f32,
    sides: Sides,
}

impl Pair<'_> {
    /// Points above the face that a direction is normal to, if they are as near as the cores.
    fn along_face(&self, normal: Vec3, distance: f32) -> Option<Manifold> {
        let face = (0..self.solid.face_count()).find(|face| self.solid.normals()[*face].dot(normal) > 0.999_99)?;
        let is_flat = self.solid.loop_of(face).len() > 2;
        let found = is_flat.then(|| self.face_contact(face)).flatten()?;
        let off = found.least() + self.radii.0 + self.radii.1 - distance;
        (off.abs() <= 0.01 * (distance + self.radii.1)).then_some(found)
    }

    /// Two points along an edge that is nearly parallel to the segment.
    fn along_edge(&self, normal: Vec3, distance: f32) -> Option<Manifold> {
        let along = self.segment.along();
        for (number, edge) in self.solid.edges.iter().enumerate() {
            let [start, end] = [edge[0], edge[1]].map(|corner| self.solid.vertex(corner));
            if (end - start).normalize_or_zero().dot(along).abs() < 0.999 {
                continue;
            }
            let id = ids::edges(number + 1, 0);
            let Some(found) = side_by_side(&Segment { start, end }, &self.segment, self.radii, self.reach, id) else {
                continue;
            };
            let off = found.least() + self.radii.0 + self.radii.1 - distance;
            if found.normal.dot(normal) > 0.999 && off.abs() <= 0.01 * (distance + self.radii.1) {
                return Some(found);
            }
        }
        None
    }

    /// Cores that overlap and have a common point: the way out that is shortest.
    fn overlap(&self, point: Vec3) -> Option<Manifold> {
        let by_edge = |part: f32, least: f32| {
            let (number, normal, separation) = self.least_edge(part).filter(|_| self.sides != Sides::One)?;
            if separation > least { self.edge_contact(number, normal) } else { None }
        };
        let by_face = |part: f32| {
            // The lower end may lie beside the face.
            let (face, depth) = self.least_face(part)?;
            let most = depth + 0.05 * depth.abs() + self.noise - self.radii.0 - self.radii.1;
            self.face_contact(face).filter(|found| self.sides != Sides::Inside || found.least() <= most)
        };
        let (face, depth) = self.least_face(0.02)?;
        let enough = depth + 0.05 * depth.abs();
        // The segment may lie beside a feature that is preferred, but not beside the very best one.
        by_edge(0.02, enough)
            .or_else(|| by_edge(0.0, enough))
            .or_else(|| by_face(0.02))
            .or_else(|| by_face(0.0))
            .or_else(|| by_edge(0.0, f32::NEG_INFINITY))
            .or_else(|| self.face_contact(face))
            .or_else(|| self.common_point(point))
    }

    /// A common point of cores that overlap, pushed out of the best face: never nothing.
    fn common_point(&self, point: Vec3) -> Option<Manifold> {
        let (face, _) = self.least_face(0.0).filter(|_| self.sides == Sides::Inside)?;
        let normal = self.solid.normals()[face];
        let height = (point - self.solid.anchor(face)).dot(normal);
        Some(Manifold::single(normal, (point - normal * height, point), self.radii, 0))
    }

    /// The face that the ends are least below. A later one must win by a part of the depth.
    fn least_face(&self, part: f32) -> Option<(usize, f32)> {
        let depth = |face: usize| {
            let (normal, anchor) = (self.solid.normals()[face], self.solid.anchor(face));
            (self.segment.start - anchor).dot(normal).min((self.segment.end - anchor).dot(normal))
        };
        if self.sides != Sides::Inside {
            let face = if self.middle.z < 0.0 { 1 } else { 0 };
            return Some((face, depth(face)));
        }
        let mut best: Option<(usize, f32)> = None;
        for face in 0..self.solid.face_count() {
            let depth = depth(face);
            if best.is_none_or(|(_, known)| depth > known + part * known.abs()) {
                best = Some((face, depth));
            }
        }
        best
    }

    /// The edge whose common normal with the segment separates best: number, normal and separation.
    fn least_edge(&self, part: f32) -> Option<(usize, Vec3, f32)> {
        let along = self.segment.along();
        let mut best: Option<(usize, Vec3, f32)> = None;
        for (number, edge) in self.solid.edges.iter().enumerate() {
            let normals = [edge[2], edge[3]].map(|face| self.solid.normals()[face as usize]);
            if normals[0].dot(along) * normals[1].dot(along) >= 0.0 {
                continue;
            }
            let [start, end] = [edge[0], edge[1]].map(|corner| self.solid.vertex(corner));
            let normal = (end - start).normalize_or_zero().cross(along);
            if normal.length_squared() < 1e-6 {
                continue;
            }
            let normal = normal.normalize();
            let normal = if normal.dot(normals[0] + normals[1]) < 0.0 { -normal } else { normal };
            let separation = (self.segment.start - start).dot(normal);
            if best.is_none_or(|(_, _, known)| separation > known + part * known.abs()) {
                best = Some((number, normal, separation));
            }
        }
        best
    }

    fn edge_contact(&self, number: usize, normal: Vec3) -> Option<Manifold> {
        let edge = &self.solid.edges[number];
        let [start, end] = [edge[0], edge[1]].map(|corner| self.solid.vertex(corner));
        let (along, across) = ((end - start).normalize_or_zero(), self.segment.along());
        let (s, t) = closest_of_lines(start, along, self.segment.start, across)?;
        let is_within = |at: f32, length: f32| at > -1e-4 * length && at < (1.0 + 1e-4) * length;
        if !is_within(s, start.distance(end)) || !is_within(t, self.segment.start.distance(self.segment.end)) {
            return None;
        }
        Some(Manifold::single(normal, (start + along * s, self.segment.start + across * t), self.radii, 0))
    }

    /// Points of the segment above a face.
    fn face_contact(&self, face: usize) -> Option<Manifold> {
        let (normal, anchor) = (self.solid.normals()[face], self.solid.anchor(face));
        let mut part = Polygon::new([self.segment.start, self.segment.end]);
        let corners = self.solid.loop_of(face);
        for k in 0..corners.len() {
            let (start, end) = (self.solid.vertex(corners[k]), self.solid.vertex(corners[(k + 1) % corners.len()]));
            if let Some(out) = (end - start).cross(normal).try_normalize() {
                part.cut(out, start.dot(out) + self.noise, 32 + k as u8);
            }
        }
        let mut manifold = Manifold::empty(normal);
        for (number, (corner, _)) in part.corners().take(2).enumerate() {
            let separation = (corner - anchor).dot(normal);
            if separation <= self.reach {
                let id = ids::clip(false, face, 0, (0, number as u8));
                manifold.push((corner - normal * separation, corner), self.radii, id);
            }
        }
        manifold.some()
    }
}
