//! Chooses how many steps ahead AABBs and lists are built. The number is found by trials that count work and do not measure
//! time, so that a run can be reproduced.
//!
//! 0 steps stands for exact lists (see `simulation/exact.rs`).
//!
//! Lists for more steps are rebuilt more rarely, but they are longer and so cost more in every step. Which effect is stronger
//! depends on how the bodies move. Lists hardly last while bodies fly about; nearly all lists last while bodies are at rest.

use crate::settings::BroadPhase;

/// Maximum number of steps ahead. Results do not depend on it.
const MOST: f32 = 32.0;
/// Number of steps of a trial that follows exact lists. Lists for one or two steps are seldom cheaper than exact lists,
/// even where lists for more steps are.
const AFTER_EXACT: f32 = 4.0;
/// If lists are rebuilt in more than this fraction of the steps, exact lists are tried before longer ones.
const OFTEN: f32 = 0.8;
/// Exact lists that did not pay are tried again when the cost of a step exceeds their cost then by this factor.
const GROWN: f32 = 1.15;
/// A trial is kept if it lowers the cost of a step to less than this fraction.
const WORTH: f32 = 0.97;
/// If lists are rebuilt more than this many times as often as intended, the lookahead becomes the number of steps that they
/// lasted, without a trial.
const SHORT_LIVED: f32 = 3.0;
/// If lists need more memory and take more than this number of words per mover, the lookahead is shortened before more memory
/// is allocated.
const LONG: f32 = 20.0;
/// The same for scenes with rods, whose neighbours are many and costly to find. In a scene of rods at rest, lists of 23 words
/// per mover must be rebuilt in every step, lists of 29 words in every fourth.
const LONG_OF_RODS: f32 = 36.0;
/// Estimated relative growth of lists when the number of steps ahead doubles. In scenes with rods, it is multiplied by the
/// current number of steps. Lists that do not fit cost a rejected step.
const GROWTH: f32 = 0.15;
/// Maximum number of batches between two trials, after trials that did not pay.
const LONGEST_PAUSE: u32 = 8;

// Costs in ns per mover on a large GPU, measured by timestamps. Only their ratios matter.
/// Rebuilding a list, regardless of its length.
const BUILD: f32 = 0.2;
/// Finding one entry.
const FIND: f32 = 0.04;
/// Rebuilding an exact list, regardless of its length, and finding one of its entries: AABBs and cells are smaller.
const BUILD_EXACT: f32 = 0.1;
/// See [`BUILD_EXACT`].
const FIND_EXACT: f32 = 0.017;
/// Reading one entry in all stages of a step.
const LOOK: f32 = 0.008;
/// The same with a contact law with history, whose kernel is long: its threads wait longer for each other.
const LOOK_OF_LAW: f32 = 0.016;
/// Repeating a rejected step and the steps submitted after it, about three steps in all.
const REJECTION: f32 = 4.0;
/// Testing one other object, in brute force.
const TEST: f32 = 0.004;

// Costs in ns per step, independent of the number of movers.
/// Dispatching a stage, whether or not it has work.
const DISPATCH: f32 = 7_000.0;
/// Memory latency of one more entry in every list, in all stages of a step.
const WAIT: f32 = 500.0;
/// The same when lists are rebuilt, because an entry has to be sorted into its list.
const WAIT_TO_FIND: f32 = 4_000.0;

fn long(has_rods: bool) -> f32 {
    if has_rods { LONG_OF_RODS } else { LONG }
}

/// What happened to the pair lists in a batch of steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lists {
    /// Fraction of the steps in which the lists were rebuilt.
    pub(super) builds_per_step: f32,
    /// Fraction of the steps that were rejected because a body left its AABB, without a change of the interval.
    pub(super) rejections_per_step: f32,
    /// Words that the entries take per mover.
    pub(super) words_per_mover: f32,
    /// Maximum number of words per mover. More would reject a step.
    pub(super) room_per_mover: f32,
    /// Number of spheres and rods.
    pub(super) movers: f32,
    pub(super) has_rods: bool,
    /// Whether the contact law has history.
    pub(super) has_history: bool,
    /// Whether lists may be exact.
    pub(super) may_be_exact: bool,
    /// Whether lists were exact.
    pub(super) are_exact: bool,
    /// Dispatches per step that rebuild lists or check whether to; 0 on the CPU.
    pub(super) dispatches: f32,
}

impl Lists {
    /// Whether lists for twice as many steps ahead can be expected to fit.
    fn may_double(&self, steps: f32) -> bool {
        let steps = if self.has_rods { steps } else { 1.0 };
        self.words_per_mover * (1.0 + GROWTH * steps) <= self.room_per_mover
    }

