//! Updates the orientations, and the spins of capsules (docs/physics sections 5.3 and 5.5, E18).
//!
//! The stage runs in scenes with rods or rigid bodies. In others the integrator updates the orientations.
//!
//! A sphere is rotated by its mean spin (exponential map). The first end of a capsule handles both ends. They get a common
//! roll about the axis, and both turn with the axis. The rest of their angular momentum across the axis becomes momentum of
//! the ends.
//!
//! That momentum p is transferred gradually during the step. It changes the relative velocity of the ends by p / mu, where
//! mu is their reduced mass. By the end of the step, of length h, it has moved the axis by h/2 times that change. With
//! symplectic Euler the part due to the forces and torques of the step has moved it by h times its change. Roll and
//! turn are the angular velocities along and across the moved axis a. They follow from the angular momentum Q of the capsule
//! about its centre of mass: its part along a and its part across a are divided by the moments of inertia. So Q is conserved
//! whatever a is.
//!
//! The axis must be moved for this reason: the axis of a free top moves about Q on a small circle, but without the shift
//! the ends would move along a great circle. Let A = Q.a, let w be the angular velocity across the axis, and I the moment
//! of inertia across. A step of the ends along the great circle leaves A sqrt(1 - h^2 w^2) of A, which is less by about
//! A h^2 w^2 / 2. The velocity p / mu is h w A/I along the part of Q across a, so the shift gives A h^2 w^2 / 2 back. What
//! remains is a loss of A h^4 w^2 |Q/I|^2 / 8 per step. It is never a gain, because sqrt(1 - x) + x/2 <= 1. The kinetic
//! energy falls with A, because the moment of inertia about the axis is smaller than that across. So the energy does not
//! grow, and the spin about the axis decays as h^3, not as h.

use glam::{Quat, Vec3, Vec4};

use crate::fine::Fine;
use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::view::View;
use crate::model::world::World;
use crate::physics::geometry::scale;
use crate::rotate::{self, product, unit};
use crate::step::moves::{Moves, NONE};
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
    // Reads the mean spin, reads and writes the orientation.
    moves: |_| Moves { rows: 3, ..NONE },
    cpu: turn,
};

fn turn(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states: [state, _, memory, _], orientations, .. } = world;
    let n = step.layout.spheres as usize;
    // Before any end moves: far from the origin the ends of a capsule may coincide afterwards.
    let view = View::new(step, topology, state);
    let ends_of = |sphere: u32| view.capsule_of(sphere).map(|rod| view.rod(rod).ends);
    let capsules: Vec<Option<[u32; 2]>> = (0..step.layout.spheres).map(ends_of).collect();
    for (sphere, ends) in (0..step.layout.spheres).zip(capsules) {
        let view = View::new(step, topology, state);
        match ends {
            // The first end handles both.
            Some(ends) if ends[0] == sphere => {
                let old = memory[ends[1] as usize].truncate() - memory[ends[0] as usize].truncate();
                let capsule = turned_capsule(&view, ends, old);
                for (place, end) in ends.map(|end| end as usize).into_iter().enumerate() {
                    if capsule.is_finite() {
                        let Fine { high, low } = capsule.positions[place];
                        state[end] = high.extend(state[end].w);
                        state[3 * n + end] = low.extend(0.0);
                        state[n + end] = capsule.velocities[place].extend(state[n + end].w);
                        state[2 * n + end] = capsule.angular_momenta[place].extend(state[2 * n + end].w);
                    }
                    turn_by(&mut orientations[end], capsule.rotation);
                }
            }
            Some(_) => {}
            None => {
                turn_for(&mut orientations[sphere as usize], memory[2 * n + sphere as usize].truncate(), step.constants.dt);
            }
        }
    }
}

/// Rotates an orientation by a spin, in rad/s, for a time, in s.
pub(crate) fn turn_for(orientation: &mut Vec4, spin: Vec3, time: f32) {
    turn_by(orientation, rotate::by(spin * time));
}

/// Rotates an orientation. A rotation by the angle 0, or one whose result is not finite, leaves it unchanged.
fn turn_by(orientation: &mut Vec4, rotation: Quat) {
    if rotation.xyz() == Vec3::ZERO {
        return;
    }
    let turned = unit(product(rotation, Quat::from_vec4(*orientation)));
    if turned.is_finite() {
        *orientation = turned.into();
    }
}

