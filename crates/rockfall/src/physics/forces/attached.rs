//! The forces of what is attached to a sphere: rods, springs, tethers and an external force (docs/physics sections 4.1 and 4.2).

use glam::{Vec3, Vec4};

use crate::model::layout::{KIND_FORCE, KIND_ROD, KIND_SPRING, KIND_TETHER};
use crate::model::view::{Attachment, TINY, View};
use crate::physics::forces::contacts::Load;

/// Adds the loads of everything attached to a sphere. `rod_loads` are the results of the stage `rod_loads`.
pub(crate) fn add_attached(view: &View, rod_loads: &[Vec4], sphere: u32, total: &mut Load) {
    for attachment in view.attachments(sphere) {
        match attachment.kind {
            KIND_ROD => {
                let end = usize::from(view.rod(attachment.index).ends[1] == sphere);
                let at = 4 * attachment.index as usize + 2 * end;
                total.force += rod_loads[at].truncate();
                total.torque += rod_loads[at + 1].truncate();
            }
            KIND_SPRING => total.force += spring_force(view, attachment.index, sphere),
            KIND_TETHER => total.force += tether_force(view, attachment.index, sphere),
            KIND_FORCE => total.force += view.external_force(attachment.index),
            _ => unreachable!("two bits hold four kinds"),
        }
    }
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
                let d = view.apart(sphere, other);
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
        view.apart(sphere, other),
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
