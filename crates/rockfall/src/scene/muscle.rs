//! Muscles: springs whose rest length oscillates.

use crate::error::{Error, Result};
use crate::scene::checks::{invalid, not_negative};

/// Makes the rest length of a [`Spring`](crate::Spring) oscillate about its constant `l`: l (1 + A sin(2 pi (F t + P))), where t is the time since
/// the start of the simulation (docs/physics section 4.9).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Muscle {
    /// Amplitude A as a share of the spring's rest length, from -1 to 1.
    pub amplitude: f32,
    /// Frequency F in 1/s, not negative.
    pub frequency: f32,
    /// Phase P in turns. Whole turns do not matter.
    pub phase: f32,
}

impl Muscle {
    /// Creates a muscle from its amplitude as a share of the rest length, its frequency in 1/s and its phase in turns.
    pub fn new(amplitude: f32, frequency: f32, phase: f32) -> Self {
        Self { amplitude, frequency, phase }
    }

    pub(crate) fn validate(&self) -> Result<()> {
        if !(-1.0..=1.0).contains(&self.amplitude) {
            return Err(invalid("muscle.amplitude", self.amplitude, "a number from -1 to 1"));
        }
        not_negative("muscle.frequency", self.frequency)?;
        if !self.phase.is_finite() {
            return Err(Error::Invalid {
                field: "muscle.phase",
                value: self.phase.to_string(),
                expected: "a finite number of turns",
            });
        }
        Ok(())
    }

    /// The muscle that begins where this one is after `time` seconds. The phase is from 0 to 1.
    pub(crate) fn after(&self, time: f64) -> Self {
        let turns = (f64::from(self.frequency) * time).rem_euclid(1.0) + f64::from(self.phase);
        // Rounding to f32 may give 1, which is the same phase as 0.
        let phase = turns.rem_euclid(1.0) as f32 % 1.0;
        Self { phase, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_later_muscle_begins_where_the_earlier_one_is() {
        let muscle = Muscle::new(0.3, 2.5, -0.25);
        assert_eq!(muscle.after(0.1).phase, 0.0);
        assert_eq!(muscle.after(0.5), Muscle::new(0.3, 2.5, 0.0));
        assert_eq!(muscle.after(1.3), Muscle::new(0.3, 2.5, 0.0));
        assert_eq!(Muscle::new(0.3, 1.0, -1e-12).after(0.0).phase, 0.0);
    }
}
