//! One sphere's state, and writing it row by row from many threads.

use glam::{Vec3, Vec4};

use crate::cpu::tally::Tally;
use crate::cpu::view::View;
use crate::layout::BadStage;

/// Position, velocity and angular momentum of one sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) position: Vec3,
    pub(crate) velocity: Vec3,
    pub(crate) angular_momentum: Vec3,
}

impl Motion {
    pub(crate) fn of(view: &View, sphere: u32) -> Self {
        Self {
            position: view.position(sphere),
            velocity: view.velocity(sphere),
            angular_momentum: view.angular_momentum(sphere),
        }
    }

    /// This, or, where it is not finite, rest at `start`, which is told of the sphere with this index in order of addition.
    pub(crate) fn or_stopped(self, start: Vec3, stage: BadStage, user: u32, tally: &mut Tally) -> Self {
        if self.position.is_finite() && self.velocity.is_finite() && self.angular_momentum.is_finite() {
            return self;
        }
        tally.count_bad(stage, user);
        Self { position: start, velocity: Vec3::ZERO, angular_momentum: Vec3::ZERO }
    }
}

/// The three words of one sphere in a state array.
pub(crate) struct Row<'a> {
    position: &'a mut Vec4,
    velocity: &'a mut Vec4,
    spin: &'a mut Vec4,
}

/// The rows of a state array.
pub(crate) struct Rows;

impl Rows {
    /// Every sphere's index and row.
    pub(crate) fn of(state: &mut [Vec4], spheres: u32) -> Vec<(u32, Row<'_>)> {
        let (positions, rest) = state.split_at_mut(spheres as usize);
        let (velocities, spins) = rest.split_at_mut(spheres as usize);
        let rows = positions.iter_mut().zip(velocities).zip(spins);
        (0..).zip(rows.map(|((position, velocity), spin)| Row { position, velocity, spin })).collect()
    }
}

impl Row<'_> {
    /// Writes the motion, and radius, inverse mass and inverse inertia of the sphere in `view`.
    pub(crate) fn set(self, view: &View, sphere: u32, motion: Motion) {
        *self.position = motion.position.extend(view.radius(sphere));
        *self.velocity = motion.velocity.extend(view.inverse_mass(sphere));
        *self.spin = motion.angular_momentum.extend(view.inverse_inertia(sphere));
    }

    /// Writes the motion; radius, inverse mass and inverse inertia stay.
    pub(crate) fn put(self, motion: Motion) {
        *self.position = motion.position.extend(self.position.w);
        *self.velocity = motion.velocity.extend(self.velocity.w);
        *self.spin = motion.angular_momentum.extend(self.spin.w);
    }

    /// What the constraints need to know: region 0 gets the position before the step, region 2 the mean spin.
    pub(crate) fn remember(self, old_position: Vec3, mean_spin: Vec3) {
        *self.position = old_position.extend(0.0);
        *self.spin = mean_spin.extend(0.0);
    }
}
