//! Frames and steps per second.

/// Interval over which they are counted, in s.
const EVERY: f64 = 0.5;

/// Rates over the last half second.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rates {
    /// Frames per second.
    pub frames: f64,
    /// Steps per second.
    pub steps: f64,
    since: f64,
    frames_since: u64,
    steps_then: u64,
}

impl Rates {
    /// Counts a frame; `steps` is the total number of steps.
    pub fn frame(&mut self, now: f64, steps: u64) {
        self.frames_since += 1;
        let passed = now - self.since;
        if passed >= EVERY {
            self.frames = self.frames_since as f64 / passed;
            // After a reset the number of steps starts from 0 again.
            self.steps = steps.saturating_sub(self.steps_then) as f64 / passed;
            (self.since, self.frames_since, self.steps_then) = (now, 0, steps);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_counts_per_second() {
        let mut rates = Rates::default();
        for frame in 1..=100_u64 {
            rates.frame(frame as f64 * 0.02, 3 * frame);
        }
        assert!((rates.frames - 50.0).abs() < 2.5, "{rates:?}");
        assert!((rates.steps - 150.0).abs() < 7.5, "{rates:?}");
        rates.frame(2.6, 0);
        assert_eq!(rates.steps, 0.0);
    }
}
