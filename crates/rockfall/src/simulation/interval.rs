//! Chooses how often pair lists may be rebuilt within a batch, in steps. The interval is found by trials that count work and do
//! not measure time.
//!
//! On a device every stage costs a dispatch, whether or not it has work. If lists last for several steps, the stages that
//! rebuild them have no work in most steps. They can be left out of all but every S-th step if the lists are built to last S
//! steps. If a body leaves its AABB in between, the step is rejected, the lists are rebuilt, and the step is repeated. One such
//! step in a batch costs less than rebuilding lists more often. After a second one the interval is halved for a while. Among a
//! million bodies some always request new lists, but most of those do not leave their AABBs in the end.

/// Longest interval, in steps.
pub(super) const LONGEST: u32 = 8;
/// Maximum number of batches without a rejected step before the next trial, after trials that failed. A failed trial costs one
/// rejected step, which is little compared with what a batch gains if its lists last.
const LONGEST_PAUSE: u32 = 2;

/// The current interval and the state of its trials.
#[derive(Clone, Debug)]
pub(super) struct Interval {
    steps: u32,
    /// Batches since the last change.
    calm: u32,
    /// Batches before the next trial.
    pause: u32,
    /// Whether a step of the current batch was rejected without a change of the interval.
    forgiven: bool,
}

impl Default for Interval {
    fn default() -> Self {
        Self { steps: 1, calm: 0, pause: 1, forgiven: false }
    }
}

impl Interval {
    /// Starts with the longest interval. The lookahead still limits it.
    pub(super) fn long() -> Self {
        Self { steps: LONGEST, ..Self::default() }
    }

    /// The interval in steps, for lists that are built `lookahead` steps ahead.
    pub(super) fn steps(&self, lookahead: f32) -> u32 {
        // The interval is 1, 2, 4 or 8, and at most the lookahead.
        let least = lookahead.max(1.0) as u32;
        self.steps.min(1 << least.ilog2())
    }

    /// Records a batch in which the lists lasted. Returns whether the interval becomes longer.
    pub(super) fn lasted(&mut self) -> bool {
        self.forgiven = false;
        self.calm += 1;
        if self.calm < self.pause {
            return false;
        }
        self.calm = 0;
        if self.steps == LONGEST {
            self.pause = (self.pause / 2).max(1);
            return false;
        }
        self.steps *= 2;
        true
    }

    /// Whether a step in which the lists did not last leaves the interval unchanged. This is so for the first one of a batch,
    /// unless the interval is 1.
    pub(super) fn forgives(&mut self, interval: u32) -> bool {
        interval > 1 && !std::mem::replace(&mut self.forgiven, true)
    }

    /// Records a step in which the lists did not last, and halves the interval. Returns whether the interval may have been the
    /// cause, that is, whether it was longer than 1.
    pub(super) fn failed(&mut self, interval: u32) -> bool {
        if interval > 1 {
            *self = Self { steps: interval / 2, pause: (2 * self.pause).min(LONGEST_PAUSE), ..Self::default() };
        }
        interval > 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_grows_with_lists_that_last_up_to_the_lookahead() {
        let mut interval = Interval::default();
        assert!(interval.failed(8) && interval.failed(4) && interval.failed(2) && !interval.failed(1));
        assert_eq!(interval.steps(32.0), 1);
        for _ in 0..30 {
            interval.lasted();
        }
        assert_eq!([1.0, 3.9, 4.0, 32.0].map(|lookahead| interval.steps(lookahead)), [1, 2, 4, 8]);
    }

    #[test]
    fn one_failure_in_a_batch_is_forgiven() {
        let mut interval = Interval::long();
        for _ in 0..10 {
            assert!(interval.forgives(8) && !interval.forgives(8));
            interval.lasted();
        }
        assert_eq!(interval.steps(32.0), LONGEST);
        assert!(!interval.forgives(1), "the interval is not the cause");
    }

    #[test]
    fn trials_that_fail_become_rare() {
        let mut interval = Interval::default();
        let mut failures = 0;
        for _ in 0..1_000 {
            let steps = interval.steps(32.0);
            if interval.failed(steps) {
                failures += 1;
            } else {
                interval.lasted();
            }
        }
        // Without a pause every other batch would fail.
        assert!((300..400).contains(&failures), "{failures}");
    }
}
