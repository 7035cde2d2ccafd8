//! Where a sphere may be within some steps: in a ball about the place that it comes to in a part of the first one, if nothing
//! happens. Forwards and backwards that ball need not reach as far as one about the sphere itself.

use glam::{Vec3, Vec4};

use crate::model::step::{Aabb, Step};
use crate::model::view::View;

/// The place that a sphere of this position, velocity and inverse mass comes to; of what cannot move, or is faster than all
/// measure, where it is.
pub(crate) fn place_ahead(step: &Step, position: Vec3, motion: Vec4) -> Vec3 {
    let way = motion.truncate() * (step.lead * step.dt);
    let known = motion.w > 0.0 && way.abs().max_element() < 1e30;
    if known { position + way } else { position }
}

/// How much further it comes in each of so many steps where it goes on accelerating as in its last step of RK4: a dt² / 2. These were
/// its velocities in stage states 3 and 4 then, v + dt a / 2 and v + dt a. What is beyond all measure tells nothing.
pub(crate) fn may_gain(step: &Step, third: Vec3, fourth: Vec3, steps: f32) -> f32 {
    let gain = steps * step.dt * fourth.distance(third);
    if gain < 1e30 { gain } else { 0.0 }
}

/// How far it may come from there in so many steps, with a little room for what accelerates, the more the longer it may do so.
pub(crate) fn may_travel(step: &Step, velocity: Vec3, radius: f32, steps: f32) -> f32 {
    (steps - step.lead) * (1.05 * velocity.length() * step.dt) + (0.05 * steps - 0.03) * radius
}

/// How far, in 0.02 r, a moving sphere is out of the ball that its list was made for; 0: it is inside.
pub(crate) fn escape_ratio(view: &View, aabbs: &[Aabb], sphere: u32) -> f32 {
    if view.is_fixed(sphere) { 0.0 } else { outside(&aabbs[sphere as usize], view.position(sphere), view.radius(sphere)) }
}

/// The same for a ball at a place where it may come to be.
pub(crate) fn outside(aabb: &Aabb, centre: Vec3, radius: f32) -> f32 {
    let out = reach_out(aabb, centre, radius);
    if out <= 0.0 { 0.0 } else { (out / (0.02 * radius)).clamp(1e-3, 1e30) }
}

/// Whether a moving sphere, come to be here and so fast, may be out of the ball that its AABB encloses within the steps that lists
/// have to last for.
pub(crate) fn needs_rebuild(view: &View, aabbs: &[Aabb], sphere: u32, centre: Vec3, velocity: Vec3) -> bool {
    let (step, radius) = (view.step, view.radius(sphere));
    let middle = place_ahead(step, centre, velocity.extend(view.inverse_mass(sphere)));
    let reach = radius + may_travel(step, velocity, radius, step.list_interval);
    !view.is_fixed(sphere) && reach_out(&aabbs[sphere as usize], middle, reach) > 0.0
}

/// How far a ball reaches out of the ball that an AABB encloses; not positive: it is inside. Rounding far from the origin is
/// forgiven: lists are made with more slack than that.
fn reach_out(aabb: &Aabb, centre: Vec3, radius: f32) -> f32 {
    let (min, max) = (Vec3::from_array(aabb.min) * 0.5, Vec3::from_array(aabb.max) * 0.5);
    let (middle, room) = (min + max, (max - min).min_element());
    // Without bounds; it has no middle.
    if room > 1e37 {
        return -1.0;
    }
    centre.distance(middle) + radius - room - 2.5e-7 * middle.abs().max_element()
}
