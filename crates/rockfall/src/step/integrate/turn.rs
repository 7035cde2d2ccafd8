//! Orientations, and the spin of capsules (docs/physics.md sections 5.3 and 5.5, E18).
//!
//! In scenes with rods; in others `finish_and_turn` or `commit_and_turn` has done it.
//! A sphere turns by its mean spin (exponential map). The first end of a capsule does both ends: common roll about
//! the axis, both turn with the axis, and what is left of their angular momentum returns as momentum of the ends.
//!
//! That momentum p goes over all through the step, and by its end has moved the axis as well: by h/2 times the change
//! p / mu of the velocity of one end against the other (mu their reduced mass). Roll and turning are then those of the
//! capsule's angular momentum T about its centre of mass along and across the moved axis a, so that T is kept whatever a is.
//!
//! Why a must be moved: the ends alone fly along a great circle, a free top's axis goes round T on a small one. With
//! J = T.a, w the spin across, I the moment of inertia across, a step of the ends leaves J sqrt(1 - h^2 w^2), less by
//! J h^2 w^2 / 2; p / mu is h w J/I along T across a, and the shift gives J h^2 w^2 / 2 back. What remains is a loss of
//! J h^4 w^2 |T/I|^2 / 8 a step, never a gain, as sqrt(1 - x) + x/2 <= 1: the kinetic energy, which falls as J does (an axis is
//! easier to turn about than across), does not grow, and the spin about the axis decays as h^3, not as h.

use glam::{Quat, Vec3, Vec4};

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "turn",
    wgsl: Wgsl::File(part!("step/integrate/turn.wgsl")),
    bindings: &[
        write("state", Buffer::Start),
        read("y3", Buffer::Y3),
        write("orientations", Buffer::Orientations),
        read("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    cpu: turn,
};

fn turn(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states: [state, _, memory, _], orientations, .. } = world;
    let n = step.spheres as usize;
    for sphere in 0..step.spheres {
        let view = View::new(step, topology, state);
        match view.capsule_of(sphere).map(|rod| view.rod(rod).ends) {
            // The first end turns both.
            Some(ends) if ends[0] == sphere => {
                let old = memory[ends[1] as usize].truncate() - memory[ends[0] as usize].truncate();
                let capsule = turned_capsule(&view, ends, old);
                for (place, end) in ends.map(|end| end as usize).into_iter().enumerate() {
                    if capsule.is_finite() {
                        state[end] = capsule.positions[place].extend(state[end].w);
                        state[n + end] = capsule.velocities[place].extend(state[n + end].w);
                        state[2 * n + end] = capsule.angular_momenta[place].extend(state[2 * n + end].w);
                    }
                    turn_by(&mut orientations[end], capsule.rotation);
                }
            }
            Some(_) => {}
            None => {
                turn_for(&mut orientations[sphere as usize], memory[2 * n + sphere as usize].truncate(), step.dt);
            }
        }
    }
}

/// Turns an orientation by a spin, in rad/s, for a time, in s.
pub(super) fn turn_for(orientation: &mut Vec4, spin: Vec3, time: f32) {
    turn_by(orientation, Quat::from_scaled_axis(spin * time));
}

/// An angle beyond all numbers turns nothing, no angle leaves everything as it is.
fn turn_by(orientation: &mut Vec4, rotation: Quat) {
    if rotation.xyz() == Vec3::ZERO {
        return;
    }
    let turned = (rotation * Quat::from_vec4(*orientation)).normalize();
    if turned.is_finite() {
        *orientation = turned.into();
    }
}

/// What becomes of a capsule; one value an end.
struct Capsule {
    positions: [Vec3; 2],
    velocities: [Vec3; 2],
    angular_momenta: [Vec3; 2],
    rotation: Quat,
}

impl Capsule {
    /// Where one spin for both ends is beyond all numbers, each end keeps its own.
    fn is_finite(&self) -> bool {
        let Self { positions, velocities, angular_momenta, .. } = self;
        [positions, velocities, angular_momenta].into_iter().flatten().all(|vector| vector.is_finite())
    }
}

fn turned_capsule(view: &View, ends: [u32; 2], d_old: Vec3) -> Capsule {
    let [one, two] = ends;
    let d = view.position(two) - view.position(one);
    let axis = d.normalize();
    let velocity = view.velocity(two) - view.velocity(one);
    let inertia = ends.map(|end| 1.0 / view.inverse_inertia(end));
    let own_inertia = inertia[0] + inertia[1];
    let reduced_mass = 1.0 / (view.inverse_mass(one) + view.inverse_mass(two));
    let whole_inertia = reduced_mass * d.length_squared() + own_inertia;
    let spins = view.angular_momentum(one) + view.angular_momentum(two);
    let orbital = reduced_mass * d.cross(velocity);
    let whole = spins + orbital;

    // Across the axis both ends turn with it, at the spin of the whole body about its centre of mass (E18).
    let left = spins.reject_from_normalized(axis) - own_inertia * whole.reject_from_normalized(axis) / whole_inertia;
    let shift = 0.5 * view.step.dt * left.cross(d) / (reduced_mass * d.length_squared());
    let moved = (d + shift) * (d.length() / (d + shift).length());
    let moved_axis = moved / d.length();

    // Roll and turning times the moved axis by its square: so rounding of its length does not add up over the steps. The ends'
    // orbit has no part along d: it is left out of the sum, for it may be large beside the spins.
    let square = moved.length_squared();
    let axial = (spins.dot(moved) + orbital.dot(moved - d)) / square * moved;
    let roll = axial / own_inertia;
    let turn = (whole - whole.dot(moved) / square * moved) / whole_inertia;
    let momentum = reduced_mass * (turn.cross(moved) + velocity.dot(axis) * moved_axis - velocity);

    let old_axis = d_old.try_normalize().unwrap_or(axis);
    let rotation = shortest_arc(old_axis, moved_axis) * Quat::from_axis_angle(old_axis, roll.dot(moved_axis) * view.step.dt);
    let share = |end: u32| reduced_mass * view.inverse_mass(end) * (moved - d);
    let pushed = |end: u32, momentum: Vec3| view.velocity(end) + view.inverse_mass(end) * momentum;
    Capsule {
        positions: [view.position(one) - share(one), view.position(two) + share(two)],
        velocities: [pushed(one, -momentum), pushed(two, momentum)],
        angular_momenta: inertia.map(|inertia| inertia * (roll + turn)),
        rotation,
    }
}

/// The shortest rotation that takes one unit vector to another. glam's own takes small angles for none, and a capsule
/// turns by a small angle every step.
fn shortest_arc(from: Vec3, to: Vec3) -> Quat {
    let real = 1.0 + from.dot(to);
    if real < 1e-6 {
        // Opposite: about any perpendicular axis.
        return Quat::from_rotation_arc(from, to);
    }
    Quat::from_vec4(from.cross(to).extend(real)).normalize()
}
