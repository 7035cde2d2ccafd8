//! The narrow phase: where two objects overlap (physics.md sections 1 and 2).

use glam::Vec3;

use crate::cpu::contact::side;
use crate::cpu::geometry::{box_contains, box_edge, box_vertex, point_box, point_polygon, point_segment, segment_segment};
use crate::cpu::view::{BoxWords, Object, RodWords, TINY, View};
use crate::layout::BOX_FEATURES;

/// Where A and B overlap; A is the object of lower id.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Touch {
    /// Unit normal from A to B.
    pub(crate) normal: Vec3,
    /// Depth of the overlap, positive.
    pub(crate) overlap: f32,
    /// Parameter of the contact on A, if A is a rod.
    pub(crate) a: f32,
    /// Parameter of the contact on B, if B is a rod.
    pub(crate) b: f32,
}

/// The overlap of the objects `id_a < id_b`, or `None` where they do not overlap or ignore each other.
pub(crate) fn touch(view: &View, id_a: u32, id_b: u32, feature: u32) -> Option<Touch> {
    let (a, b) = (view.object(id_a), view.object(id_b));
    if ignore(view, a, b) {
        return None;
    }
    let touch = match (a, b) {
        (Object::Sphere(a), Object::Sphere(b)) => sphere_sphere(view, a, b),
        (Object::Sphere(a), Object::Rod(b)) => sphere_rod(view, a, view.rod(b)),
        (Object::Rod(a), Object::Rod(b)) => rod_rod(view, view.rod(a), view.rod(b)),
        (Object::Sphere(a), Object::Cuboid(b)) => sphere_box(view, a, &view.cuboid(b)),
        (Object::Sphere(a), Object::Polygon(b)) => sphere_polygon(view, a, b),
        (Object::Rod(a), Object::Cuboid(b)) => rod_box(view, view.rod(a), &view.cuboid(b), feature),
        _ => None,
    }?;
    // A rod that is touched right at its fixed end cannot give way there.
    let inverse_mass = side(view, a, touch.a).inverse_mass + side(view, b, touch.b).inverse_mass;
    (inverse_mass > 0.0).then_some(touch)
}

/// Nothing collides with itself, and two immovable things have nothing to say to each other.
fn ignore(view: &View, a: Object, b: Object) -> bool {
    if immovable(view, a) && immovable(view, b) {
        return true;
    }
    match (a, b) {
        (Object::Sphere(a), Object::Sphere(b)) => view.rods_of(a).any(|rod| {
            let rod = view.rod(rod);
            rod.length > 0.0 && rod.ends.contains(&b)
        }),
        (Object::Sphere(a), Object::Rod(b)) => view.rod(b).ends.contains(&a),
        (Object::Rod(a), Object::Rod(b)) => {
            let other = view.rod(b).ends;
            view.rod(a).ends.iter().any(|end| other.contains(end))
        }
        _ => false,
    }
}

fn immovable(view: &View, object: Object) -> bool {
    match object {
        Object::Sphere(sphere) => view.is_fixed(sphere),
        Object::Rod(rod) => view.rod(rod).ends.iter().all(|end| view.is_fixed(*end)),
        Object::Cuboid(_) | Object::Polygon(_) => true,
    }
}

fn ends(view: &View, rod: RodWords) -> (Vec3, Vec3) {
    (view.position(rod.ends[0]), view.position(rod.ends[1]))
}

/// The touch of two round things `d` apart, whose radii sum to `reach`.
fn round(d: Vec3, reach: f32, zero_normal: Vec3, a: f32, b: f32) -> Option<Touch> {
    let dd = d.length_squared();
    let (normal, distance) = if dd <= TINY { (zero_normal, 0.0) } else { (d / dd.sqrt(), dd.sqrt()) };
    let overlap = reach - distance;
    (overlap > 0.0).then_some(Touch { normal, overlap, a, b })
}

fn sphere_sphere(view: &View, a: u32, b: u32) -> Option<Touch> {
    let reach = view.radius(a) + view.radius(b);
    round(view.position(b) - view.position(a), reach, Vec3::Y, 0.0, 0.0)
}

fn sphere_rod(view: &View, sphere: u32, rod: RodWords) -> Option<Touch> {
    let (end1, end2) = ends(view, rod);
    let reach = view.radius(sphere) + rod.radius;
    let (parameter, d) = point_segment(view.position(sphere), [end1, end2], reach)?;
    round(d, reach, Vec3::Y, 0.0, parameter)
}

fn rod_rod(view: &View, a: RodWords, b: RodWords) -> Option<Touch> {
    let ((a1, a2), (b1, b2)) = (ends(view, a), ends(view, b));
    let reach = a.radius + b.radius;
    let pair = segment_segment([a1, a2], [b1, b2], reach)?;
    round(pair.d, reach, pair.normal.unwrap_or(Vec3::Y), pair.a, pair.b)
}

fn sphere_box(view: &View, sphere: u32, cuboid: &BoxWords) -> Option<Touch> {
    let (normal, distance) = point_box(cuboid, view.position(sphere), view.radius(sphere));
    let overlap = view.radius(sphere) - distance;
    (overlap > 0.0).then_some(Touch { normal, overlap, a: 0.0, b: 0.0 })
}

fn sphere_polygon(view: &View, sphere: u32, polygon: u32) -> Option<Touch> {
    let (face, height) = point_polygon(&view.polygon(polygon), view.position(sphere))?;
    let radius = view.radius(sphere);
    let hit = height >= 0.0 && height < radius;
    hit.then(|| Touch { normal: -face, overlap: radius - height, a: 0.0, b: 0.0 })
}

/// Feature f of a rod and a box: edge f, or, where no edge is hit, vertex f.
fn rod_box(view: &View, rod: RodWords, cuboid: &BoxWords, feature: u32) -> Option<Touch> {
    let (end1, end2) = ends(view, rod);
    let edge = |edge: u32| {
        let edge = box_edge(cuboid, edge);
        let pair = segment_segment([end1, end2], [edge.start, edge.end], rod.radius)?;
        near_feature(cuboid, rod.radius, end1 + pair.a * (end2 - end1), pair.a, pair.d, edge.outward)
    };
    if let Some(touch) = edge(feature) {
        return Some(touch);
    }
    if feature >= 8 || (0..BOX_FEATURES).any(|other| edge(other).is_some()) {
        return None;
    }
    let (vertex, outward) = box_vertex(cuboid, feature);
    let (a, to_rod) = point_segment(vertex, [end1, end2], rod.radius)?;
    near_feature(cuboid, rod.radius, end1 + a * (end2 - end1), a, -to_rod, outward)
}

/// A rod's point `on_axis` against a point of the box's edges, `d` away. Inside the box the rod is pushed on outward.
fn near_feature(cuboid: &BoxWords, radius: f32, on_axis: Vec3, a: f32, d: Vec3, outward: Vec3) -> Option<Touch> {
    let dd = d.length_squared();
    if dd <= TINY {
        return Some(Touch { normal: -outward, overlap: radius, a, b: 0.0 });
    }
    let distance = dd.sqrt();
    if distance >= radius {
        return None;
    }
    let (normal, overlap) = if box_contains(cuboid, on_axis, distance) {
        (-d / distance, radius + distance)
    } else {
        (d / distance, radius - distance)
    };
    Some(Touch { normal, overlap, a, b: 0.0 })
}
