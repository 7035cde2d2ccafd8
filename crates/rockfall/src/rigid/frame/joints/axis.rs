//! A row of a joint with the block that answers it and the rotor that it takes along (docs/physics section 11.14).

use glam::{Vec3, Vec3A};

use super::Ends;
use super::pivot::{Pivot, Row};
use crate::rigid::joints::JointImpulses;

/// The least part of K that a block leaves.
const LEAST: f32 = 1e-5;

pub(super) struct Axis {
    pub(super) row: Row,
    /// K with a hard block, and with the block of this pass. With a rotor, the second one is less by what the rotor resists.
    pub(super) hard: f32,
    pub(super) give: f32,
    /// The impulse of the block that follows an impulse of 1 of the row, along the axes of the joint.
    answer: Vec3A,
    /// The part of an impulse that the rotor takes.
    share: f32,
    /// Impulses on the bodies in this visit, and those on the rotor.
    pulled: f32,
    taken: f32,
}

impl Axis {
    /// A row that no block answers and no rotor resists.
    pub(super) fn alone(row: Row) -> Self {
        Self { row, hard: row.inverse, give: row.inverse, answer: Vec3A::ZERO, share: 0.0, pulled: 0.0, taken: 0.0 }
    }

    /// The row of a free axis. The block takes this part of a rate away.
    pub(super) fn new(row: Row, pivot: &Pivot, gain: f32) -> Self {
        let block = if row.angular { &pivot.linear } else { &pivot.angular };
        let (Some(block), Some(answer)) = (block, &pivot.answer) else { return Self::alone(row) };
        let against = -block.scale * answer.against;
        let answered = answer.across.dot(against);
        // K with a hard block is positive, whatever its rounding.
        let hard = (row.inverse + answered).max(LEAST * row.inverse);
        let give = (row.inverse + gain * answered).max(hard);
        Self { hard, give, answer: gain * against, ..Self::alone(row) }
    }

    /// Connects the rotor.
    pub(super) fn take_along(&mut self, armature: f32) {
        let taken = armature * self.give;
        (self.share, self.give) = (taken / (1.0 + taken), self.give / (1.0 + taken));
    }

    pub(super) fn apply(&mut self, impulse: f32, ends: &mut Ends<'_>) {
        let (taken, axes) = (self.share * impulse, ends.pivot.axes);
        let pull = impulse - taken;
        self.taken += taken;
        self.pulled += pull;
        ends.apply(&self.row, pull);
        if self.answer != Vec3A::ZERO {
            let answer = axes * (pull * self.answer);
            if self.row.angular { ends.push(answer) } else { ends.turn(answer) }
        }
    }

    /// Adds what the block and the rotor took to their impulses.
    pub(super) fn settle(&self, own: &mut JointImpulses) {
        let answer = Vec3::from(self.pulled * self.answer);
        if self.row.angular {
            own.linear += answer;
        } else {
            own.angular += answer;
        }
        own.drive -= self.taken;
    }
}
