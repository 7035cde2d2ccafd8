//! How many steps ahead AABBs and lists are made: by trying, with counts and not with a clock, so that a run can be repeated.
//!
//! Lists for more steps are made more rarely, and cost more in every step, for they are longer. What that comes to depends
//! on how a crowd moves: of bodies that fly about hardly any lists last, of bodies at rest nearly all do.

use crate::settings::BroadPhase;

/// Steps ahead; results do not depend on it.
const MOST: f32 = 32.0;
/// A change is kept when it makes a step so much cheaper.
const WORTH: f32 = 0.97;
/// Lists that are made so many times as often as they should be are made for as long as they last, without a trial.
const SHORT_LIVED: f32 = 3.0;
/// Lists that take more words a mover are made for fewer steps ahead, before memory is made larger for them.
const LONG: f32 = 20.0;
/// The same where there are rods, whose neighbours are many and cost much to find: at rest lists of 23 words have to be made in every
/// step, of 29 in every fourth.
const LONG_OF_RODS: f32 = 36.0;
/// Twice the steps make lists longer by about this part; where there are rods, for each of the present steps. Lists that do not fit cost
/// a void step.
const GROWTH: f32 = 0.15;
/// Batches between two trials, after trials that did not pay.
const LONGEST_PAUSE: u32 = 8;

// Costs in ns a mover on a large GPU, by timestamps; only their ratios matter.
/// Making lists, however short they are.
const BUILD: f32 = 0.2;
/// Finding an entry.
const FIND: f32 = 0.04;
/// Looking at an entry in all stages of a step.
const LOOK: f32 = 0.008;
/// Running a step again, and what was under way after it, some three steps in all.
const VOID: f32 = 4.0;
/// Looking at another object, in brute force.
const TEST: f32 = 0.004;

// Costs in ns a step, however many movers there are.
/// Dispatching a stage, whatever it has to do.
const DISPATCH: f32 = 7_000.0;
/// Waiting for memory for one entry more in every list, in all stages of a step.
const WAIT: f32 = 500.0;
/// The same where lists are made, for an entry has to find its place in the order.
const WAIT_TO_FIND: f32 = 4_000.0;

fn long(has_rods: bool) -> f32 {
    if has_rods { LONG_OF_RODS } else { LONG }
}

/// What a batch of steps did with its lists.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lists {
    /// Part of the steps in which they were made anew.
    pub(super) builds_per_step: f32,
    /// Part of the steps in which a body left its AABB, and the interval did not change.
    pub(super) rejections_per_step: f32,
    /// Words that the entries take.
    pub(super) words_per_mover: f32,
    /// The most that they may take: more would make a step void.
    pub(super) room_per_mover: f32,
    /// Spheres and rods.
    pub(super) movers: f32,
    pub(super) has_rods: bool,
    /// Dispatches a step that make lists, or look whether to; 0 without a device.
    pub(super) dispatches: f32,
}

impl Lists {
    /// Whether lists for twice so many steps ahead may be expected to fit.
    fn may_double(&self, steps: f32) -> bool {
        let steps = if self.has_rods { steps } else { 1.0 };
        self.words_per_mover * (1.0 + GROWTH * steps) <= self.room_per_mover
    }

    /// What a step cost, a mover.
    fn cost(&self, method: BroadPhase) -> f32 {
        let search = match method {
            BroadPhase::Grid => 0.0,
            // The slab of a crowd that a block of it meets.
            BroadPhase::SortAndSkip => TEST * 8.0 * self.movers.powf(2.0 / 3.0),
            _ => TEST * self.movers,
        };
        let wait = WAIT + self.builds_per_step * WAIT_TO_FIND;
        let alone = if self.dispatches > 0.0 { DISPATCH * self.dispatches + wait * self.words_per_mover } else { 0.0 };
        self.builds_per_step * (BUILD + search + FIND * self.words_per_mover)
            + LOOK * self.words_per_mover
            + VOID * self.rejections_per_step
            + alone / self.movers
    }
}

/// The present number of steps, and what is being tried.
#[derive(Clone, Debug)]
pub(super) struct Lookahead {
    steps: f32,
    /// The factor of the present or the next trial.
    factor: f32,
    /// The steps and their cost before the trial that is under way.
    before: Option<(f32, f32)>,
    /// Batches until the next trial, and how many they were last time.
    wait: u32,
    pause: u32,
}

impl Default for Lookahead {
    fn default() -> Self {
        Self { steps: 1.0, factor: 2.0, before: None, wait: 1, pause: 1 }
    }
}

impl Lookahead {
    /// Goes on from so many steps.
    pub(super) fn from_steps(steps: f32) -> Self {
        Self { steps, ..Self::default() }
    }

    /// The number of steps for the next batch, after a batch that did as told.
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

    /// Words a mover that lists may take where memory holds so many, in a scene with or without rods.
    pub(super) fn room(capacity: f32, has_rods: bool) -> f32 {
        capacity.max(long(has_rods))
    }

    /// The number of steps for lists that did not fit and would take so many words a mover; `None` where nothing is to be
    /// gained by fewer.
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

    /// The number of steps to return to, where lists for more were being tried and did not last.
    pub(super) fn give_up(&mut self) -> Option<f32> {
        let (steps, _) = self.before.take_if(|(steps, _)| *steps < self.steps)?;
        self.steps = steps;
        self.rest();
        Some(steps)
    }

