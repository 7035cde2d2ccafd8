//! Springs, tethers and muscles between bodies (docs/physics section 11.9).

use std::f64::consts::TAU;

use glam::Vec3;

use crate::phase::{turns, wide};

/// Words of a muscle: its amplitude, its phase at the start of the frame, and the change of the phase in a substep, 64 bits each with the
/// low word first, in units of 2^-64 turns.
pub(crate) type MuscleWords = [u32; 5];

/// A spring, a tether or a muscle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spring {
    /// Bodies of its ends A and B. They differ, and at least one has mass.
    pub(crate) bodies: [u32; 2],
    /// Places of its ends in coordinates of the bodies.
    pub(crate) places: [Vec3; 2],
    /// In mass/s².
    pub(crate) stiffness: f32,
    /// In mass/s.
    pub(crate) damping: f32,
    /// Rest length, in units.
    pub(crate) length: f32,
    /// Velocity of the surface of a fixed sphere at B less that of one at A, in units/s.
    pub(crate) belt: Vec3,
    /// Number of its muscle.
    pub(crate) muscle: Option<u32>,
}

/// All springs of a world, in order of addition.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Springs {
    pub(crate) list: Vec<Spring>,
    /// The muscles in the present frame.
    pub(crate) muscles: Vec<MuscleWords>,
}

impl Springs {
    /// The rest length of a spring in a substep of the frame, counted from 0.
    pub(crate) fn length(&self, spring: &Spring, substep: u32) -> f32 {
        let Some(number) = spring.muscle else { return spring.length };
        let [amplitude, low, high, change_low, change_high] = self.muscles[number as usize];
        let since = wide([change_low, change_high]).wrapping_mul(substep.into());
        let sine = libm::sin(TAU * turns(wide([low, high]).wrapping_add(since))) as f32;
        spring.length * (1.0 + f32::from_bits(amplitude) * sine)
    }

    /// The greatest difference of the length of a spring from its rest lengths.
    pub(super) fn strain(&self, spring: &Spring, length: f64) -> f64 {
        let muscle = spring.muscle.map(|number| self.muscles[number as usize]);
        let amplitude = muscle.map_or(0.0, |[amplitude, ..]| f64::from(f32::from_bits(amplitude)).abs());
        (length - f64::from(spring.length)).abs() + amplitude * f64::from(spring.length)
    }
}
