//! The volume of a union of balls, cylinders, boxes and convex hulls, with its first and second moments.
//!
//! The moments of each part alone are closed forms. Where parts overlap, each of the n parts at a point gets 1/n of the matter there.
//! What a part loses this way is an integral over lines through the part, parallel to its axis: on a line, every part is an interval,
//! because it is convex, so the integral along a line is a closed form too. The lines are at the middles of equal areas of the
//! cross-section of the part. They have the symmetry of a square or rectangle, and so has the result.

use std::f64::consts::{PI, TAU};

use glam::{DMat3, DQuat, DVec3};

use super::mass::MassProperties;
use crate::rigid::shape::Hull;

/// Number of intervals to compute for all lines. A part has at most 256² and at least 16² lines.
const INTERVALS: usize = 1 << 25;
/// Share of the size of a shape below which a coordinate of its centre counts as 0. The inertia is treated in the same way.
const ROUNDING: f64 = 1e-13;

/// A ball, a cylinder with flat ends, a box, or a convex hull.
pub(super) struct Part {
    middle: DVec3,
    /// Unit vector along a cylinder or box.
    axis: DVec3,
    /// Half the length along the axis; 0 for a ball.
    half: f64,
    /// 0 for a box and a hull.
    radius: f64,
    /// Half the edges of a box across its axis. A hull has those of a box around it.
    sides: Option<[DVec3; 2]>,
    hull: Option<Polyhedron>,
}

/// What is inside of some planes.
struct Polyhedron {
    /// Outward normals, and the distances of the planes from the middle of the part.
    planes: Vec<(DVec3, f64)>,
    /// Moments about the middle of the part.
    moments: Moments,
}

/// A union of parts of density 1.
pub(super) struct Solid {
    parts: Vec<Part>,
}

/// Integrals of 1, x and x xᵀ over a volume.
#[derive(Clone, Copy)]
struct Moments {
    volume: f64,
    first: DVec3,
    second: DMat3,
}

impl Part {
    pub(super) fn sphere(centre: DVec3, radius: f64) -> Self {
        Self { middle: centre, axis: DVec3::Z, half: 0.0, radius, sides: None, hull: None }
    }

    pub(super) fn cylinder(a: DVec3, b: DVec3, radius: f64) -> Self {
        let length = a.distance(b);
        Self { middle: 0.5 * (a + b), axis: (b - a) / length, half: 0.5 * length, radius, sides: None, hull: None }
    }

    /// A box with half the lengths of its edges, which `turn` turns from the coordinate axes.
    pub(super) fn cuboid(middle: DVec3, turn: DQuat, half: DVec3) -> Self {
        let [x, y, z] = DVec3::AXES.map(|axis| turn * axis);
        Self { middle, axis: z, half: half.z, radius: 0.0, sides: Some([half.x * x, half.y * y]), hull: None }
    }

    /// A convex hull whose vertices are relative to a point.
    pub(super) fn hull(hull: &Hull, middle: DVec3) -> Self {
        let corner = |number: u8| hull.vertices[number as usize].as_dvec3();
        let plane = |(normal, corners): &(glam::Vec3, Vec<u8>)| {
            let normal = normal.as_dvec3().normalize();
            (normal, normal.dot(corner(corners[0])))
        };
        let half = hull.vertices.iter().fold(DVec3::ZERO, |half, vertex| half.max(vertex.as_dvec3().abs()));
        let (volume, first, second) = hull.moments();
        let planes = hull.faces.iter().map(plane).collect();
        let hull = Some(Polyhedron { planes, moments: Moments { volume, first, second } });
        Self { hull, ..Self::cuboid(middle, DQuat::IDENTITY, half) }
    }

    fn is_sphere(&self) -> bool {
        self.half == 0.0 && self.sides.is_none()
    }

    /// Radius of a ball about the middle that contains the part.
    fn reach(&self) -> f64 {
        let across = self.sides.map_or(self.radius, |[u, v]| u.length().hypot(v.length()));
        self.half.hypot(across)
    }

    /// Moments about the middle.
    fn moments(&self) -> Moments {
        if let Some(hull) = &self.hull {
            return hull.moments;
        }
        if let Some([u, v]) = self.sides {
            let volume = 8.0 * u.length() * v.length() * self.half;
            let second = outer(u, u) + outer(v, v) + outer(self.axis, self.axis) * self.half * self.half;
            return Moments { volume, first: DVec3::ZERO, second: second * (volume / 3.0) };
        }
        let r2 = self.radius * self.radius;
        let outer = outer(self.axis, self.axis);
        if self.is_sphere() {
            let volume = 4.0 / 3.0 * PI * r2 * self.radius;
            return Moments { volume, first: DVec3::ZERO, second: DMat3::IDENTITY * (volume * r2 / 5.0) };
        }
        let volume = TAU * r2 * self.half;
        let along = volume * self.half * self.half / 3.0;
        let across = volume * r2 / 4.0;
        Moments { volume, first: DVec3::ZERO, second: (DMat3::IDENTITY - outer) * across + outer * along }
    }

