//! Cones, cylinders and balls that bodies touch (docs/physics section 2.17), in f64. A plane is a polygon without edges.

use glam::{DVec2, DVec3, Vec3};

use crate::model::layout::UNBOUNDED;
use crate::model::view::{PolygonRecord, TINY};
use crate::physics::rounding::{self, unrounded};
use crate::scene::{ConeAxis, Surface};

/// The half-plane through the axis of a cone that contains a point: unit vectors away from the axis and along it, and the segment that is
/// turned, in coordinates (distance from the axis, way along it).
struct Meridian {
    out: DVec3,
    along: DVec3,
    /// The point, from the start of the segment.
    place: DVec2,
    segment: DVec2,
    /// Unit normal of the segment, away from the axis.
    normal: DVec2,
}

impl Meridian {
    /// `t` leads from the start of the axis to the point.
    fn of(wall: &PolygonRecord, t: DVec3) -> Self {
        let ConeAxis { along, radii: [start, end], .. } = ConeAxis::of(wall.left, wall.right);
        let (length, along) = (along.length(), along.normalize());
        let way = t.dot(along);
        let across = t - way * along;
        let distance = across.length();
        let out = if distance > 0.0 { across / distance } else { wall.right.as_dvec3().normalize() };
        let segment = DVec2::new(end - start, length);
        let normal = DVec2::new(length, start - end) / segment.length();
        Self { out, along, place: DVec2::new(distance - start, way), segment, normal }
    }

    /// The parameter of the nearest point of the line through the segment.
    fn parameter(&self) -> f64 {
        self.place.dot(self.segment) / self.segment.length_squared()
    }

    /// A vector of the half-plane in the coordinates of the scene.
    fn in_space(&self, vector: DVec2) -> DVec3 {
        vector.x * self.out + vector.y * self.along
    }
}

/// 1 for a surface that is touched from outside, -1 from inside.
fn side(surface: Surface) -> f64 {
    if surface.is_inside() { -1.0 } else { 1.0 }
}

/// Returns the unit normal from a sphere to a cone or ball, and the distance of the sphere's centre from it. `None` behind the surface. `t` leads
/// from the corner to the centre.
pub(super) fn point_round(wall: &PolygonRecord, t: DVec3, radius: f32) -> Option<(Vec3, f64)> {
    let side = side(wall.surface);
    if matches!(wall.surface, Surface::Ball { .. }) {
        let height = side * (t.length() - wall.left.as_dvec3().length());
        return (height >= 0.0).then(|| ((-side * t.normalize_or(DVec3::Y)).as_vec3(), height));
    }
    let meridian = Meridian::of(wall, t);
    let height = side * meridian.place.dot(meridian.normal);
    let parameter = meridian.parameter();
    let face = || meridian.in_space(-side * meridian.normal).as_vec3();
    if height.is_nan() || height < 0.0 {
        return None;
    }
    if (-AT_END..=1.0 + AT_END).contains(&parameter) {
        return Some((face(), height));
    }
    let to_rim = meridian.in_space(parameter.clamp(0.0, 1.0) * meridian.segment - meridian.place);
    let squared = wall.left.length_squared().max(wall.right.length_squared());
    if unrounded(to_rim.as_vec3(), squared, radius) == Vec3::ZERO {
        return Some((face(), 0.0));
    }
    Some((to_rim.normalize().as_vec3(), to_rim.length()))
}

/// Returns the parameter of the point of a line that is nearest to a cone or ball from outside, `None` where there is none (docs/physics section
/// 2.19). `start` leads from the corner to the start of the line.
pub(super) fn lowest_point(wall: &PolygonRecord, start: DVec3, line: DVec3) -> Option<f64> {
    let squared = line.length_squared();
    if squared <= f64::from(TINY) {
        return None;
    }
    if matches!(wall.surface, Surface::Ball { .. }) {
        return Some(-line.dot(start) / squared);
    }
    let ConeAxis { along, radii: [wide, narrow], .. } = ConeAxis::of(wall.left, wall.right);
    let (height, unit) = (along.length(), along.normalize());
    let [from_axis, across] = [start, line].map(|vector| vector - vector.dot(unit) * unit);
    let q = across.length_squared();
    // The slope of the height along the axis, over that away from it.
    let t = -(wide - narrow) / height * line.dot(unit);
    if q <= 1e-8 * squared || q <= t * t {
        return None;
    }
    let nearest = -across.dot(from_axis) / q;
    let apart = (from_axis + nearest * across).length();
    Some(nearest + t * apart / (q * (q - t * t)).sqrt())
}