    /// Lists for more steps are tried at the next chance: they may be made more rarely.
    pub(super) fn hurry(&mut self) {
        if self.before.is_none() {
            (self.factor, self.wait, self.pause) = (2.0, 0, 1);
        }
    }

    /// Longer than the last time.
    fn rest(&mut self) {
        self.wait = self.pause;
        self.pause = (2 * self.pause).min(LONGEST_PAUSE);
    }

    fn begin_trial(&mut self, cost: f32, has_room: bool) {
        let tried = (self.steps * self.factor).clamp(1.0, MOST);
        if tried == self.steps || (tried > self.steps && !has_room) {
            // At an end: the next trial goes the other way.
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

    /// What a batch of a million did that made lists in every step.
    const SEEN: Lists = Lists {
        builds_per_step: 1.0,
        rejections_per_step: 0.0,
        words_per_mover: 10.0,
        room_per_mover: 50.0,
        movers: 1e6,
        has_rods: false,
        dispatches: 0.0,
    };

    /// Goes on for so many batches with lists of `words` at one step ahead that `lasts` steps.
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
    fn lists_that_never_last_are_made_for_one_step() {
        let all = settled(200, |steps| 10.0 + 4.0 * steps, |_| 1.0);
        assert!(share_at(&all, 1.0) > 0.9, "{all:?}");
    }

    #[test]
    fn lists_that_last_much_shorter_than_meant_are_given_up_at_once() {
        let mut lookahead = Lookahead::from_steps(8.0);
        let seen = Lists { builds_per_step: 0.5, words_per_mover: 20.0, ..SEEN };
        assert_eq!(lookahead.after(&seen, BroadPhase::Grid), 2.0);
        let seen = Lists { builds_per_step: 0.9, ..seen };
        assert_eq!(lookahead.after(&seen, BroadPhase::Grid), 2.0, "that is nearly as often as meant");
    }

    #[test]
    fn what_rests_is_looked_at_far_ahead() {
        let all = settled(200, |steps| 10.0 + 0.01 * steps, |steps| 1.0 / steps);
        assert!(share_at(&all, 32.0) > 0.8, "{all:?}");
    }

    #[test]
    fn the_cheapest_in_between_is_found_and_held() {
        // Cost 0.008 w + (0.2 + 0.04 w) / s with w = 8 + 5 s: least at s = 3.6, so at 4 of the powers of two.
        let all = settled(400, |steps| 8.0 + 5.0 * steps, |steps| 1.0 / steps);
        assert!(share_at(&all, 4.0) > 0.8, "{all:?}");
    }

    #[test]
    fn lists_that_are_too_long_for_memory_are_made_shorter_first() {
        let mut lookahead = Lookahead { steps: 3.0, ..Lookahead::default() };
        assert_eq!(lookahead.shorter(10.0, false), None, "there is room for that many");
        assert_eq!(lookahead.shorter(100.0, true), Some(1.5));
        assert_eq!(lookahead.shorter(100.0, true), Some(1.0));
        assert_eq!(lookahead.shorter(100.0, true), None, "they are what one step needs");
    }

    #[test]
    fn lists_that_would_be_too_long_are_not_tried() {
        // 44 words at 8 steps, 48 at 16: that would make each step cheaper, but it is not sure to fit.
        let all = settled(200, |steps| 40.0 + 0.5 * steps, |steps| 1.0 / steps);
        assert!(all.iter().all(|steps| *steps <= 8.0), "{all:?}");
        assert!(share_at(&all, 8.0) > 0.8, "{all:?}");
        let lists = Lists { builds_per_step: 0.25, words_per_mover: 29.0, room_per_mover: 36.0, ..SEEN };
        assert!(lists.may_double(4.0));
        assert!(!Lists { has_rods: true, ..lists }.may_double(4.0), "lists of rods grow faster");
    }

    #[test]
    fn few_bodies_on_a_device_are_looked_at_further_ahead() {
        // Twice the words, a quarter of seven dispatches: that pays for a thousand movers and not for a million.
        let cost = |movers: f32, words: f32, dispatches: f32| {
            let lists = Lists { words_per_mover: words, movers, dispatches, ..SEEN };
            lists.cost(BroadPhase::Grid)
        };
        assert!(cost(1e3, 16.0, 1.75) < cost(1e3, 8.0, 7.0));
        assert!(cost(1e6, 16.0, 1.75) > cost(1e6, 8.0, 7.0));
    }

    #[test]
    fn steps_that_are_run_again_cost_more_than_lists() {
        let lists = |builds_per_step: f32, rejections_per_step: f32| {
            let lists = Lists { builds_per_step, rejections_per_step, words_per_mover: 14.0, ..SEEN };
            lists.cost(BroadPhase::Grid)
        };
        // One in 32 for half of the lists pays, one in ten does not.
        assert!(lists(0.5, 1.0 / 32.0) < lists(1.0, 0.0));
        assert!(lists(0.5, 0.1) > lists(1.0, 0.0));
    }

    #[test]
    fn a_trial_is_given_up_and_comes_again_when_it_may_pay() {
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
    fn brute_force_looks_further_ahead() {
        let lists = Lists { movers: 10_000.0, ..SEEN };
        assert!(lists.cost(BroadPhase::BruteForce) > 10.0 * lists.cost(BroadPhase::Grid));
    }
}