/// The new state of a capsule. Arrays hold one value per end.
struct Capsule {
    positions: [Fine; 2],
    velocities: [Vec3; 2],
    angular_momenta: [Vec3; 2],
    rotation: Quat,
}

impl Capsule {
    /// Whether the new state is finite. If it is not, each end keeps its own spin.
    fn is_finite(&self) -> bool {
        let Self { positions, velocities, angular_momenta, .. } = self;
        let places = positions.map(|place| place.high);
        [&places, velocities, angular_momenta].into_iter().flatten().all(|vector| vector.is_finite())
    }
}

fn turned_capsule(view: &View, ends: [u32; 2], d_old: Vec3) -> Capsule {
    let [one, two] = ends;
    let d = view.between(one, two);
    let size = scale(d);
    let axis = d.normalize();
    let velocity = view.velocity(two) - view.velocity(one);
    let inertia = ends.map(|end| 1.0 / view.inverse_inertia(end));
    let own_inertia = inertia[0] + inertia[1];
    let reduced_mass = 1.0 / (view.inverse_mass(one) + view.inverse_mass(two));
    let whole_inertia = reduced_mass * d.length_squared() + own_inertia;
    let spins = view.angular_momentum(one) + view.angular_momentum(two);
    let orbital = reduced_mass * d.cross(velocity);
    let whole = spins + orbital;

    // Across the axis both ends get the angular velocity of the rigid body about its centre of mass (E18). The rest of their
    // angular momentum across the axis becomes momentum of the ends.
    let mut excess = spins.reject_from_normalized(axis) - own_inertia / whole_inertia * whole.reject_from_normalized(axis);
    if view.step.is_half_step() {
        // Forces and torques change the spins at the start of the step, across the axis of that time. Their excess acts for
        // the whole step. The rest, which is due to the rotation of the axis, acts for half of it, as with other integrators.
        let first_axis = axis_before(axis, view.step.constants.dt / d.length() * velocity);
        excess += (spins - own_inertia / whole_inertia * whole).reject_from_normalized(first_axis);
    }
    let shift = 0.5 * view.step.constants.dt * excess.cross(axis) / (reduced_mass * d.length());
    let moved = (d + shift) * (d.length() / (d + shift).length());
    let moved_axis = moved / d.length();

    // Roll and turn are computed from the moved vector and its square, not from a unit vector, so that rounding errors of
    // its length do not add up over the steps. The orbital angular momentum has no part along d, and may be much larger
    // than the spins, so it is multiplied by the change of d only.
    let scaled = size * moved;
    let square = scaled.length_squared();
    let axial = (spins.dot(scaled) + orbital.dot(scaled - size * d)) / square * scaled;
    let roll = axial / own_inertia;
    let turn = (whole - whole.dot(scaled) / square * scaled) / whole_inertia;
    let momentum = reduced_mass * (turn.cross(moved) + velocity.dot(axis) * moved_axis - velocity);

    let old_axis = d_old.try_normalize().unwrap_or(axis);
    let rolled = rotate::by(roll.dot(moved_axis) * view.step.constants.dt * old_axis);
    let rotation = product(shortest_arc(old_axis, moved_axis), rolled);
    let share = |end: u32| reduced_mass * view.inverse_mass(end) * (moved - d);
    let pushed = |end: u32, momentum: Vec3| view.velocity(end) + view.inverse_mass(end) * momentum;
    Capsule {
        positions: [view.fine(one).moved(-share(one)), view.fine(two).moved(share(two))],
        velocities: [pushed(one, -momentum), pushed(two, momentum)],
        angular_momenta: inertia.map(|inertia| inertia * (roll + turn)),
        rotation,
    }
}

/// Returns the axis before a step of symplectic Euler from that after the step, and the displacement of end 2 relative to end 1
/// over the length.
fn axis_before(axis: Vec3, displacement: Vec3) -> Vec3 {
    let across = displacement.reject_from_normalized(axis);
    (1.0 - across.length_squared()).max(0.0).sqrt() * axis - across
}

/// Returns the shortest rotation from one unit vector to another. `Quat::from_rotation_arc` treats a small angle as 0, but
/// a capsule turns by a small angle every step.
fn shortest_arc(from: Vec3, to: Vec3) -> Quat {
    let real = 1.0 + from.dot(to);
    if real < 1e-6 {
        // The vectors are opposite. Any perpendicular axis will do.
        return Quat::from_rotation_arc(from, to);
    }
    unit(Quat::from_vec4(from.cross(to).extend(real)))
}
