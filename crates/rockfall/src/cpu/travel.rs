//! Where a sphere may be within some steps: in a ball about the place that it comes to in a part of the first one, if nothing
//! happens. Forwards and backwards that ball need not reach as far as one about the sphere itself.

use glam::{Vec3, Vec4};

use crate::layout::Step;

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