/// The parameter of the point of a cone that is nearest to a point, between 0 and 1 on its face. A ball has no ends.
pub(super) fn round_parameter(wall: &PolygonRecord, t: DVec3) -> f32 {
    if matches!(wall.surface, Surface::Ball { .. }) { 0.5 } else { Meridian::of(wall, t).parameter() as f32 }
}

/// A parameter that is beyond an end by at most this belongs to the segment.
const AT_END: f64 = rounding::AT_END as f64;

/// How far a point is from a cone, a ball or a plane, on any side. `t` leads from the corner to the point.
pub(crate) fn distance(wall: &PolygonRecord, t: DVec3) -> f64 {
    match wall.surface {
        Surface::Ball { .. } => (t.length() - wall.left.as_dvec3().length()).abs(),
        Surface::Cone { .. } => {
            let meridian = Meridian::of(wall, t);
            (meridian.parameter().clamp(0.0, 1.0) * meridian.segment - meridian.place).length()
        }
        _ => t.dot(wall.left.as_dvec3().cross(wall.right.as_dvec3()).normalize()).abs(),
    }
}

/// The least product of a unit vector with the vector from a place to a point of a smooth wall (docs/physics section 2.11).
pub(super) fn front(wall: &PolygonRecord, place: Vec3, n: Vec3, one_normal: f32) -> f32 {
    let from_place = wall.corner - place;
    match wall.surface {
        Surface::Ball { .. } => from_place.dot(n) - wall.left.length(),
        Surface::Cone { .. } => {
            let ConeAxis { along, radii, .. } = ConeAxis::of(wall.left, wall.right);
            let rise = n.as_dvec3().dot(along) / along.length();
            let reach = (1.0 - rise * rise).max(0.0).sqrt();
            let ends = [DVec3::ZERO, along].map(|end| (from_place.as_dvec3() + end).dot(n.as_dvec3()));
            (ends[0] - radii[0] * reach).min(ends[1] - radii[1] * reach) as f32
        }
        _ => {
            let cosine = wall.left.cross(wall.right).normalize().dot(n).abs();
            if cosine >= one_normal { from_place.dot(n) } else { -f32::INFINITY }
        }
    }
}

/// Bounds of a smooth wall. Those of a plane are its corner: [`unbounded`] completes them.
pub(super) fn hull_of_smooth(wall: &PolygonRecord) -> (Vec3, Vec3) {
    let PolygonRecord { corner, left, right, surface } = *wall;
    match surface {
        Surface::Ball { .. } => (corner - left.length(), corner + left.length()),
        Surface::Cone { .. } => {
            let (min, max) = ConeAxis::of(left, right).bounds();
            (corner + min, corner + max)
        }
        _ => (corner, corner),
    }
}

/// Bounds without ends for a plane, except along an axis of the coordinates that is its normal, if it does not move.
pub(crate) fn unbounded(wall: &PolygonRecord, moves: bool, (min, max): (Vec3, Vec3)) -> (Vec3, Vec3) {
    if wall.surface != Surface::Plane {
        return (min, max);
    }
    let normal = wall.left.cross(wall.right);
    let axes = [0, 1, 2].map(|axis| normal[axis] != 0.0);
    let is_axis = axes.iter().filter(|differs| **differs).count() == 1;
    let is_open = |axis: usize| moves || !(is_axis && axes[axis]);
    let bound =
        |bounds: Vec3, open: f32| Vec3::from_array([0, 1, 2].map(|axis| if is_open(axis) { open } else { bounds[axis] }));
    (bound(min, -UNBOUNDED), bound(max, UNBOUNDED))
}
