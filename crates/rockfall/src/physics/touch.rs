//! The narrow phase: where two objects overlap (docs/physics sections 2.6 to 2.9), or how far they are apart (signed
//! geometry, section 2.10).

use glam::Vec3;

use crate::model::layout::BOX_FEATURES;
use crate::model::view::{BoxRecord, Object, RodRecord, TINY, View};
use crate::physics::geometry::{
    box_contains, box_edge, box_parameters, box_vertex, point_over_polygon, point_segment, segment_segment,
};
use crate::physics::motions::round;
pub(crate) use crate::physics::motions::{Motions, Touch, box_from, ends, origin_of};
use crate::physics::rod_polygon;
use crate::physics::side::side;

/// In the collision phase, overlaps up to this times the smaller radius count as rounding errors (docs/physics section 3.1).
pub(crate) const ROUNDING: f32 = 1e-5;

/// Returns the contact of two objects, or `None` when they do not overlap or never interact, whether or not their chains cover it. In the order sphere, rod, box,
/// polygon, the kind of A must not come after the kind of B. `feature` is the feature of a rod and a box.
pub(crate) fn overlapping(view: &View, id_a: u32, id_b: u32, feature: u32) -> Option<Touch> {
    let (a, b) = (view.object(id_a), view.object(id_b));
    if ignore(view, a, b) {
        return None;
    }
    let touch = match (a, b) {
        (Object::Rod(rod), Object::Cuboid(b)) => rod_box(view, view.rod(rod), &view.cuboid(b), feature),
        (Object::Rod(rod), Object::Polygon(b)) => rod_polygon::overlapping(view, view.rod(rod), &view.polygon(b), feature),
        _ => line(view, view, a, b, None).filter(|touch| touch.overlap > 0.0),
    }?;
    // A rod cannot move at a fixed end.
    let inverse_mass = side(view, a, touch.a).inverse_mass + side(view, b, touch.b).inverse_mass;
    (inverse_mass > 0.0).then_some(touch)
}

/// Returns the signed geometry of two objects that do not overlap, with a negative or zero overlap, or `None` when they have no
/// contact line or never interact. The arguments are those of [`overlapping`]. A rod has the nearer of edge and vertex of the feature
/// of a box.
pub(crate) fn touch_apart(view: &View, id_a: u32, id_b: u32, feature: u32) -> Option<Touch> {
    let (a, b) = (view.object(id_a), view.object(id_b));
    if ignore(view, a, b) {
        return None;
    }
    let touch = match (a, b) {
        (Object::Rod(rod), Object::Cuboid(cuboid)) => {
            let of = |feature| line(view, view, Object::Rod(rod), Object::Cuboid(cuboid), Some(feature));
            let vertex = if feature < 8 { of(Feature::Vertex(feature)) } else { None };
            match (of(Feature::Edge(feature)), vertex) {
                (Some(edge), Some(vertex)) if edge.overlap > vertex.overlap => edge,
                (edge, vertex) => vertex.or(edge)?,
            }
        }
        (Object::Rod(rod), Object::Polygon(polygon)) => {
            rod_polygon::line(view, view.rod(rod), &view.polygon(polygon), feature)?
        }
        _ => line(view, view, a, b, None)?,
    };
    let inverse_mass = side(view, a, touch.a).inverse_mass + side(view, b, touch.b).inverse_mass;
    (inverse_mass > 0.0 && touch.overlap <= 0.0).then_some(touch)
}

/// Whether a pair never interacts because of the rods that the objects share or because neither can move (docs/physics
/// section 1.3). Lists leave out the parts of rigid bodies that never touch.
pub(crate) fn ignore(view: &View, a: Object, b: Object) -> bool {
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

/// Whether the centre of a sphere is over a face of a box or polygon, and neither beside it nor inside the box. A triangle has a face on
/// both sides, a cone or ball has none.
pub(crate) fn is_over_face(view: &View, a: Object, b: Object) -> bool {
    match (a, b) {
        (Object::Sphere(sphere), Object::Cuboid(cuboid)) => {
            let t = box_parameters(&view.cuboid(cuboid), view.near_shape(b, view.precise(sphere)).high);
            t.to_array().into_iter().filter(|t| !(0.0..=1.0).contains(t)).count() == 1
        }
        (Object::Sphere(sphere), Object::Polygon(polygon)) => {
            let record = view.polygon(polygon);
            let (_, height, is_inside) = point_over_polygon(&record, view.near_shape(b, view.precise(sphere)).high);
            is_inside && (height >= 0.0 || record.is_triangle()) && !record.surface.is_round()
        }
        _ => false,
    }
}

/// The part of a static object that the other object of a contact touches. The contact keeps it at other positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    /// The edge of a box, or the feature of a polygon, that a rod touches.
    Edge(u32),
    /// The vertex of a box that a rod touches.
    Vertex(u32),
}

