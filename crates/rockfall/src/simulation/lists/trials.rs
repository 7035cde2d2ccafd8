//! Finds the lookahead by trials: for how many steps ahead lists are cheapest. 0 steps stand for exact lists.
//!
//! Lists for more steps are rebuilt more rarely, but they are longer and so cost more in every step. Which effect is stronger
//! depends on how the bodies move. Lists hardly last while bodies fly about; nearly all lists last while bodies are at rest.

use crate::simulation::lists::cost::{ListFacts, Usage};

/// Maximum number of steps ahead.
const MOST: f32 = 32.0;
/// Number of steps of a trial that follows exact lists. Lists for one or two steps are seldom cheaper than exact lists,
/// even where lists for more steps are.
const AFTER_EXACT: f32 = 4.0;
/// If lists are rebuilt in more than this fraction of the steps, exact lists are tried before longer ones.
const OFTEN: f32 = 0.8;
/// Exact lists that were given up are tried again when the cost of a step exceeds [`Trials::exact_cost`] by this factor.
const GROWN: f32 = 1.15;
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
    /// Cost of a step with exact lists at the time when they were last given up; `None` if they never were.
    exact_cost: Option<f32>,
    /// Windows until the next trial.
    wait: u32,
    /// Length of the next pause between trials, in windows.
    pause: u32,
}

impl Trials {
    /// Starts with this number of steps.
    pub(super) fn from_steps(steps: f32) -> Self {
        Self { steps, factor: 2.0, before: None, exact_cost: None, wait: 1, pause: 1 }
    }

    /// Chooses the number of steps for the next window. `used` describes a window with the current number.
    pub(super) fn next_window(&mut self, facts: &ListFacts, used: &Usage) {
        let cost = facts.cost(used);
        match self.before.take() {
            // In a trial that follows exact lists, the cost decides instead.
            before if used.builds * self.steps > SHORT_LIVED && before.is_none_or(|(steps, _)| steps > 0.0) => {
                self.steps = (1.0 / used.builds).max(1.0);
                self.factor = 2.0;
                self.rest();
            }
            Some((steps, before)) if cost < WORTH * before => {
                if steps == 0.0 {
                    self.exact_cost = Some(before);
                }
                self.pause = 1;
                self.begin_trial(cost, facts, used);
            }
            Some((steps, _)) => {
                if used.exact {
                    self.exact_cost = Some(cost);
                }
                self.steps = steps;
                self.factor = 1.0 / self.factor;
                self.rest();
            }
            None if self.exact_lists_may_pay(facts, used, cost) => {
                (self.before, self.factor, self.steps) = (Some((self.steps, cost)), 0.5, 0.0);
            }
            None if self.wait > 0 => self.wait -= 1,
            None => self.begin_trial(cost, facts, used),
        }
    }

    /// Whether exact lists are to be tried although no trial is due.
    fn exact_lists_may_pay(&self, facts: &ListFacts, used: &Usage, cost: f32) -> bool {
        facts.may_be_exact && !used.exact && self.exact_cost.is_some_and(|before| cost > GROWN * before)
    }

    /// Whether the current trial compares exact lists with lists that have a margin. Such a trial can be short: the costs differ by
    /// much, and a trial of the wrong kind is expensive.
    pub(super) fn changes_exactness(&self) -> bool {
        self.before.is_some_and(|(steps, _)| (steps == 0.0) != (self.steps == 0.0))
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
    fn next(&self, may_be_exact: bool) -> f32 {
        match self.factor > 1.0 {
            true if self.steps == 0.0 => AFTER_EXACT,
            false if self.steps == 0.0 || (self.steps == 1.0 && may_be_exact) => 0.0,
            _ => (self.steps * self.factor).clamp(1.0, MOST),
        }
    }

    fn begin_trial(&mut self, cost: f32, facts: &ListFacts, used: &Usage) {
        if self.steps == 1.0 && self.pause == 1 && facts.may_be_exact && used.builds > OFTEN {
            self.factor = 0.5;
        }
        let tried = self.next(facts.may_be_exact);
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
    fn exact_lists_are_kept_while_lists_do_not_last() {
        let facts = ListFacts { may_be_exact: true, ..MANY };
        let exact = |builds: f32| Usage { builds, words: 6.0, exact: true, ..USED };
        let fall = |steps: f32| if steps == 0.0 { exact(2.0) } else { Usage { words: 20.0 + 4.0 * steps, ..USED } };
        let rest = |steps: f32| {
            if steps == 0.0 { exact(1.0) } else { Usage { words: 10.0 + 0.02 * steps, builds: 1.0 / steps, ..USED } }
        };
        let mut trials = Trials::from_steps(1.0);
        let falling = run(&mut trials, &facts, 200, &fall);
        assert_eq!(falling[..2], [1.0, 0.0], "exact lists are the first trial");
        assert!(share_at(&falling, 0.0) > 0.8, "{falling:?}");
        let resting = run(&mut trials, &facts, 200, &rest);
        assert!(share_at(&resting, 32.0) > 0.8, "{resting:?}");
        // Where exact lists did not pay, they are tried again as soon as the other lists become longer.
        let begin = |steps: f32| if steps == 0.0 { exact(2.0) } else { Usage { words: 3.0 + 3.0 * steps, ..USED } };
        let mut trials = Trials::from_steps(1.0);
        run(&mut trials, &facts, 100, &begin);
        assert!(run(&mut trials, &facts, 2, &fall).contains(&0.0));
        let never = run(&mut Trials::from_steps(1.0), &MANY, 200, &fall);
        assert!(never.iter().all(|steps| *steps >= 1.0), "{never:?}");
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
        assert_eq!(after(tried(0.0, 4.0), 2.0), 0.0, "exact lists return");
        assert_eq!(after(tried(16.0, 8.0), 4.0), 4.0, "a trial of fewer steps does not help");
        assert_eq!(after(Trials::from_steps(1.5), 0.75), 1.0);
    }
}
