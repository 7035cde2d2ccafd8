//! Bounds for the motion of a sphere within some steps.
//!
//! The bound is a ball. Its centre is ahead of the sphere: where the sphere will be after `lead` steps at its present velocity.
//! A ball around that point can be smaller than one around the present position.

use glam::{Vec3, Vec4};

use crate::model::layout::{FLAG_SHEARED, ROUNDING_SLACK};
use crate::model::period::Periods;
use crate::model::step::{Aabb, Step};
use crate::model::view::View;

/// Most that the device adds to the margin of AABBs where it repeats a step, in units of 0.02 of that length.
pub(crate) const MOST_OF_REPEAT: f32 = 10.0;

/// What is first added to the margin of AABBs when a body left its AABB by `escape`, both in units of 0.02 of that length. It is small, because it
/// enlarges all AABBs.
pub(crate) fn margin_for_escape(escape: f32) -> f32 {
    1.25 * escape + 1.0
}

/// Returns the position of a sphere after `lead` steps at constant velocity. `motion` is its velocity and inverse mass. The
/// result is `position` for a fixed sphere and for a displacement of 1e30 or more.
pub(crate) fn position_ahead(step: &Step, position: Vec3, motion: Vec4) -> Vec3 {
    let displacement = motion.truncate() * (step.lists.lead * step.constants.dt);
    let is_usable = motion.w > 0.0 && displacement.abs().max_element() < 1e30;
    if is_usable { position + displacement } else { position }
}

/// Returns a bound for the distance of a sphere, within `steps` steps, from the point that [`position_ahead`] returns. It
/// includes some room for acceleration, which grows with the number of steps.
pub(crate) fn travel_bound(step: &Step, velocity: Vec3, unit: f32, steps: f32) -> f32 {
    (steps - step.lists.lead) * (1.05 * velocity.length() * step.constants.dt) + (0.05 * steps - 0.03) * unit
}

/// Returns the distance from the point that [`position_ahead`] returns to the position of a sphere before the last step, taken as
/// straight. Where contacts that begin and end within a step are handled, lists hold the pairs of this path too.
pub(crate) fn trail(step: &Step, velocity: Vec3, unit: f32) -> f32 {
    1.001 * (step.lists.lead + 1.0) * step.constants.dt * velocity.length() + 0.02 * unit
}

/// Returns how far a moving sphere is outside the ball that its AABB encloses, in units of 0.02 of its margin length; 0 when it is
/// inside.
pub(crate) fn escape_ratio(view: &View, aabbs: &[Aabb], sphere: u32) -> f32 {
    if view.is_fixed(sphere) { 0.0 } else { outside(view, aabbs, sphere, view.position(sphere)) }
}

/// Like [`escape_ratio`], for any sphere, with its centre at this place.
pub(crate) fn outside(view: &View, aabbs: &[Aabb], sphere: u32, centre: Vec3) -> f32 {
    let (step, radius) = (view.step, view.radius(sphere));
    let out = distance_outside(step, &aabbs[sphere as usize], centre, radius + step.layout.neck * radius);
    if out <= 0.0 { 0.0 } else { (out / (0.02 * radius)).clamp(1e-3, 1e30) }
}

/// Whether a moving sphere at `centre` with `velocity` may leave the ball that its AABB encloses before the next opportunity to
/// rebuild lists.
pub(crate) fn needs_rebuild(view: &View, aabbs: &[Aabb], sphere: u32, centre: Vec3, velocity: Vec3) -> bool {
    let (step, radius) = (view.step, view.radius(sphere));
    if step.constants.flags & FLAG_SHEARED != 0 {
        // Images pass each other however slowly bodies move.
        return true;
    }
    let middle = position_ahead(step, centre, velocity.extend(view.inverse_mass(sphere)));
    let way = travel_bound(step, velocity, radius, step.lists.list_interval);
    let reach = radius + step.layout.neck * radius + way;
    !view.is_fixed(sphere) && distance_outside(step, &aabbs[sphere as usize], middle, reach) > 0.0
}

/// Returns how far a ball extends beyond the ball that an AABB encloses; not positive when it is inside. The ball must be
/// inside by more than the rounding errors far from the origin. In periodic scenes, the nearest image of the ball counts. In sheared ones
/// the images of other bodies may have come nearer by what they slide in a step.
fn distance_outside(step: &Step, aabb: &Aabb, centre: Vec3, radius: f32) -> f32 {
    let (min, max) = (Vec3::from_array(aabb.min), Vec3::from_array(aabb.max));
    let (middle, room) = (0.5 * min + 0.5 * max, (0.5 * max - 0.5 * min).min_element());
    // The AABB is unbounded and has no centre.
    if room > 1e37 {
        return -1.0;
    }
    let far = min.abs().max(max.abs()).max_element();
    let (apart, far) = match Periods::of(step) {
        None => (centre.distance(middle), far),
        Some(periods) => {
            let apart = periods.nearest((centre - middle).as_dvec3());
            (apart.as_vec3().length() + periods.slide_in(step.constants.dt), far.max(centre.abs().max_element()))
        }
    };
    apart + radius - room + ROUNDING_SLACK * far
}
