//! What a contact of a law with history begins with in a step (docs/physics.md section 4.11).

use glam::Vec3;

use crate::model::view::{Object, View};
use crate::physics::geometry::point_over_polygon;
use crate::physics::laws::contact::Spring;
use crate::physics::laws::history::{Histories, feature_bits};
use crate::physics::rigid_box::is_solid;
use crate::physics::sides::sides;
use crate::physics::surface::hides;
use crate::physics::touch::Touch;

/// Two spheres of a rigid body are neighbours if their centres are nearer than this part of the sum of their radii.
const NEIGHBOURS_WITHIN: f32 = 0.99;

/// The spring of a contact before the step: its own one, or that of a box or polygon which the new contact of a sphere hides, or
/// [`Spring::PASSAGE`], or the displacement of a neighbour in a rigid body.
pub(crate) fn spring_before(
    view: &View,
    histories: &Histories,
    [a, b]: [u32; 2],
    feature: u32,
    touch: &Touch,
) -> Option<Spring> {
    let own = histories.spring(view, a, b, feature);
    if own.as_ref().is_some_and(|spring| spring.overlap != 0.0) {
        return own;
    }
    let taken = || taken_shift(view, histories, [a, b], feature).map(|shift| Spring { shift, ..own.unwrap_or_default() });
    on_surface(view, histories, [a, b], touch).or_else(taken).or(own)
}

/// The spring of a box or polygon that the new contact of a sphere hides, or [`Spring::PASSAGE`].
fn on_surface(view: &View, histories: &Histories, [a, b]: [u32; 2], touch: &Touch) -> Option<Spring> {
    // A corner that a solid touches keeps its place on the wall.
    let is_ball = a < view.step.layout.spheres && !is_solid(view, view.object(a));
    if !is_ball || b < view.step.movers() || touch.overlap <= 0.0 {
        return None;
    }
    let (bits, movers, objects) = (feature_bits(view.step), view.step.movers(), view.step.objects());
    let springs = histories.springs(view.insertion_index(a)).map(|(key, spring)| (key >> bits, spring));
    let mut hidden = springs.filter(|(other, spring)| (movers..objects).contains(other) && *other != b && spring.overlap > 0.0);
    let goes_along = hidden.find(|(other, _)| hides(view, a, (b, touch), *other));
    goes_along.map(|(_, spring)| spring).or_else(|| comes_from_behind(view, [a, b], touch).then_some(Spring::PASSAGE))
}

/// The longest displacement of the contacts of neighbours in rigid bodies, each with the same other object.
fn taken_shift(view: &View, histories: &Histories, [a, b]: [u32; 2], feature: u32) -> Option<Vec3> {
    let of_a = neighbours(view, a).map(|sphere| ([sphere, b], 1.0));
    let of_b = neighbours(view, b).map(|sphere| ([sphere, a], -1.0));
    let shifts = of_a.chain(of_b).filter_map(|([sphere, other], sign)| {
        let (first, second) = view.ordered(sphere, other);
        let spring = histories.spring(view, first, second, feature).filter(|spring| spring.overlap > 0.0)?;
        Some(if first == sphere { sign * spring.shift } else { -sign * spring.shift })
    });
    let longer = |one: Vec3, other: Vec3| if other.length_squared() > one.length_squared() { other } else { one };
    shifts.reduce(longer).filter(|shift| *shift != Vec3::ZERO)
}

/// The spheres of the same rigid body that overlap a sphere. Spheres of boxes have none.
fn neighbours<'a>(view: &'a View, id: u32) -> impl Iterator<Item = u32> + use<'a> {
    let is_round = move |id: u32| id < view.step.layout.spheres && view.box_word(view.object(id)) == 0;
    let body = is_round(id).then(|| view.body_of_sphere(id)).flatten().map(|body| view.rigid_body(body));
    body.into_iter().flat_map(move |body| {
        let members = move || view.members(body).map(|(index, place)| (view.slot_of(index), place));
        let own = members().find(|(sphere, _)| *sphere == id).map_or(Vec3::ZERO, |(_, place)| place);
        members().map(move |(sphere, place)| (sphere, place - own)).filter_map(move |(sphere, apart)| {
            let most = NEIGHBOURS_WITHIN * (view.radius(sphere) + view.radius(id));
            (sphere != id && apart.length_squared() < most * most && is_round(sphere)).then_some(sphere)
        })
    })
}

/// Whether the centre of a sphere was behind the plane of a polygon one step ago, unless it is a triangle, which has two sides.
fn comes_from_behind(view: &View, [sphere, other]: [u32; 2], touch: &Touch) -> bool {
    let Object::Polygon(polygon) = view.object(other) else { return false };
    let record = view.polygon(polygon);
    let (normal, height) = if record.surface.is_round() {
        (-touch.normal, view.radius(sphere) - touch.overlap)
    } else {
        let (normal, height, _) = point_over_polygon(&record, view.near_shape(view.object(other), view.precise(sphere)).high);
        (normal, height)
    };
    let [own, wall] = sides(view, [sphere, other], touch);
    !record.is_triangle() && height - (own.velocity - wall.velocity).dot(normal) * view.step.constants.dt < 0.0
}
