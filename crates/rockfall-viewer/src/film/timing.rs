//! When the pictures of a film are taken.

/// When the pictures of a film are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Steps that the film is of.
    pub steps: u64,
    /// Time step in s.
    pub dt: f32,
    /// Pictures a second.
    pub fps: u32,
    /// Simulated seconds in a second of film; 1: real time.
    pub speed: f64,
}

/// A moment between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Steps done before it.
    pub step: u64,
    /// How much of the next step has passed, from 0 to less than 1.
    pub blend: f32,
}

impl Timing {
    /// The time step as it was written: 0.02, not 0.019999999552965164.
    fn step_seconds(&self) -> f64 {
        self.dt.to_string().parse().unwrap_or(f64::from(self.dt))
    }

    /// Number of pictures: one at the start, and as many as begin before the last step has ended.
    pub fn pictures(&self) -> u64 {
        let seconds = self.steps as f64 * self.step_seconds() / self.speed;
        // A rounding error must not lose the last one.
        (seconds * f64::from(self.fps) + 1e-6).floor() as u64 + 1
    }

    /// When picture `index` is taken.
    pub fn moment(&self, index: u64) -> Moment {
        let steps = index as f64 * self.speed / f64::from(self.fps) / self.step_seconds();
        let step = (steps + 1e-5).floor();
        let blend = (steps - step) as f32;
        if step as u64 >= self.steps || blend < 1e-4 {
            return Moment { step: (step as u64).min(self.steps), blend: 0.0 };
        }
        Moment { step: step as u64, blend }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn real_time_at_the_rate_of_the_steps_shows_every_state_as_it_is() {
        let timing = Timing { steps: 100, dt: 0.02, fps: 50, speed: 1.0 };
        assert_eq!(timing.pictures(), 101);
        for index in 0..=100 {
            assert_eq!(timing.moment(index), Moment { step: index, blend: 0.0 });
        }
    }

    #[test]
    fn other_rates_fall_between_states() {
        let timing = Timing { steps: 10, dt: 0.02, fps: 30, speed: 1.0 };
        // 0.2 s at 30 a second: at 0, 1/30, ... 6/30 s.
        assert_eq!(timing.pictures(), 7);
        let second = timing.moment(1);
        assert_eq!(second.step, 1);
        assert!((second.blend - 2.0 / 3.0).abs() < 1e-5);
        assert_eq!(timing.moment(6), Moment { step: 10, blend: 0.0 });
    }

    #[test]
    fn slow_motion_takes_longer() {
        let timing = Timing { steps: 10, dt: 0.02, fps: 30, speed: 0.5 };
        assert_eq!(timing.pictures(), 13);
        assert_eq!(timing.moment(3).step, 2);
        assert!((timing.moment(3).blend - 0.5).abs() < 1e-5);
    }
}
