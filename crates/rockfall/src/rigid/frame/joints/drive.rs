//! The drive of a joint: spring, damping, effort, drag and armature (docs/physics section 11.14).

use glam::{Mat3A, Vec3, Vec3A};

use super::axis::Axis;
use super::pivot::{inverse, reduced};
use super::{Ends, Visit};
use crate::rigid::joints::{Drive, Free, Joint, JointState, within};

/// A spring with a greater h^2 k K has a damping of its own, up to `DAMPED`, and is no stiffer than `STIFFEST`.
const SYMPLECTIC: f32 = 0.25;
const DAMPED: f32 = 6.0;
const STIFFEST: f32 = 2.0;
impl Visit {
    /// The drive along the free axis.
    pub(super) fn act(&self, joint: &Joint, position: f32, axis: &mut Axis, state: &mut JointState, ends: &mut Ends<'_>) {
        if joint.drive.locked || !joint.drive.acts() {
            return;
        }
        if self.biased && self.is_first {
            let off = position - joint.drive.target;
            state.off = if joint.kind.free == Free::Turn { reduced(off, 0.0) } else { off };
        }
        let step = self.change(joint, state, [axis.give, axis.hard], ends.speed_of(&axis.row));
        state.impulses.drive += step;
        axis.apply(step, ends);
    }

    /// The change of the impulse of a row at this speed, with its K and that of a hard block.
    fn change(&self, joint: &Joint, state: &JointState, [give, hard]: [f32; 2], speed: f32) -> f32 {
        let (Drive { stiffness, effort, spring_limit, .. }, h) = (joint.drive, self.h);
        let [damping, drag, armature] = match joint.kind.is_ball() {
            true => [0.0; 3],
            false => [joint.drive.damping, joint.drive.drag, joint.drive.armature],
        };
        let stiff = (h * h * stiffness - SYMPLECTIC / hard).max(0.0).min(DAMPED / hard);
        let (resistance, free) = (h * damping + stiff, h * drag + armature);
        let (push, kept) = (h * effort - (h * stiffness).min(STIFFEST / (h * hard)) * state.off, armature * state.rotor.x);
        let solved =
            |push: f32, resistance: f32| (push + kept - resistance * speed - state.impulses.drive) / (1.0 + resistance * give);
        let step = solved(push, resistance + free);
        let bounded = push - resistance * (speed + give * step);
        let most = within(bounded, spring_limit, h);
        if most == bounded { step } else { solved(most, free) }
    }

    /// The drive of a ball, against all rotations.
    pub(super) fn resist(&self, drive: &Drive, state: &mut JointState, ends: &mut Ends<'_>) {
        let resistance = self.h * (drive.damping + drive.drag) + drive.armature;
        if resistance == 0.0 {
            return;
        }
        let (give, axes) = (ends.pivot.turning(), ends.pivot.axes);
        let before = axes * Vec3A::from(state.impulses.resistance);
        let rotor = axes * Vec3A::from(state.rotor);
        let wanted = ends.rate() + (before - drive.armature * rotor) / resistance;
        let step = -(inverse(give + Mat3A::from_diagonal(Vec3::splat(resistance.recip()))) * wanted);
        state.impulses.resistance = (axes.transpose() * (before + step)).into();
        ends.turn(step);
        if self.is_last() {
            state.rotor = (axes.transpose() * ends.rate()).into();
        }
    }
}
