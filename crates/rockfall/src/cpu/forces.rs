//! The net force on a sphere and on the ends of a rod (physics.md section 4).

use glam::{Vec3, Vec4};

use crate::cpu::balls::{Ball, Meeting};
use crate::cpu::contact::{ContactForce, contact_force, contact_forces};
use crate::cpu::lists::{Entry, Lists};
use crate::cpu::tally::Tally;
use crate::cpu::touch::touch;
use crate::cpu::view::{TINY, View};
use crate::layout::{KIND_FORCE, KIND_ROD, KIND_SPRING, KIND_TETHER};

/// Force and couple on one body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Load {
    pub(crate) force: Vec3,
    pub(crate) couple: Vec3,
}

/// Every contact of a mover, in its list's order: its own load and its parameter on the contact if it is a rod.
/// `tally`, where given, counts those in which the mover is A.
pub(crate) fn each_contact(
    view: &View,
    lists: &Lists,
    mover: u32,
    mut tally: Option<&mut Tally>,
    mut take: impl FnMut(Load, f32),
) {
    let (count, list) = lists.list(mover);
    let done = Ball::new(view, mover).map_or(0, |ball| {
        ball.for_each_near(count, &list, |others| ball_loads(&ball, others, tally.as_deref_mut(), &mut take))
    });
    for entry in (done..count).map(list) {
        let (id_a, id_b) = view.ordered(mover, entry.id());
        let Some(touch) = touch(view, id_a, id_b, entry.feature()) else {
            continue;
        };
        let ContactForce { force, torque_a, torque_b } = contact_force(view, view.object(id_a), view.object(id_b), &touch);
        if mover == id_a {
            if let Some(tally) = tally.as_deref_mut() {
                tally.count_contact(touch.overlap);
            }
            take(Load { force, couple: torque_a }, touch.a);
        } else {
            take(Load { force: -force, couple: torque_b }, touch.b);
        }
    }
}

/// The loads of up to four contacts with other spheres, in their order.
#[inline]
fn ball_loads(ball: &Ball, others: &[Entry], mut tally: Option<&mut Tally>, take: &mut impl FnMut(Load, f32)) {
    let Meeting { a, b, touches } = ball.meet(others);
    let loads = contact_forces(ball.view.step, &a, &b, &touches);
    let loads = loads.force.to_rows().into_iter().zip(loads.torque_a.to_rows());
    let each = others.iter().zip(touches.overlap.to_array()).zip(loads).filter(|((_, overlap), _)| *overlap > 0.0);
    for ((other, overlap), (force, couple)) in each {
        if let Some(tally) = &mut tally
            && ball.is_first(other.id())
        {
            tally.count_contact(overlap);
        }
        take(Load { force, couple }, 0.0);
    }
}

/// The loads on both ends of a rod: each contact is evaluated once and shared by (1 - a), a.
pub(crate) fn rod_loads(view: &View, lists: &Lists, rod: u32, tally: Option<&mut Tally>) -> [Load; 2] {
    let mut ends = [Load::default(); 2];
    each_contact(view, lists, view.step.spheres + rod, tally, |load, parameter| {
        for (end, share) in ends.iter_mut().zip([1.0 - parameter, parameter]) {
            end.force += share * load.force;
            end.couple += share * load.couple;
        }
    });
    ends
}

/// The load on a sphere, gravity left out: contacts, then what is attached to it. `wrenches` are those of `rod_forces`.
pub(crate) fn sphere_load(view: &View, lists: &Lists, wrenches: &[Vec4], sphere: u32, tally: Option<&mut Tally>) -> Load {
    let mut total = Load::default();
    each_contact(view, lists, sphere, tally, |load, _| {
        total.force += load.force;
        total.couple += load.couple;
    });
    for attachment in view.attachments(sphere) {
        match attachment.kind {
            KIND_ROD => {
                let end = usize::from(view.rod(attachment.index).ends[1] == sphere);
                let at = 4 * attachment.index as usize + 2 * end;
                total.force += wrenches[at].truncate();
                total.couple += wrenches[at + 1].truncate();
            }
            KIND_SPRING => total.force += spring_force(view, attachment.index, sphere),
            KIND_TETHER => total.force += tether_force(view, attachment.index, sphere),
            KIND_FORCE => total.force += view.outside_force(attachment.index),
            _ => unreachable!("two bits hold four kinds"),
        }
    }
    total
}

/// Hooke's law with damping along the axis (2.16, 2.17, E5), on the end that `d` and `velocity` are seen from.
fn hooke(d: Vec3, velocity: Vec3, stiffness: f32, length: f32, damping: f32) -> Vec3 {
    let dd = d.length_squared();
    if dd <= TINY {
        return Vec3::ZERO;
    }
    let distance = dd.sqrt();
    let n = d / distance;
    (stiffness * (distance - length) + damping * velocity.dot(n)) * n
}

fn spring_force(view: &View, spring: u32, sphere: u32) -> Vec3 {
    let spring = view.spring(spring);
    let other = if spring.ends[0] == sphere { spring.ends[1] } else { spring.ends[0] };
    hooke(
        view.position(other) - view.position(sphere),
        view.velocity(other) - view.velocity(sphere),
        spring.stiffness,
        spring.length,
        spring.damping,
    )
}

fn tether_force(view: &View, tether: u32, sphere: u32) -> Vec3 {
    let tether = view.tether(tether);
    let d = tether.point - view.position(sphere);
    hooke(d, -view.velocity(sphere), tether.stiffness, tether.length, tether.damping)
}

/// Rate of change of velocity and of angular momentum of a moving sphere.
pub(crate) fn rates(view: &View, lists: &Lists, wrenches: &[Vec4], sphere: u32, tally: Option<&mut Tally>) -> (Vec3, Vec3) {
    let load = sphere_load(view, lists, wrenches, sphere, tally);
    (Vec3::from_array(view.step.gravity) + view.inverse_mass(sphere) * load.force, load.couple)
}

/// Counts the contacts of a sphere whose forces do not matter, because it is fixed.
pub(crate) fn count_contacts(view: &View, lists: &Lists, sphere: u32, tally: &mut Tally) {
    for entry in lists.row(sphere).filter(|entry| view.user(entry.id()) > view.user(sphere)) {
        if let Some(touch) = touch(view, sphere, entry.id(), entry.feature()) {
            tally.count_contact(touch.overlap);
        }
    }
}
