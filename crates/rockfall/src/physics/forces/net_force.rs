//! The net force on a sphere and on the ends of a rod (docs/physics.md section 4).

use glam::{Vec3, Vec4};

use crate::model::counters::Tally;
use crate::model::lanes::first_lanes;
use crate::model::layout::{FLAG_CONTINUOUS, KIND_FORCE, KIND_ROD, KIND_SPRING, KIND_TETHER, LAW_THESIS};
use crate::model::lists::{Entry, Lists};
use crate::model::view::{Attachment, TINY, View};
use crate::physics::balls::{Ball, Meeting};
use crate::physics::contact::{ContactForce, contact_force, contact_forces};
use crate::physics::touch::touch;

/// Force and torque on one sphere or rod.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Load {
    pub(crate) force: Vec3,
    pub(crate) torque: Vec3,
}

/// Calls `take` for every contact of a mover, in the order of its list, starting at entry `from`. The arguments are the load on
/// the mover and, if it is a rod, the parameter of the contact on it. `tally` counts the contacts in which the mover is A.
fn each_contact(
    view: &View,
    lists: &Lists,
    mover: u32,
    from: u32,
    mut tally: Option<&mut Tally>,
    mut take: impl FnMut(Load, f32),
) {
    let (count, list) = lists.list(mover);
    for entry in (from..count).map(list) {
        let (id_a, id_b) = view.ordered(mover, entry.id());
        let Some(touch) = touch(view, id_a, id_b, entry.feature()) else {
            continue;
        };
        let ContactForce { force, torque_a, torque_b } = contact_force(view, id_a, id_b, &touch);
        if mover == id_a {
            if let Some(tally) = tally.as_deref_mut() {
                tally.count_contact(touch.overlap);
            }
            take(Load { force, torque: torque_a }, touch.a);
        } else {
            take(Load { force: -force, torque: torque_b }, touch.b);
        }
    }
}

/// Adds the loads of up to four contacts of a sphere with other spheres, in their order, to `force` and `torque`. Contacts
/// without an overlap add 0. There are no branches, because processors would often mispredict which pairs overlap.
#[inline]
fn add_ball_loads(ball: &Ball, others: &[Entry], tally: Option<&mut Tally>, [force, torque]: &mut [Vec4; 2]) {
    let Meeting { a, b, touches } = ball.meet(others);
    let loads = contact_forces(ball.view.step, &a, &b, &touches, &ball.surfaces(others));
    let mut touch = touches.overlap.cmpgt(Vec4::ZERO) & first_lanes(others.len());
    if ball.view.step.flags & FLAG_CONTINUOUS != 0 {
        touch &= ball.have_lasted(others);
    }
    *force = loads.force.or_zero(touch).add_lanes_to(*force);
    *torque = loads.torque_a.or_zero(touch).add_lanes_to(*torque);
    if let Some(tally) = tally {
        let overlaps = others.iter().zip(touches.overlap.to_array());
        for (_, overlap) in overlaps.filter(|(other, overlap)| *overlap > 0.0 && ball.is_first(other.id())) {
            tally.count_contact(overlap);
        }
    }
}

/// Returns the loads on both ends of a rod. Each contact is evaluated once, and its load is shared by 1 - a and a.
pub(crate) fn rod_loads(view: &View, lists: &Lists, rod: u32, tally: Option<&mut Tally>) -> [Load; 2] {
    let mut ends = [Load::default(); 2];
    each_contact(view, lists, view.step.spheres + rod, 0, tally, |load, parameter| {
        for (end, share) in ends.iter_mut().zip([1.0 - parameter, parameter]) {
            end.force += share * load.force;
            end.torque += share * load.torque;
        }
    });
    ends
}

/// Returns the load of the contacts of a sphere.
#[inline]
pub(crate) fn contact_load(view: &View, lists: &Lists, sphere: u32, mut tally: Option<&mut Tally>) -> Load {
    let (count, list) = lists.list(sphere);
    if count == 0 {
        return Load::default();
    }
    let mut sums = [Vec4::ZERO; 2];
    let done = Ball::new(view, sphere).map_or(0, |ball| {
        ball.for_each_near(count, list, |others| add_ball_loads(&ball, others, tally.as_deref_mut(), &mut sums))
    });
    let [force, torque] = sums.map(Vec4::truncate);
    let mut total = Load { force, torque };
    each_contact(view, lists, sphere, done, tally, |load, _| {
        total.force += load.force;
        total.torque += load.torque;
    });
    total
}

