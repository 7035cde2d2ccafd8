//! Chooses how many steps ahead AABBs and lists are built. The number is found by trials that count work and do not measure
//! time, so that a run can be reproduced.
//!
//! Lists for more steps are rebuilt more rarely, but they are longer and so cost more in every step. Which effect is stronger
//! depends on how the bodies move. Lists hardly last while bodies fly about; nearly all lists last while bodies are at rest.

use crate::settings::BroadPhase;

/// Maximum number of steps ahead. Results do not depend on it.
const MOST: f32 = 32.0;
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
/// Reading one entry in all stages of a step.
const LOOK: f32 = 0.008;
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
        self.builds_per_step * (BUILD + search + FIND * self.words_per_mover)
            + LOOK * self.words_per_mover
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
    /// Batches until the next trial.
    wait: u32,
    /// Length of the next pause between trials, in batches.
    pause: u32,
}

impl Default for Lookahead {
    fn default() -> Self {
        Self { steps: 1.0, factor: 2.0, before: None, wait: 1, pause: 1 }
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
            _ if seen.builds_per_step * self.steps > SHORT_LIVED => {
                self.steps = (1.0 / seen.builds_per_step).max(1.0);
                self.factor = 2.0;
                self.rest();
            }
            Some((_, before)) if cost < WORTH * before => {
                self.pause = 1;
                self.begin_trial(cost, seen.may_double(self.steps));
            }
            Some((steps, _)) => {
                self.steps = steps;
                self.factor = 1.0 / self.factor;
                self.rest();
            }
            None if self.wait > 0 => self.wait -= 1,
            None => self.begin_trial(cost, seen.may_double(self.steps)),
        }
        self.steps
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
        self.before = None;
        self.factor = 2.0;
        self.rest();
        self.steps = (0.5 * self.steps).max(1.0);
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

    fn begin_trial(&mut self, cost: f32, has_room: bool) {
        let tried = (self.steps * self.factor).clamp(1.0, MOST);
        if tried == self.steps || (tried > self.steps && !has_room) {
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
