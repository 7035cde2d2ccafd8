//! Which contacts of spheres and rods other parts of their chains cover (docs/physics section 2.13).

use glam::Vec3;

use crate::model::layout::GROUP_MASK;
use crate::model::view::{Object, RodRecord, TINY, View};
use crate::physics::geometry::AT_END;
use crate::physics::touch::{Touch, ignore, line, overlapping};

/// Where the contact of two rods is looked for before one of them covers the contact of an end sphere: up to this part of its length
/// from that sphere.
const NEAR_END: f32 = 1e-4;
/// The cosine of 0.01 rad. A chain that bends by less is straight.
const STRAIGHT: f32 = 0.999_95;
/// Factor on a squared radius. A sphere as thick as its rod is inside of it, whatever is rounded.
const INSIDE: f32 = 1.000_001;

/// A sphere or a rod, with the parameter of the contact on a rod.
#[derive(Clone, Copy)]
struct Part {
    object: Object,
    parameter: f32,
}

/// Returns the contact of two objects, or `None` when they do not overlap, never interact, or other parts of their chains cover it. In
/// the order sphere, rod, box, polygon, the kind of A must not come after the kind of B. `feature` is the feature of a rod and a box.
pub(crate) fn touch(view: &View, id_a: u32, id_b: u32, feature: u32) -> Option<Touch> {
    let (a, b) = (view.object(id_a), view.object(id_b));
    overlapping(view, id_a, id_b, feature).filter(|touch| !is_covered(view, a, b, touch))
}

/// Whether another part of its chain covers the contact of two spheres or rods on one side. `false` for other objects.
pub(crate) fn is_covered(view: &View, a: Object, b: Object, touch: &Touch) -> bool {
    if view.step.layout.rods == 0 {
        return false;
    }
    let (a, b) = (Part { object: a, parameter: touch.a }, Part { object: b, parameter: touch.b });
    is_covered_on(view, a, b, touch.normal) || is_covered_on(view, b, a, -touch.normal)
}

/// The same for the side `own` of the contact. `normal` points from it to the other one.
fn is_covered_on(view: &View, own: Part, other: Part, normal: Vec3) -> bool {
    if matches!(other.object, Object::Cuboid(_) | Object::Polygon(_)) {
        return false;
    }
    match own.object {
        Object::Sphere(sphere) => view.rods_of(sphere).any(|rod| sphere_is_inside(view, sphere, rod, other, normal)),
        Object::Rod(rod) => {
            let bar = view.rod(rod);
            let length = view.between(bar.ends[0], bar.ends[1]).length();
            [own.parameter, 1.0 - own.parameter].into_iter().zip(bar.ends).any(|(part, end)| {
                is_inside_sphere(view, part * length, bar.radius, end, other) || is_beyond_bend(view, rod, end, other)
            })
        }
        Object::Cuboid(_) | Object::Polygon(_) => false,
    }
}

/// The vector from the centre of a sphere to that of another one, or to the point of a rod.
fn to_part(view: &View, sphere: u32, part: Part) -> Vec3 {
    match part.object {
        Object::Sphere(other) => view.between(sphere, other),
        Object::Rod(rod) => {
            let [one, two] = view.rod(rod).ends;
            view.between(sphere, one) + part.parameter * view.between(one, two)
        }
        Object::Cuboid(_) | Object::Polygon(_) => Vec3::ZERO,
    }
}

/// Whether a part of a chain may touch the other object of a contact itself.
fn may_touch(view: &View, part: Object, other: Object) -> bool {
    let tag = |object| {
        view.tag(match object {
            Object::Sphere(sphere) => sphere,
            Object::Rod(rod) => view.step.layout.spheres + rod,
            Object::Cuboid(_) | Object::Polygon(_) => return 0,
        }) & GROUP_MASK
    };
    tag(part) == tag(other) && !ignore(view, part, other) && !ignore(view, other, part)
}

/// Whether the contact point of a sphere is inside a rod that ends in it.
fn sphere_is_inside(view: &View, sphere: u32, rod: u32, other: Part, normal: Vec3) -> bool {
    let RodRecord { ends: [one, two], radius, .. } = view.rod(rod);
    let axis = view.between(one, two);
    let squared = axis.length_squared();
    if squared <= TINY || !may_touch(view, Object::Rod(rod), other.object) {
        return false;
    }
    // From the middle, towards the sphere: the same parameter and the same limit as in the contact of a sphere and a rod.
    let place = axis.dot(to_part(view, one, other)) / squared - 0.5;
    let towards = if sphere == one { -place } else { place };
    let (along, own) = (normal.dot(axis), view.radius(sphere));
    if towards > 0.5 + AT_END || own * own * (1.0 - along * along / squared) > INSIDE * radius * radius {
        return false;
    }
    match other.object {
        Object::Rod(bar) if towards >= 0.5 - NEAR_END => {
            let (first, second) = if rod < bar { (rod, bar) } else { (bar, rod) };
            line(view, view, Object::Rod(first), Object::Rod(second), None).is_some_and(|touch| touch.overlap > 0.0)
        }
        _ => true,
    }
}

/// Whether the contact point of a rod, at a distance from an end along its axis, is inside the sphere of that end.
fn is_inside_sphere(view: &View, distance: f32, radius: f32, end: u32, other: Part) -> bool {
    let own = view.radius(end);
    own * own > distance * distance + radius * radius && may_touch(view, Object::Sphere(end), other.object)
}

/// Whether the chain goes on straight at an end of a rod, and the other object is beside the next rod.
fn is_beyond_bend(view: &View, rod: u32, end: u32, other: Part) -> bool {
    let from_end = |rod: u32| {
        let [one, two] = view.rod(rod).ends;
        view.between(end, if one == end { two } else { one }).normalize_or_zero()
    };
    view.rods_of(end).filter(|next| *next != rod).any(|next| {
        let (own, their) = (from_end(rod), from_end(next));
        if -own.dot(their) < STRAIGHT || !may_touch(view, Object::Rod(next), other.object) {
            return false;
        }
        let side = to_part(view, end, other).dot(own - their);
        side < 0.0 || (side == 0.0 && next < rod)
    })
}