    /// The part of the line point + t direction that is inside.
    fn interval(&self, point: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let from = point - self.middle;
        if let Some(hull) = &self.hull {
            return hull.interval(from, direction);
        }
        if let Some([u, v]) = self.sides {
            let slabs = [u / u.length_squared(), v / v.length_squared(), self.axis / self.half];
            return slabs.into_iter().try_fold([f64::NEG_INFINITY, f64::INFINITY], |inside, across| {
                let inside = within(inside, from.dot(across), direction.dot(across))?;
                (inside[0] < inside[1]).then_some(inside)
            });
        }
        // Across the axis for a cylinder.
        let (p, d) = if self.is_sphere() {
            (from, direction)
        } else {
            (from - self.axis * from.dot(self.axis), direction - self.axis * direction.dot(self.axis))
        };
        let (a, b, c) = (d.length_squared(), p.dot(d), p.length_squared() - self.radius * self.radius);
        let mut inside = [f64::NEG_INFINITY, f64::INFINITY];
        if a > 1e-24 {
            let root = b * b - a * c;
            if root <= 0.0 {
                return None;
            }
            inside = [-b - root.sqrt(), -b + root.sqrt()].map(|t| t / a);
        } else if c >= 0.0 {
            return None;
        }
        if !self.is_sphere() {
            let across = self.axis / self.half;
            inside = within(inside, from.dot(across), direction.dot(across))?;
        }
        (inside[0] < inside[1]).then_some(inside)
    }

    /// The moments of the matter of the part about its middle. Lines are on `side` rings with `side` places each.
    fn share(&self, near: &[&Self], side: usize) -> Moments {
        let mut all = self.moments();
        if near.is_empty() {
            return all;
        }
        let cell = self.cross_section() / (side * side) as f64;
        let mut line = Line::default();
        for (one, other) in (0..side).flat_map(|one| (0..side).map(move |other| (one, other))) {
            let [one, other] = [one, other].map(|number| (number as f64 + 0.5) / side as f64);
            let from = self.place_across(one, other);
            let lost = line.lost(self, near, from);
            all.subtract_line(from, self.axis, lost.map(|integral| integral * cell));
        }
        all
    }

    fn cross_section(&self) -> f64 {
        self.sides.map_or(PI * self.radius * self.radius, |[u, v]| 4.0 * u.length() * v.length())
    }

    /// A place in the cross-section. Equal areas of the unit square become equal areas.
    fn place_across(&self, one: f64, other: f64) -> DVec3 {
        if let Some([u, v]) = self.sides {
            return u * (2.0 * one - 1.0) + v * (2.0 * other - 1.0);
        }
        let (u, v) = self.axis.any_orthonormal_pair();
        let (rho, (sin, cos)) = (self.radius * one.sqrt(), (TAU * other).sin_cos());
        u * (rho * cos) + v * (rho * sin)
    }
}

impl Polyhedron {
    /// The part of the line from + t direction that is inside.
    fn interval(&self, from: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let mut inside = [f64::NEG_INFINITY, f64::INFINITY];
        for (normal, distance) in &self.planes {
            let (left, rate) = (distance - normal.dot(from), normal.dot(direction));
            if rate > 1e-12 {
                inside[1] = inside[1].min(left / rate);
            } else if rate < -1e-12 {
                inside[0] = inside[0].max(left / rate);
            } else if left <= 0.0 {
                return None;
            }
        }
        (inside[0] < inside[1]).then_some(inside)
    }
}

/// The part of an interval of t in which |at + rate t| <= 1.
fn within([low, high]: [f64; 2], at: f64, rate: f64) -> Option<[f64; 2]> {
    if rate.abs() > 1e-12 {
        let ends = [-1.0, 1.0].map(|end| (end - at) / rate);
        return Some([low.max(ends[0].min(ends[1])), high.min(ends[0].max(ends[1]))]);
    }
    (at.abs() < 1.0).then_some([low, high])
}

impl Solid {
    pub(super) fn new(parts: Vec<Part>) -> Self {
        Self { parts }
    }

