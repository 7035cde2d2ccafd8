//! The state of one sphere, and parallel writes to the rows of a state.

use std::ops::Range;

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::error::BadStage;
use crate::fine::Fine;
use crate::model::counters::Tally;
use crate::model::layout::GRAIN;
use crate::model::layout::SLICE;
use crate::model::residue::{Increased, drifted, increased};
use crate::model::step::Step;
use crate::model::view::View;

/// Position, velocity and angular momentum of one sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub(crate) position: Vec3,
    /// Low part of the position.
    pub(crate) low: Vec3,
    pub(crate) velocity: Vec3,
    pub(crate) angular_momentum: Vec3,
    /// What rounding left of velocity and angular momentum (docs/physics section 5.10).
    pub(crate) residues: Vec4,
}

impl Motion {
    pub(crate) fn of(view: &View, sphere: u32) -> Self {
        Self {
            position: view.position(sphere),
            low: view.position_low(sphere),
            velocity: view.velocity(sphere),
            angular_momentum: view.angular_momentum(sphere),
            residues: view.residues(sphere).unwrap_or_default(),
        }
    }

    /// Velocity and angular momentum after these increments, with their residues. The position is the same.
    pub(crate) fn increased(self, step: &Step, by: [Vec3; 2]) -> Self {
        self.with(increased(self.vectors(), self.residues_in(step), by))
    }

    /// The same for the drift of velocity Verlet.
    pub(crate) fn drifted(self, step: &Step, by: [Vec3; 2]) -> Self {
        self.with(drifted(self.vectors(), self.residues_in(step), by))
    }

    fn vectors(&self) -> [Vec3; 2] {
        [self.velocity, self.angular_momentum]
    }

    fn residues_in(&self, step: &Step) -> Option<Vec4> {
        step.has_residues().then_some(self.residues)
    }

    fn with(self, Increased { velocity, angular_momentum, residues }: Increased) -> Self {
        Self { velocity, angular_momentum, residues, ..self }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.position.is_finite() && self.low.is_finite() && self.velocity.is_finite() && self.angular_momentum.is_finite()
    }

    /// Position and low part after a displacement.
    pub(crate) fn moved(&self, by: Vec3) -> (Vec3, Vec3) {
        let Fine { high, low } = Fine { high: self.position, low: self.low }.moved(by);
        (high, low)
    }

    /// Returns this motion if it is finite. Otherwise returns a sphere at rest at `start`, and counts the sphere in `tally`.
    pub(crate) fn or_stopped(self, start: &Self, stage: BadStage, insertion_index: u32, tally: &mut Tally) -> Self {
        if self.is_finite() {
            return self;
        }
        tally.count_bad(stage, insertion_index);
        let (position, low) = (start.position, start.low);
        Self { position, low, velocity: Vec3::ZERO, angular_momentum: Vec3::ZERO, residues: Vec4::ZERO }
    }
}

/// The rows of the spheres of one slice in a state array.
pub(crate) struct Rows<'a> {
    first: u32,
    positions: &'a mut [Vec4],
    velocities: &'a mut [Vec4],
    spins: &'a mut [Vec4],
    /// Empty in a state without low parts.
    lows: &'a mut [Vec4],
    /// Velocities at the time of the positions; empty in a state without them.
    synchronised: &'a mut [Vec4],
    /// Empty in a state without residues.
    residues: &'a mut [Vec4],
}