/// Returns the load on a sphere: contacts, then everything attached to it. Body forces are not included. `wrenches` are the
/// results of `rod_forces` or `law_forces`.
pub(crate) fn sphere_load(view: &View, lists: &Lists, wrenches: &[Vec4], sphere: u32, tally: Option<&mut Tally>) -> Load {
    let mut total = if view.step.law == LAW_THESIS {
        contact_load(view, lists, sphere, tally)
    } else {
        let at = (4 * view.step.rods + 2 * sphere) as usize;
        Load { force: wrenches[at].truncate(), torque: wrenches[at + 1].truncate() }
    };
    for attachment in view.attachments(sphere) {
        match attachment.kind {
            KIND_ROD => {
                let end = usize::from(view.rod(attachment.index).ends[1] == sphere);
                let at = 4 * attachment.index as usize + 2 * end;
                total.force += wrenches[at].truncate();
                total.torque += wrenches[at + 1].truncate();
            }
            KIND_SPRING => total.force += spring_force(view, attachment.index, sphere),
            KIND_TETHER => total.force += tether_force(view, attachment.index, sphere),
            KIND_FORCE => total.force += view.external_force(attachment.index),
            _ => unreachable!("two bits hold four kinds"),
        }
    }
    total
}

/// Returns the force of the springs and tethers on a sphere and its external force.
pub(crate) fn attached_force(view: &View, sphere: u32) -> Vec3 {
    let of = |attachment: Attachment| match attachment.kind {
        KIND_SPRING => spring_force(view, attachment.index, sphere),
        KIND_TETHER => tether_force(view, attachment.index, sphere),
        KIND_FORCE => view.external_force(attachment.index),
        _ => Vec3::ZERO,
    };
    view.attachments(sphere).map(of).sum()
}

/// Hooke's law with damping along the axis (2.16, 2.17, E5). `d` and `velocity` are the position and velocity of the other end
/// relative to this end. Returns the force on this end.
fn hooke(d: Vec3, velocity: Vec3, stiffness: f32, length: f32, damping: f32) -> Vec3 {
    let dd = d.length_squared();
    if dd <= TINY {
        return Vec3::ZERO;
    }
    let distance = dd.sqrt();
    let n = d / distance;
    (stiffness * (distance - length) + damping * velocity.dot(n)) * n
}

/// Returns the second derivative of the energy of the springs and tethers on a sphere along a displacement, in energy per
/// square of the displacement. The sphere is displaced along `own`, another sphere along the result of `of`. A spring between
/// two displaced spheres counts half, because it is evaluated for both of them.
pub(crate) fn attached_curvature(view: &View, sphere: u32, own: Vec3, of: impl Fn(u32) -> Option<Vec3>) -> f32 {
    let curvature = |d: Vec3, stretch: Vec3, stiffness: f32, length: f32| {
        let dd = d.length_squared();
        if dd <= TINY {
            return 0.0;
        }
        let (along, slack) = (stretch.dot(d), length / dd.sqrt());
        stiffness * ((1.0 - slack) * stretch.length_squared() + slack * along * along / dd)
    };
    let mut sum = 0.0;
    for attachment in view.attachments(sphere) {
        match attachment.kind {
            KIND_SPRING => {
                let spring = view.spring(attachment.index);
                let other = if spring.ends[0] == sphere { spring.ends[1] } else { spring.ends[0] };
                let theirs = of(other);
                let d = view.between(sphere, other);
                let part = if theirs.is_some() { 0.5 } else { 1.0 };
                sum += part * curvature(d, theirs.unwrap_or_default() - own, spring.stiffness, spring.length);
            }
            KIND_TETHER => {
                let tether = view.tether(attachment.index);
                sum += curvature(-view.point_to_centre(tether.point, sphere), own, tether.stiffness, tether.length);
            }
            _ => {}
        }
    }
    sum
}

fn spring_force(view: &View, spring: u32, sphere: u32) -> Vec3 {
    let spring = view.spring(spring);
    let other = if spring.ends[0] == sphere { spring.ends[1] } else { spring.ends[0] };
    hooke(
        view.between(sphere, other),
        view.velocity(other) - view.velocity(sphere),
        spring.stiffness,
        spring.length,
        spring.damping,
    )
}

pub(crate) fn tether_force(view: &View, tether: u32, sphere: u32) -> Vec3 {
    let tether = view.tether(tether);
    let d = -view.point_to_centre(tether.point, sphere);
    hooke(d, -view.velocity(sphere), tether.stiffness, tether.length, tether.damping)
}

/// Counts the contacts of a fixed sphere, without evaluating their forces.
pub(crate) fn count_contacts(view: &View, lists: &Lists, sphere: u32, tally: &mut Tally) {
    for entry in lists.row(sphere).filter(|entry| view.insertion_index(entry.id()) > view.insertion_index(sphere)) {
        if let Some(touch) = touch(view, sphere, entry.id(), entry.feature()) {
            tally.count_contact(touch.overlap);
        }
    }
}