impl Feature {
    /// Returns the part of a box or polygon that a rod touches in the present state (docs/physics section 2.10). `None` for other pairs.
    /// `feature` is that of the list entry.
    pub(crate) fn of(view: &View, a: Object, b: Object, feature: u32) -> Option<Self> {
        match (a, b) {
            (Object::Rod(rod), Object::Cuboid(cuboid)) => Some(Self::of_box(view, rod, cuboid, feature)),
            (Object::Rod(_), Object::Polygon(_)) => Some(Self::Edge(feature)),
            _ => None,
        }
    }

    /// If the rod does not overlap the edge, the nearer of edge and vertex counts.
    fn of_box(view: &View, rod: u32, cuboid: u32, feature: u32) -> Self {
        let of = |feature| line(view, view, Object::Rod(rod), Object::Cuboid(cuboid), Some(feature));
        let (edge, vertex) = (Self::Edge(feature), Self::Vertex(feature));
        if feature >= 8 || rod_edge(view, view.rod(rod), &view.cuboid(cuboid), feature, true).is_some() {
            return edge;
        }
        match (of(edge), of(vertex)) {
            (Some(edge), Some(vertex)) if edge.overlap > vertex.overlap => Self::Edge(feature),
            (Some(_), None) => edge,
            _ => vertex,
        }
    }
}

/// Returns the signed geometry of two objects at the positions in `at`, or `None` when they have no contact line
/// (docs/physics section 2.10). `feature` is the part that a contact keeps.
pub(crate) fn line(view: &View, at: &impl Motions, a: Object, b: Object, feature: Option<Feature>) -> Option<Touch> {
    match (a, b, feature) {
        (Object::Sphere(a), Object::Sphere(b), _) => Some(at.spheres([a, b], [view.radius(a), view.radius(b)])),
        (Object::Sphere(a), Object::Rod(b), _) => sphere_rod(view, at, a, view.rod(b)),
        (Object::Rod(a), Object::Rod(b), _) => rod_rod(view, at, [a, b]),
        (Object::Sphere(a), Object::Cuboid(b), _) => Some(at.on_box(a, view.radius(a), &view.cuboid(b))),
        (Object::Sphere(a), Object::Polygon(b), _) => at.on_polygon(a, view.radius(a), &view.polygon(b)),
        (Object::Rod(a), Object::Cuboid(b), Some(Feature::Edge(edge))) => {
            rod_edge(at, view.rod(a), &view.cuboid(b), edge, false)
        }
        (Object::Rod(a), Object::Cuboid(b), Some(Feature::Vertex(vertex))) => {
            rod_vertex(at, view.rod(a), &view.cuboid(b), vertex, false)
        }
        (Object::Rod(a), Object::Polygon(b), Some(Feature::Edge(edge))) => {
            rod_polygon::line(at, view.rod(a), &view.polygon(b), edge)
        }
        _ => None,
    }
}

/// Returns the signed geometry of objects A and B in the present state, in which a list entry gives the feature.
pub(crate) fn present_line(view: &View, a: u32, b: u32, feature: u32) -> Option<Touch> {
    let (a, b) = (view.object(a), view.object(b));
    line(view, view, a, b, Feature::of(view, a, b, feature))
}

fn sphere_rod(view: &View, at: &impl Motions, sphere: u32, rod: RodRecord) -> Option<Touch> {
    let reach = view.radius(sphere) + rod.radius;
    let origin = origin_of(at, rod);
    let (parameter, d) = point_segment(at.seen_from(origin, sphere), ends(at, rod, origin), reach)?;
    Some(round(d, reach, Vec3::Y, 0.0, parameter))
}

