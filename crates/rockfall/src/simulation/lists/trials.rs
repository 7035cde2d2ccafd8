//! Finds the lookahead by trials: for how many steps ahead lists are cheapest.
//!
//! Lists for more steps are rebuilt more rarely, but they are longer and so cost more in every step. Which effect is stronger
//! depends on how the bodies move. Lists hardly last while bodies fly about; nearly all lists last while bodies are at rest.

use crate::simulation::lists::cost::{ListFacts, Usage};

/// Maximum number of steps ahead.
const MOST: f32 = 32.0;
/// A trial is kept if it lowers the cost of a step to less than this fraction.
const WORTH: f32 = 0.97;
/// If lists are rebuilt more than this many times as often as intended, the lookahead becomes the number of steps that they
/// lasted, without a trial.
const SHORT_LIVED: f32 = 3.0;
/// Maximum number of windows between two trials, after trials that did not pay.
const LONGEST_PAUSE: u32 = 8;

/// The lookahead and the state of its trials.
#[derive(Clone, Debug)]
pub(super) struct Trials {
    /// Number of steps ahead.
    pub(super) steps: f32,
    /// Factor of the number of steps in the current or the next trial.
    factor: f32,
    /// Number of steps ahead before the current trial, and the cost of a step with it; `None` if no trial is under way.
    before: Option<(f32, f32)>,
    /// Windows until the next trial.
    wait: u32,
    /// Length of the next pause between trials, in windows.
    pause: u32,
}

impl Trials {
    /// Starts with this number of steps.
    pub(super) fn from_steps(steps: f32) -> Self {
        Self { steps, factor: 2.0, before: None, wait: 1, pause: 1 }
    }

    /// Chooses the number of steps for the next window. `used` describes a window with the current number.
    pub(super) fn next_window(&mut self, facts: &ListFacts, used: &Usage) {
        let cost = facts.cost(used);
        match self.before.take() {
            _ if used.builds * self.steps > SHORT_LIVED => {
                self.steps = (1.0 / used.builds).max(1.0);
                self.factor = 2.0;
                self.rest();
            }
            Some((_, before)) if cost < WORTH * before => {
                self.pause = 1;
                self.begin_trial(cost, facts, used);
            }
            Some((steps, _)) => {
                self.steps = steps;
                self.factor = 1.0 / self.factor;
                self.rest();
            }
            None if self.wait > 0 => self.wait -= 1,
            None => self.begin_trial(cost, facts, used),
        }
    }

    /// Shortens the lookahead without a trial. If a trial of more steps is under way, it has failed, and the lookahead before it
    /// returns. Otherwise the lookahead becomes `steps`, at least 1.
    pub(super) fn retreat(&mut self, steps: f32) {
        let tried = self.before.take().filter(|(before, _)| *before < self.steps);
        self.steps = tried.map_or(steps.max(1.0), |(before, _)| before);
        self.factor = 2.0;
        self.rest();
    }

    /// Pauses the trials. Each pause is twice as long as the one before, up to [`LONGEST_PAUSE`].
    fn rest(&mut self) {
        self.wait = self.pause;
        self.pause = (2 * self.pause).min(LONGEST_PAUSE);
    }

    /// Number of steps of the next trial.
    fn next(&self) -> f32 {
        (self.steps * self.factor).clamp(1.0, MOST)
    }

    fn begin_trial(&mut self, cost: f32, facts: &ListFacts, used: &Usage) {
        let tried = self.next();
        if tried == self.steps || (tried > self.steps && !facts.may_double(self.steps, used.words)) {
            // The limit is reached, so the next trial goes the other way.
            self.factor = 1.0 / self.factor;
            return;
        }
        self.before = Some((self.steps, cost));
        self.steps = tried;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::lists::cost::tests::{MANY, USED};

    /// Runs windows in which lists were used as `used` says for a lookahead. Returns the lookahead after each.
    fn run(trials: &mut Trials, facts: &ListFacts, windows: u32, used: &dyn Fn(f32) -> Usage) -> Vec<f32> {
        let next = |_| {
            trials.next_window(facts, &used(trials.steps));
            trials.steps
        };
        (0..windows).map(next).collect()
    }

    /// The lookaheads of some windows. At a lookahead of `steps`, lists take `words(steps)` words per mover and `builds(steps)`
    /// rebuilds per step.
    fn settled(windows: u32, words: fn(f32) -> f32, builds: fn(f32) -> f32) -> Vec<f32> {
        let used = |steps: f32| Usage { builds: builds(steps), words: words(steps), ..USED };
        run(&mut Trials::from_steps(1.0), &MANY, windows, &used)
    }

    fn share_at(all: &[f32], steps: f32) -> f32 {
        let late = &all[all.len() / 2..];
        late.iter().filter(|s| **s == steps).count() as f32 / late.len() as f32
    }

    #[test]
    fn lists_that_never_last_are_built_for_one_step() {
        let all = settled(200, |steps| 10.0 + 4.0 * steps, |_| 1.0);
        assert!(share_at(&all, 1.0) > 0.9, "{all:?}");
    }

    #[test]
    fn the_lookahead_is_cut_at_once_if_lists_last_much_shorter_than_intended() {
        let mut trials = Trials::from_steps(8.0);
        let mut after = |builds: f32| run(&mut trials, &MANY, 1, &|_| Usage { builds, words: 20.0, ..USED });
        assert_eq!(after(0.5), [2.0]);
        assert_eq!(after(0.9), [2.0], "that is nearly as often as intended");
    }

    #[test]
    fn bodies_at_rest_get_the_longest_lookahead() {
        let all = settled(200, |steps| 10.0 + 0.01 * steps, |steps| 1.0 / steps);
        assert!(share_at(&all, 32.0) > 0.8, "{all:?}");
    }

    #[test]
    fn the_cheapest_lookahead_is_found_and_kept() {
        // The cost 0.008 w + (0.2 + 0.04 w) / s with w = 8 + 5 s is least at s = 3.6, so at 4 among the powers of two.
        let all = settled(400, |steps| 8.0 + 5.0 * steps, |steps| 1.0 / steps);
        assert!(share_at(&all, 4.0) > 0.8, "{all:?}");
    }

    #[test]
    fn lists_that_may_not_fit_are_not_tried() {
        // Lists take 44 words at 8 steps and 48 at 16. 16 steps would make each step cheaper, but the lists may not fit.
        let all = settled(200, |steps| 40.0 + 0.5 * steps, |steps| 1.0 / steps);
        assert!(all.iter().all(|steps| *steps <= 8.0), "{all:?}");
        assert!(share_at(&all, 8.0) > 0.8, "{all:?}");
    }

    #[test]
    fn a_retreat_ends_a_trial_of_more_steps() {
        let tried = |before: f32, steps: f32| Trials { before: Some((before, 1.0)), ..Trials::from_steps(steps) };
        let after = |mut trials: Trials, steps: f32| {
            trials.retreat(steps);
            assert_eq!(trials.before, None);
            trials.steps
        };
        assert_eq!(after(tried(4.0, 8.0), 2.0), 4.0);
        assert_eq!(after(tried(16.0, 8.0), 4.0), 4.0, "a trial of fewer steps does not help");
        assert_eq!(after(Trials::from_steps(1.5), 0.75), 1.0);
    }
}
