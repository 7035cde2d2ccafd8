//! In every how many-th step of a batch lists may be made: by trying, with counts and not with a clock.
//!
//! On a device every stage of a step costs a dispatch, whether or not it has something to do, and where lists last for some
//! steps those that make lists have nothing to do in most. They may be left out of all but every S-th step, if lists are made
//! that last for S. Where a body is pushed out of its AABB in between, the step is void and run again, lists first. Once in a batch of
//! steps that costs less than lists that are made more often; after a second time they are made twice as often for a while. Among a
//! million bodies some always ask for lists; most of those do not leave after all.

/// The longest.
pub(super) const LONGEST: u32 = 8;
/// Batches without such a step before the next trial, after trials that failed: one costs a void step, little beside what a batch gains
/// whose lists last.
const LONGEST_PAUSE: u32 = 2;

/// The present interval, and what came of it.
#[derive(Clone, Debug)]
pub(super) struct Interval {
    steps: u32,
    /// Batches since the last change.
    calm: u32,
    /// Batches before the next trial.
    pause: u32,
    /// Whether they did not last in one step of this batch.
    forgiven: bool,
}

impl Default for Interval {
    fn default() -> Self {
        Self { steps: 1, calm: 0, pause: 1, forgiven: false }
    }
}

impl Interval {
    /// Begins with the lookahead that there is.
    pub(super) fn long() -> Self {
        Self { steps: LONGEST, ..Self::default() }
    }

    /// Steps, for lists that are made for so many steps ahead.
    pub(super) fn steps(&self, lookahead: f32) -> u32 {
        // 1, 2, 4 or 8, not more than the lookahead.
        let least = lookahead.max(1.0) as u32;
        self.steps.min(1 << least.ilog2())
    }

    /// After a batch in which lists lasted. Whether they may be made more rarely now.
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

    /// Whether a step in which they did not last, at this interval, changes nothing: the first one of a batch.
    pub(super) fn forgives(&mut self, interval: u32) -> bool {
        interval > 1 && !std::mem::replace(&mut self.forgiven, true)
    }

    /// After a step in which they did not, at this interval. Whether that may have come of it.
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
    fn what_lasts_is_made_more_rarely_but_not_than_it_lasts() {
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
        assert!(!interval.forgives(1), "no interval is to blame");
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
