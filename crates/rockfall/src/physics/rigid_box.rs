//! Contacts of boxes of rigid bodies (docs/physics.md section 2.16).

use glam::Vec3;

use crate::fine::Fine;
use crate::model::view::{BodyBox, Object, PartOfBox, TINY, View};
use crate::physics::corners;
use crate::physics::geometry::SegmentPair;
use crate::physics::motions::{Motions, Touch};
use crate::rotate::{back, rotated};

/// Length over which an edge gives way to the vertices at its ends, in rounding radii.
const TAPER: f32 = 4.0;
/// Sine of the angle below which parallel edges give way to the vertices.
const PARALLEL: f32 = 0.1;

/// Whether two objects never touch because of the rigid bodies that they are parts of. Lists leave such pairs out.
pub(crate) fn never_meet(view: &View, a: u32, b: u32) -> bool {
    if view.step.layout.rigid_bodies == 0 {
        return false;
    }
    let (a, b) = (view.object(a), view.object(b));
    view.body_of(a).is_some_and(|body| view.body_of(b) == Some(body)) || is_left_to_others(view, a, b)
}

/// Whether a pair does not interact because other parts of its boxes do: solids touch spheres that are not solids; vertices also rods that
/// are not edges; edges all rods. Vertices and edges touch walls.
fn is_left_to_others(view: &View, a: Object, b: Object) -> bool {
    if view.step.layout.rigid_parts_at == 0 {
        return false;
    }
    let [one, other] = [a, b].map(|object| view.part_of_box(object));
    let are_spheres = matches!((a, b), (Object::Sphere(_), Object::Sphere(_)));
    match [one, other].iter().filter(|part| **part == Some(PartOfBox::Solid)).count() {
        0 => match (a, b) {
            (Object::Sphere(_), Object::Sphere(_)) => one.is_some() || other.is_some(),
            (Object::Sphere(_), Object::Rod(_)) => other.is_some(),
            (Object::Rod(_), Object::Sphere(_)) => one.is_some(),
            _ => false,
        },
        // A solid also meets the corners of walls.
        1 => !are_spheres && !matches!(b, Object::Cuboid(_) | Object::Polygon(_)),
        _ => true,
    }
}

/// Whether an object stands for the solid of a box.
pub(crate) fn is_solid(view: &View, object: Object) -> bool {
    view.part_of_box(object) == Some(PartOfBox::Solid)
}

/// Whether one of two objects is a part of a box.
pub(crate) fn has_box(view: &View, a: Object, b: Object) -> bool {
    [a, b].into_iter().any(|object| view.part_of_box(object).is_some())
}

/// The contact of two spheres if one of them stands for the solid of a box.
pub(crate) fn touch_solid(view: &View, at: &impl Motions, [a, b]: [u32; 2]) -> Option<Touch> {
    let (hub, ball, is_a) = match [a, b].map(|sphere| is_solid(view, Object::Sphere(sphere))) {
        [true, false] => (a, b, true),
        [false, true] => (b, a, false),
        _ => return None,
    };
    let body_box = view.box_of(Object::Sphere(hub))?;
    let (outward, overlap) = solid_and_ball(&body_box, at.between(hub, ball), view.radius(ball));
    Some(Touch { normal: if is_a { outward } else { -outward }, overlap, a: 0.0, b: 0.0 })
}

/// The normal from the solid of a box to a ball, and the overlap. `place` is the centre of the ball from that of the box.
pub(crate) fn solid_and_ball(body_box: &BodyBox, place: Vec3, radius: f32) -> (Vec3, f32) {
    let (outward, distance) = from_core(body_box, place);
    (outward, radius + body_box.radius - distance)
}

/// The contact of the solid of a box with a corner of a wall, also where they are apart; `None` for other objects. The parameter on the
/// wall is the number of the corner.
pub(crate) fn touch_corner(view: &View, solid: Object, wall: Object, corner: u32) -> Option<Touch> {
    let Object::Sphere(hub) = solid else { return None };
    if !is_solid(view, solid) {
        return None;
    }
    let body_box = view.box_of(solid)?;
    let (normal, overlap) = solid_and_ball(&body_box, corners::seen(view, hub, wall, corner)?, 0.0);
    Some(Touch { normal, overlap, a: 0.0, b: corner as f32 })
}

