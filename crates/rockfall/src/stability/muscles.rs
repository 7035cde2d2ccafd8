//! Muscles that a time step is too long for.

use crate::scene::Scene;
use crate::stability::{at_most, nearest};

/// The least number of time steps in a period of a muscle.
const STEPS_PER_PERIOD: f64 = 10.0;

/// The fastest muscle of a scene, when a time step divides its period into too few parts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FastMuscle {
    /// The spring that it belongs to, in order of addition.
    pub spring: usize,
    /// Its frequency in 1/s.
    pub frequency: f32,
    /// Time steps in a period.
    pub steps: f64,
    /// The largest time step that divides the period into enough parts, in s.
    pub largest_dt: f64,
}

impl FastMuscle {
    /// A message that names the spring as the scene text does.
    pub fn describe(&self, scene: &Scene) -> String {
        let Self { spring, frequency, steps, largest_dt } = *self;
        format!(
            "the muscle of {} has a frequency of {} /s and so only {} time steps in a period; its motion is wrong with less than \
             {STEPS_PER_PERIOD}, so use --dt {} or less",
            scene.name_of_spring(spring),
            nearest(frequency.into()),
            nearest(steps),
            at_most(largest_dt)
        )
    }
}

impl Scene {
    /// The fastest muscle, if a time step of `dt` seconds divides its period into less than 10 parts. Muscles of amplitude 0 do
    /// not count.
    pub fn fast_muscle(&self, dt: f32) -> Option<FastMuscle> {
        let moving = |(spring, muscle): (usize, Option<crate::scene::Muscle>)| {
            muscle.filter(|muscle| muscle.amplitude != 0.0).map(|muscle| (spring, muscle.frequency))
        };
        let muscles = self.springs().iter().map(|spring| spring.muscle).enumerate().filter_map(moving);
        // The first of equally fast muscles.
        let (spring, frequency) = muscles.reduce(|fastest, next| if next.1 > fastest.1 { next } else { fastest })?;
        let steps = 1.0 / (f64::from(frequency) * f64::from(dt));
        let largest_dt = 1.0 / (STEPS_PER_PERIOD * f64::from(frequency));
        (f64::from(dt) > largest_dt).then_some(FastMuscle { spring, frequency, steps, largest_dt })
    }
}