fn rod_rod(view: &View, at: &impl Motions, rods: [u32; 2]) -> Option<Touch> {
    let [a, b] = rods.map(|rod| view.rod(rod));
    let reach = a.radius + b.radius;
    let origin = origin_of(at, a);
    let [of_a, of_b] = [ends(at, a, origin), ends(at, b, origin)];
    let pair = segment_segment(of_a, of_b, reach)?;
    Some(round(pair.d, reach, pair.normal.unwrap_or(Vec3::Y), pair.a, pair.b))
}

/// Returns the contact of a rod with feature f of a box: edge f, or, when no edge is hit, vertex f.
fn rod_box(view: &View, rod: RodRecord, cuboid: &BoxRecord, feature: u32) -> Option<Touch> {
    let origin = origin_of(view, rod);
    if is_beside(&box_from(view, cuboid, origin), ends(view, rod, origin), rod.radius) {
        return None;
    }
    let edge = |edge: u32| rod_edge(view, rod, cuboid, edge, true);
    if let Some(touch) = edge(feature) {
        return Some(touch);
    }
    if feature >= 8 || (0..BOX_FEATURES).any(|other| edge(other).is_some()) {
        return None;
    }
    rod_vertex(view, rod, cuboid, feature, true)
}

/// Whether a rod is outside one face of a box by more than its radius, with some room for rounding. Then it touches no edge.
/// This holds for most rods that have a box in their lists, with twelve entries per box.
fn is_beside(cuboid: &BoxRecord, ends: [Vec3; 2], radius: f32) -> bool {
    let [one, two] = ends.map(|end| box_parameters(cuboid, end));
    let slack = 1.001 * radius / Vec3::from_array(cuboid.edges.map(Vec3::length)) + 1e-4;
    one.max(two).cmplt(-slack).any() || one.min(two).cmpgt(1.0 + slack).any()
}

/// Returns the contact of a rod with an edge of a box. With `must_touch`, the distance must be less than the rod's radius.
fn rod_edge(at: &impl Motions, rod: RodRecord, cuboid: &BoxRecord, edge: u32, must_touch: bool) -> Option<Touch> {
    let origin = origin_of(at, rod);
    let (cuboid, [end1, end2]) = (&box_from(at, cuboid, origin), ends(at, rod, origin));
    let edge = box_edge(cuboid, edge);
    let pair = segment_segment([end1, end2], [edge.start, edge.end], rod.radius)?;
    let on_axis = end1 + pair.a * (end2 - end1);
    near_feature(cuboid, rod.radius, on_axis, pair.a, pair.d, edge.outward, must_touch)
}

/// Returns the contact of a rod with a vertex of a box. With `must_touch`, the distance must be less than the rod's radius.
fn rod_vertex(at: &impl Motions, rod: RodRecord, cuboid: &BoxRecord, vertex: u32, must_touch: bool) -> Option<Touch> {
    let origin = origin_of(at, rod);
    let (cuboid, [end1, end2]) = (&box_from(at, cuboid, origin), ends(at, rod, origin));
    let (vertex, outward) = box_vertex(cuboid, vertex);
    let (a, to_rod) = point_segment(vertex, [end1, end2], rod.radius)?;
    near_feature(cuboid, rod.radius, end1 + a * (end2 - end1), a, -to_rod, outward, must_touch)
}

/// Returns the contact at the point `on_axis` of a rod, with parameter `a`. `d` is the vector from there to the edge or vertex.
/// When `on_axis` is inside the box, the rod is pushed out.
fn near_feature(
    cuboid: &BoxRecord,
    radius: f32,
    on_axis: Vec3,
    a: f32,
    d: Vec3,
    outward: Vec3,
    must_touch: bool,
) -> Option<Touch> {
    let dd = d.length_squared();
    if dd <= TINY {
        return Some(Touch { normal: -outward, overlap: radius, a, b: 0.0 });
    }
    let distance = dd.sqrt();
    if must_touch && distance >= radius {
        return None;
    }
    let (normal, overlap) = if box_contains(cuboid, on_axis, distance) {
        (-d / distance, radius + distance)
    } else {
        (d / distance, radius - distance)
    };
    Some(Touch { normal, overlap, a, b: 0.0 })
}