    /// The cost of a step per mover, in ns.
    fn cost(&self, method: BroadPhase) -> f32 {
        let search = match method {
            BroadPhase::Grid => 0.0,
            // Movers in the slab of the scene that overlaps a block.
            BroadPhase::SortAndSkip => TEST * 8.0 * self.movers.powf(2.0 / 3.0),
            _ => TEST * self.movers,
        };
        let wait = WAIT + self.builds_per_step * WAIT_TO_FIND;
        let alone = if self.dispatches > 0.0 { DISPATCH * self.dispatches + wait * self.words_per_mover } else { 0.0 };
        let (build, find) = if self.are_exact { (BUILD_EXACT, FIND_EXACT) } else { (BUILD, FIND) };
        self.builds_per_step * (build + search + find * self.words_per_mover)
            + if self.has_history { LOOK_OF_LAW } else { LOOK } * self.words_per_mover
            + REJECTION * self.rejections_per_step
            + alone / self.movers
    }
}

/// The current number of steps ahead and the state of the trials.
#[derive(Clone, Debug)]
pub(super) struct Lookahead {
    steps: f32,
    /// Factor of the number of steps in the current or the next trial.
    factor: f32,
    /// Number of steps and their cost before the current trial; `None` if no trial is under way.
    before: Option<(f32, f32)>,
    /// Cost of a step with exact lists when they were last used and did not pay any more.
    exact_cost: Option<f32>,
    /// Batches until the next trial.
    wait: u32,
    /// Length of the next pause between trials, in batches.
    pause: u32,
}

impl Default for Lookahead {
    fn default() -> Self {
        Self { steps: 1.0, factor: 2.0, before: None, exact_cost: None, wait: 1, pause: 1 }
    }
}

impl Lookahead {
    /// Starts with this number of steps.
    pub(super) fn from_steps(steps: f32) -> Self {
        Self { steps, ..Self::default() }
    }

    /// Returns the number of steps for the next batch. `seen` describes a batch that ran with the current number.
    pub(super) fn after(&mut self, seen: &Lists, method: BroadPhase) -> f32 {
        let cost = seen.cost(method);
        match self.before.take() {
            // After exact lists, the cost decides.
            before if seen.builds_per_step * self.steps > SHORT_LIVED && before.is_none_or(|(steps, _)| steps > 0.0) => {
                self.steps = (1.0 / seen.builds_per_step).max(1.0);
                self.factor = 2.0;
                self.rest();
            }
            Some((steps, before)) if cost < WORTH * before => {
                if steps == 0.0 {
                    self.exact_cost = Some(before);
                }
                self.pause = 1;
                self.begin_trial(cost, seen);
            }
            Some((steps, _)) => {
                if seen.are_exact {
                    self.exact_cost = Some(cost);
                }
                self.steps = steps;
                self.factor = 1.0 / self.factor;
                self.rest();
            }
            None if self.exact_lists_may_pay(seen, cost) => {
                (self.before, self.factor, self.steps) = (Some((self.steps, cost)), 0.5, 0.0);
            }
            None if self.wait > 0 => self.wait -= 1,
            None => self.begin_trial(cost, seen),
        }
        self.steps
    }

    /// Whether exact lists are to be tried although no trial is due.
    fn exact_lists_may_pay(&self, seen: &Lists, cost: f32) -> bool {
        seen.may_be_exact && !seen.are_exact && self.exact_cost.is_some_and(|before| cost > GROWN * before)
    }

    /// Whether exact lists are being tried, or others in place of them. Such a trial can be short: the costs differ by much, and a
    /// trial of the wrong kind is expensive.
    pub(super) fn changes_exactness(&self) -> bool {
        self.before.is_some_and(|(steps, _)| (steps == 0.0) != (self.steps == 0.0))
    }

    /// Words per mover that lists may take if memory holds `capacity` words per mover.
    pub(super) fn room(capacity: f32, has_rods: bool) -> f32 {
        capacity.max(long(has_rods))
    }

    /// Shortens the lookahead after lists did not fit that would take `words_per_mover`. Returns the new number of steps, or
    /// `None` if fewer steps would not help.
    pub(super) fn shorter(&mut self, words_per_mover: f32, has_rods: bool) -> Option<f32> {
        if self.steps <= 1.0 || words_per_mover <= long(has_rods) {
            return None;
        }
        let before = self.before.take();
        self.factor = 2.0;
        self.rest();
        // A trial after exact lists ends.
        self.steps = if before.is_some_and(|(steps, _)| steps == 0.0) { 0.0 } else { (0.5 * self.steps).max(1.0) };
        Some(self.steps)
    }