/// The unit vector from the core of a box to a place, which is relative to its centre, and the distance: negative inside.
fn from_core(body_box: &BodyBox, place: Vec3) -> (Vec3, f32) {
    let local = rotated(back(body_box.turn), place);
    let gap = local - local.clamp(-body_box.half, body_box.half);
    let squared = gap.length_squared();
    if squared > TINY {
        let distance = squared.sqrt();
        return (rotated(body_box.turn, gap / distance), distance);
    }
    let depth = body_box.half - local.abs();
    let axis = (1..3).fold(0, |least, axis| if depth[axis] < depth[least] { axis } else { least });
    let outward = if local[axis] < 0.0 { -Vec3::AXES[axis] } else { Vec3::AXES[axis] };
    (rotated(body_box.turn, outward), -depth[axis])
}

/// The vector from the centre of a solid to that of the sphere, or to the corner of the wall, that touches it: a point of the line on which
/// the normal force acts. `None` for other objects.
pub(crate) fn toucher(view: &View, object: Object, other: Object, touch: &Touch) -> Option<Vec3> {
    let Object::Sphere(hub) = object else { return None };
    match other {
        _ if !is_solid(view, object) => None,
        Object::Sphere(ball) => Some(view.between(hub, ball)),
        wall => corners::seen(view, hub, wall, touch.b as u32),
    }
}

/// Where a solid is touched: the point of its core from its centre, and the rounding radius. `None` for other objects.
pub(crate) fn core_point(view: &View, object: Object, other: Object, touch: &Touch) -> Option<(Vec3, f32)> {
    let place = toucher(view, object, other, touch)?;
    let radius = view.box_of(object)?.radius;
    let of_other = if let Object::Sphere(ball) = other { view.radius(ball) } else { 0.0 };
    let outward = if touch.normal.dot(place) < 0.0 { -touch.normal } else { touch.normal };
    Some((place - (of_other + radius - touch.overlap) * outward, radius))
}

/// The contact of two rods of which at least one is an edge of a box. `pair` has the closest points, `sine` is that of their angle.
pub(crate) fn touch_edges(view: &View, at: &impl Motions, rods: [u32; 2], pair: &SegmentPair, sine: f32) -> Option<Touch> {
    let [one, two] = rods.map(|rod| view.rod(rod));
    let thin = |rod: u32, parameter: f32| {
        let bar = view.rod(rod);
        let length = view.between(bar.ends[0], bar.ends[1]).length();
        (parameter.min(1.0 - parameter) * length / (TAPER * bar.radius)).clamp(0.0, 1.0)
    };
    let share = (sine / PARALLEL).min(1.0) * thin(rods[0], pair.a).min(thin(rods[1], pair.b));
    let squared = pair.d.length_squared();
    let (normal, distance) = if squared <= TINY { (pair.normal?, 0.0) } else { (pair.d / squared.sqrt(), squared.sqrt()) };
    // Positive where the normal leaves the first box, and enters the second one.
    let [leaves, enters] = [outward(view, at, rods[0]), outward(view, at, rods[1])].map(|out| out.map(|out| out.dot(normal)));
    let reach = one.radius + two.radius;
    if distance >= reach {
        return Some(Touch { normal, overlap: reach - distance, a: pair.a, b: pair.b });
    }
    let is_passed = leaves.is_none_or(|out| out < 0.0) && enters.is_none_or(|out| out > 0.0);
    if is_passed {
        return Some(Touch { normal: -normal, overlap: share * (reach + distance), a: pair.a, b: pair.b });
    }
    if leaves.is_some_and(|out| out < 0.0) || enters.is_some_and(|out| out > 0.0) {
        return None;
    }
    Some(Touch { normal, overlap: share * (reach - distance), a: pair.a, b: pair.b })
}

/// The vector from the centre of the box to the middle of an edge.
fn outward(view: &View, at: &impl Motions, rod: u32) -> Option<Vec3> {
    let body_box = view.box_of(Object::Rod(rod))?;
    let [one, two] = view.rod(rod).ends;
    let middle = at.position(one) + 0.5 * at.between(one, two);
    Some(at.near(body_box.centre.as_dvec3(), Fine { high: middle, low: Vec3::ZERO }).high - body_box.centre)
}
