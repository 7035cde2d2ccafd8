//! What a contact of a law with history begins with in a step (docs/physics section 4.11).

use crate::model::view::{Object, View};
use crate::physics::geometry::point_over_polygon;
use crate::physics::laws::contact::{Spring, Start};
use crate::physics::laws::history::{Histories, feature_bits};
use crate::physics::laws::shared::shared;
use crate::physics::sides::sides;
use crate::physics::surface::hides;
use crate::physics::touch::Touch;

/// What a contact begins with: its own spring, or that of a box or polygon which the new contact of a sphere hides, or
/// [`Spring::PASSAGE`]; and its share.
pub(crate) fn spring_before(view: &View, histories: &Histories, ids: [u32; 2], feature: u32, touch: &Touch) -> Start {
    let own = histories.spring(view, ids[0], ids[1], feature);
    let is_new = own.as_ref().is_none_or(|spring| spring.overlap == 0.0);
    let taken = if is_new { on_surface(view, histories, ids, touch) } else { None };
    let spring = taken.or(own);
    if spring.as_ref().is_some_and(Spring::is_passage) {
        return Start { spring, share: None };
    }
    match shared(view, histories, ids, feature, touch, spring) {
        Some((shift, share)) => {
            let fed = Spring { shift, ..spring.unwrap_or_default() };
            Start { spring: taken.or(Some(fed)), share: Some(share) }
        }
        None => Start { spring, share: None },
    }
}

/// The spring of a box or polygon that the new contact of a sphere hides, or [`Spring::PASSAGE`].
fn on_surface(view: &View, histories: &Histories, [a, b]: [u32; 2], touch: &Touch) -> Option<Spring> {
    if a >= view.step.layout.spheres || b < view.step.movers() || touch.overlap <= 0.0 {
        return None;
    }
    let (bits, movers, objects) = (feature_bits(view.step), view.step.movers(), view.step.objects());
    let springs = histories.springs(view.insertion_index(a)).map(|(key, spring)| (key >> bits, spring));
    let mut hidden = springs.filter(|(other, spring)| (movers..objects).contains(other) && *other != b && spring.overlap > 0.0);
    let goes_along = hidden.find(|(other, _)| hides(view, a, (b, touch), *other));
    goes_along.map(|(_, spring)| spring).or_else(|| comes_from_behind(view, [a, b], touch).then_some(Spring::PASSAGE))
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