impl<'a> Rows<'a> {
    /// Splits a state array into the rows of each slice.
    pub(crate) fn of(state: &'a mut [Vec4], spheres: u32) -> impl IndexedParallelIterator<Item = Self> {
        const LENGTH: usize = SLICE as usize;
        let (positions, rest) = state.split_at_mut(spheres as usize);
        let (velocities, rest) = rest.split_at_mut(spheres as usize);
        let (spins, rest) = rest.split_at_mut(spheres as usize);
        let (lows, synchronised) = rest.split_at_mut(rest.len().min(spheres as usize));
        let (synchronised, residues) = synchronised.split_at_mut(synchronised.len().min(spheres as usize));
        let (residues, _) = residues.split_at_mut(residues.len().min(spheres as usize));
        let slices = positions.len().div_ceil(LENGTH);
        let [lows, synchronised, residues] = [lows, synchronised, residues].map(|rows| {
            let mut chunks: Vec<&mut [Vec4]> = rows.chunks_mut(LENGTH).collect();
            chunks.resize_with(slices, Default::default);
            chunks
        });
        let slices = positions.par_chunks_mut(LENGTH).zip(velocities.par_chunks_mut(LENGTH)).zip(spins.par_chunks_mut(LENGTH));
        let rows = slices.zip(lows).zip(synchronised).zip(residues).enumerate().map(
            |(slice, (((((positions, velocities), spins), lows), synchronised), residues))| Self {
                first: slice as u32 * SLICE,
                positions,
                velocities,
                spins,
                lows,
                synchronised,
                residues,
            },
        );
        rows.with_min_len(GRAIN / LENGTH)
    }

    /// The spheres of the slice.
    pub(crate) fn spheres(&self) -> Range<u32> {
        self.first..self.first + self.positions.len() as u32
    }

    /// Reads the rows of a sphere.
    pub(crate) fn get(&self, sphere: u32) -> Motion {
        let place = (sphere - self.first) as usize;
        let [position, velocity, angular_momentum] =
            [&self.positions, &self.velocities, &self.spins].map(|rows| rows[place].truncate());
        let low = self.lows.get(place).map_or(Vec3::ZERO, |low| low.truncate());
        let residues = self.residues.get(place).copied().unwrap_or_default();
        Motion { position, low, velocity, angular_momentum, residues }
    }

    /// Writes a motion, with the radius, inverse mass and inverse inertia that the sphere has in `view`.
    pub(crate) fn set(&mut self, view: &View, sphere: u32, motion: Motion) {
        let place = (sphere - self.first) as usize;
        self.positions[place] = motion.position.extend(view.radius(sphere));
        self.velocities[place] = motion.velocity.extend(view.inverse_mass(sphere));
        self.spins[place] = motion.angular_momentum.extend(view.inverse_inertia(sphere));
        if let Some(low) = self.lows.get_mut(place) {
            *low = motion.low.extend(0.0);
        }
        self.set_residues(place, motion);
    }

    fn set_residues(&mut self, place: usize, motion: Motion) {
        if let Some(row) = self.residues.get_mut(place) {
            *row = motion.residues;
        }
    }

    /// Writes a motion, and keeps the radius, inverse mass and inverse inertia.
    pub(crate) fn replace(&mut self, sphere: u32, motion: Motion) {
        let place = (sphere - self.first) as usize;
        for (row, value) in [
            (&mut self.positions[place], motion.position),
            (&mut self.velocities[place], motion.velocity),
            (&mut self.spins[place], motion.angular_momentum),
            (&mut self.lows[place], motion.low),
        ] {
            *row = value.extend(row.w);
        }
        self.set_residues(place, motion);
    }

    /// [`Rows::set`] for the phase of collisions, whose velocities are those at the time of the positions.
    pub(crate) fn set_after_collisions(&mut self, view: &View, sphere: u32, motion: Motion) {
        self.set(view, sphere, Motion { velocity: view.own_velocity_after(sphere, motion.velocity), ..motion });
        if let Some(row) = self.synchronised.get_mut((sphere - self.first) as usize) {
            *row = motion.velocity.extend(view.inverse_mass(sphere));
        }
    }

    /// Writes what the constraints need: the position before the step to region 0 and the mean spin to region 2.
    pub(crate) fn remember(&mut self, sphere: u32, old_position: Vec3, mean_spin: Vec3) {
        let place = (sphere - self.first) as usize;
        self.positions[place] = old_position.extend(0.0);
        self.spins[place] = mean_spin.extend(0.0);
    }
}