    /// Ends a trial of more steps whose lists did not last. Returns the number of steps before it, or `None` if there was no
    /// such trial.
    pub(super) fn give_up(&mut self) -> Option<f32> {
        let (steps, _) = self.before.take_if(|(steps, _)| *steps < self.steps)?;
        self.steps = steps;
        self.rest();
        Some(steps)
    }

    /// Tries more steps in the next batch, because lists may now be rebuilt more rarely. Does nothing during a trial.
    pub(super) fn hurry(&mut self) {
        if self.before.is_none() {
            (self.factor, self.wait, self.pause) = (2.0, 0, 1);
        }
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

    fn begin_trial(&mut self, cost: f32, seen: &Lists) {
        if self.steps == 1.0 && self.pause == 1 && seen.may_be_exact && seen.builds_per_step > OFTEN {
            self.factor = 0.5;
        }
        let tried = self.next(seen.may_be_exact);
        if tried == self.steps || (tried > self.steps && !seen.may_double(self.steps)) {
            // The limit is reached, so the next trial goes the other way.
            self.factor = 1.0 / self.factor;
            self.wait = self.pause;
            return;
        }
        self.before = Some((self.steps, cost));
        self.steps = tried;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A batch of a million movers whose lists were rebuilt in every step.
    const SEEN: Lists = Lists {
        builds_per_step: 1.0,
        rejections_per_step: 0.0,
        words_per_mover: 10.0,
        room_per_mover: 50.0,
        movers: 1e6,
        has_rods: false,
        has_history: false,
        may_be_exact: false,
        are_exact: false,
        dispatches: 0.0,
    };

    /// Runs `batches` batches. At a lookahead of `steps`, lists take `words(steps)` words per mover and `builds(steps)`
    /// rebuilds per step. Returns the lookahead after each batch.
    fn settled(batches: u32, words: fn(f32) -> f32, builds: fn(f32) -> f32) -> Vec<f32> {
        let mut lookahead = Lookahead::default();
        let mut steps = lookahead.steps;
        let mut all = Vec::new();
        for _ in 0..batches {
            let seen = Lists { builds_per_step: builds(steps), words_per_mover: words(steps), ..SEEN };
            steps = lookahead.after(&seen, BroadPhase::Grid);
            all.push(steps);
        }
        all
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
        let mut lookahead = Lookahead::from_steps(8.0);
        let seen = Lists { builds_per_step: 0.5, words_per_mover: 20.0, ..SEEN };
        assert_eq!(lookahead.after(&seen, BroadPhase::Grid), 2.0);
        let seen = Lists { builds_per_step: 0.9, ..seen };
        assert_eq!(lookahead.after(&seen, BroadPhase::Grid), 2.0, "that is nearly as often as intended");
    }

    /// Words and rebuilds per step at a lookahead.
    fn lists_at(steps: f32, words: f32, builds: f32) -> Lists {
        Lists { words_per_mover: words, builds_per_step: builds, may_be_exact: true, are_exact: steps == 0.0, ..SEEN }
    }

    #[test]
    fn exact_lists_are_kept_while_lists_do_not_last() {
        let fall = |steps: f32| if steps == 0.0 { lists_at(steps, 6.0, 2.0) } else { lists_at(steps, 20.0 + 4.0 * steps, 1.0) };
        let rest = |steps: f32| {
            if steps == 0.0 { lists_at(steps, 6.0, 1.0) } else { lists_at(steps, 10.0 + 0.02 * steps, 1.0 / steps) }
        };
        let mut lookahead = Lookahead::default();
        let mut run = |batches: u32, lists: &dyn Fn(f32) -> Lists| -> Vec<f32> {
            (0..batches)
                .map(|_| {
                    let seen = lists(lookahead.steps);
                    lookahead.after(&seen, BroadPhase::Grid)
                })
                .collect()
        };
        let falling = run(200, &fall);
        assert_eq!(falling[..2], [1.0, 0.0], "exact lists are the first trial");
        assert!(share_at(&falling, 0.0) > 0.8, "{falling:?}");
        let resting = run(200, &rest);
        assert!(share_at(&resting, 32.0) > 0.8, "{resting:?}");
        // Where exact lists did not pay, they are tried again as soon as the other lists become longer.
        let begin = |steps: f32| if steps == 0.0 { lists_at(steps, 6.0, 2.0) } else { lists_at(steps, 3.0 + 3.0 * steps, 1.0) };
        let mut lookahead = Lookahead::default();
        for _ in 0..100 {
            lookahead.after(&begin(lookahead.steps), BroadPhase::Grid);
        }
        let soon = (1..).find(|_| lookahead.after(&fall(lookahead.steps), BroadPhase::Grid) == 0.0);
        assert!(soon < Some(3), "{soon:?}");
        let mut lookahead = Lookahead::default();
        let mut run = |batches: u32, lists: &dyn Fn(f32) -> Lists| -> Vec<f32> {
            (0..batches)
                .map(|_| {
                    let seen = lists(lookahead.steps);
                    lookahead.after(&seen, BroadPhase::Grid)
                })
                .collect()
        };
        let never = run(200, &|steps: f32| Lists { may_be_exact: false, ..fall(steps) });
        assert!(never.iter().all(|steps| *steps >= 1.0), "{never:?}");
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
    fn the_lookahead_is_shortened_before_memory_grows() {
        let mut lookahead = Lookahead { steps: 3.0, ..Lookahead::default() };
        assert_eq!(lookahead.shorter(10.0, false), None, "there is room for that many");
        assert_eq!(lookahead.shorter(100.0, true), Some(1.5));
        assert_eq!(lookahead.shorter(100.0, true), Some(1.0));
        assert_eq!(lookahead.shorter(100.0, true), None, "they are what one step needs");
        let mut after_exact = Lookahead { steps: 4.0, before: Some((0.0, 1.0)), ..Lookahead::default() };
        assert_eq!(after_exact.shorter(100.0, false), Some(0.0));
    }

    #[test]
    fn lists_that_may_not_fit_are_not_tried() {
        // Lists take 44 words at 8 steps and 48 at 16. 16 steps would make each step cheaper, but the lists may not fit.
        let all = settled(200, |steps| 40.0 + 0.5 * steps, |steps| 1.0 / steps);
        assert!(all.iter().all(|steps| *steps <= 8.0), "{all:?}");
        assert!(share_at(&all, 8.0) > 0.8, "{all:?}");
        let lists = Lists { builds_per_step: 0.25, words_per_mover: 29.0, room_per_mover: 36.0, ..SEEN };
        assert!(lists.may_double(4.0));
        assert!(!Lists { has_rods: true, ..lists }.may_double(4.0), "lists of rods grow faster");
    }

    #[test]
    fn few_bodies_on_a_device_get_a_longer_lookahead() {
        // Twice the words for a quarter of seven dispatches pays for a thousand movers, but not for a million.
        let cost = |movers: f32, words: f32, dispatches: f32| {
            let lists = Lists { words_per_mover: words, movers, dispatches, ..SEEN };
            lists.cost(BroadPhase::Grid)
        };
        assert!(cost(1e3, 16.0, 1.75) < cost(1e3, 8.0, 7.0));
        assert!(cost(1e6, 16.0, 1.75) > cost(1e6, 8.0, 7.0));
    }

    #[test]
    fn repeated_steps_cost_more_than_rebuilt_lists() {
        let lists = |builds_per_step: f32, rejections_per_step: f32| {
            let lists = Lists { builds_per_step, rejections_per_step, words_per_mover: 14.0, ..SEEN };
            lists.cost(BroadPhase::Grid)
        };
        // Halving the rebuilds pays with one rejected step in 32, but not with one in ten.
        assert!(lists(0.5, 1.0 / 32.0) < lists(1.0, 0.0));
        assert!(lists(0.5, 0.1) > lists(1.0, 0.0));
    }

    #[test]
    fn a_trial_is_given_up_and_repeated_when_it_may_pay() {
        let mut lookahead = Lookahead::default();
        assert_eq!(lookahead.give_up(), None, "nothing is being tried");
        let seen = SEEN;
        let until_trial = |lookahead: &mut Lookahead| (1..).find(|_| lookahead.after(&seen, BroadPhase::Grid) == 2.0);
        until_trial(&mut lookahead);
        assert_eq!(lookahead.give_up(), Some(1.0));
        let after_rest = until_trial(&mut lookahead);
        assert_eq!(lookahead.give_up(), Some(1.0));
        lookahead.hurry();
        assert!(until_trial(&mut lookahead) < after_rest);
    }

    #[test]
    fn lists_cost_more_with_brute_force() {
        let lists = Lists { movers: 10_000.0, ..SEEN };
        assert!(lists.cost(BroadPhase::BruteForce) > 10.0 * lists.cost(BroadPhase::Grid));
    }
}