    /// Mass properties at density 1.
    pub(super) fn properties(&self) -> MassProperties {
        if let Some(capsule) = self.capsule() {
            return capsule;
        }
        // Away from the origin, moments about it would lose digits.
        let origin = self.parts[0].middle;
        let mut all = Moments { volume: 0.0, first: DVec3::ZERO, second: DMat3::ZERO };
        let near: Vec<Vec<&Part>> = (0..self.parts.len()).map(|number| self.near(number)).collect();
        let pairs: usize = near.iter().map(Vec::len).sum();
        let side = ((INTERVALS / pairs.max(1)) as f64).sqrt().clamp(16.0, 256.0) as usize / 4 * 4;
        for (part, near) in self.parts.iter().zip(&near) {
            all.add(part.share(near, side).about(part.middle - origin));
        }
        let centre = all.first / all.volume;
        let second = all.second - outer(centre, centre) * all.volume;
        let size = self.parts.iter().map(|part| part.middle.distance(origin) + part.reach()).fold(0.0, f64::max);
        let centre = without_rounding(origin + without_rounding(centre, size), size);
        properties(all.volume, centre, second)
    }

    /// A lone capsule: two balls and a cylinder of one radius.
    fn capsule(&self) -> Option<MassProperties> {
        let [a, b, rod] = self.parts.as_slice() else { return None };
        let is_capsule = a.is_sphere() && b.is_sphere() && !rod.is_sphere() && rod.sides.is_none();
        if !is_capsule || a.radius != b.radius || a.radius != rod.radius {
            return None;
        }
        let ball = a.moments();
        let mut second = rod.moments().second + ball.second;
        // Each half of the ball has its centre 3/8 r beyond its end, so its second moment along the axis grows by h² + 2 h (3/8 r).
        let (h, r) = (rod.half, rod.radius);
        second += outer(rod.axis, rod.axis) * (ball.volume * h * (h + 0.75 * r));
        Some(properties(rod.moments().volume + ball.volume, rod.middle, second))
    }

    /// The other parts that may overlap a part.
    fn near(&self, number: usize) -> Vec<&Part> {
        let part = &self.parts[number];
        let is_near = |other: &&Part| other.middle.distance_squared(part.middle) < (other.reach() + part.reach()).powi(2);
        let others = self.parts.iter().enumerate().filter(|(other, _)| *other != number).map(|(_, other)| other);
        others.filter(is_near).collect()
    }
}

/// Reused memory for the integrals along a line.
#[derive(Default)]
struct Line {
    /// Where intervals begin (1) and end (-1).
    ends: Vec<(f64, f64)>,
}

impl Line {
    /// Integrals of (1 - 1/n) t^k for k = 0, 1, 2 along a line through a part, where n parts share the matter. `from` is relative to
    /// the middle of the part.
    fn lost(&mut self, part: &Part, near: &[&Part], from: DVec3) -> [f64; 3] {
        let point = part.middle + from;
        self.ends.clear();
        let Some([start, end]) = part.interval(point, part.axis) else { return [0.0; 3] };
        for other in near {
            let Some([a, b]) = other.interval(point, part.axis) else { continue };
            let (a, b) = (a.max(start), b.min(end));
            if a < b {
                self.ends.extend([(a, 1.0), (b, -1.0)]);
            }
        }
        self.ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut sums = [0.0; 3];
        let (mut count, mut at) = (1.0, start);
        for (end, change) in &self.ends {
            let share = 1.0 - 1.0 / count;
            for (sum, power) in sums.iter_mut().zip(1..) {
                *sum += share * (end.powi(power) - at.powi(power)) / f64::from(power);
            }
            count += change;
            at = *end;
        }
        sums
    }
}

impl Moments {
    fn add(&mut self, other: Self) {
        self.volume += other.volume;
        self.first += other.first;
        self.second += other.second;
    }

    /// The moments about the origin of matter whose moments about a place are these.
    fn about(&self, place: DVec3) -> Self {
        let mixed = outer(self.first, place);
        let second = self.second + mixed + mixed.transpose() + outer(place, place) * self.volume;
        Self { volume: self.volume, first: self.first + place * self.volume, second }
    }

    /// Removes matter on the line from + t direction, whose integrals of t^k are given.
    fn subtract_line(&mut self, from: DVec3, direction: DVec3, [zero, one, two]: [f64; 3]) {
        self.volume -= zero;
        self.first -= from * zero + direction * one;
        let mixed = outer(from, direction) * one;
        self.second -= outer(from, from) * zero + mixed + mixed.transpose() + outer(direction, direction) * two;
    }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// A vector whose components are 0 where they are rounding errors of lengths of a size.
fn without_rounding(vector: DVec3, size: f64) -> DVec3 {
    DVec3::select(vector.abs().cmplt(DVec3::splat(ROUNDING * size)), DVec3::ZERO, vector)
}

/// Mass properties at density 1 from the second moments about the centre.
fn properties(volume: f64, centre: DVec3, second: DMat3) -> MassProperties {
    let size = second.x_axis.x + second.y_axis.y + second.z_axis.z;
    let [x, y, z] = [second.x_axis, second.y_axis, second.z_axis].map(|column| without_rounding(column, size));
    let inertia = [y.y + z.z, x.x + z.z, x.x + y.y, -y.x, -z.x, -z.y];
    MassProperties { mass: volume, centre: centre.to_array(), inertia }
}
