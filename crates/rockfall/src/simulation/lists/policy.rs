//! Decides for how many steps ahead lists are built, how often they may be rebuilt, and how much room AABBs have. Results do not
//! depend on it. docs/engine.md has all rules in one table.

use crate::model::layout::words_of_rows;
use crate::model::status::Status;
use crate::physics::travel::margin_for_escape;
use crate::simulation::lists::cost::{ListFacts, Usage};
use crate::simulation::lists::trials::Trials;

/// Number of steps after which the lookahead is reconsidered.
const WINDOW: u64 = 32;
/// Initial lookahead in steps for scenes with few movers on a device. Other scenes reach their lookahead by trials.
const FEW_STEPS: f32 = 4.0;
/// Longest interval, in steps.
const LONGEST: u32 = 8;
/// If a body leaves its AABB by less than this, in units of 0.02 r, the rejected step is treated as an exception. A larger
/// distance shows that the lists were built for too many steps.
const NEAR: f32 = 1.0;
/// Additional amount by which the margin is raised after such an exception at the longest interval, in units of 0.02 r. Among
/// many millions of bodies at rest another exception would soon follow, and longer lists cost little if they are rarely
/// rebuilt.
const NEAR_STEP: f32 = 0.5;
/// Smallest AABB margin, in units of 0.02 r.
pub(in crate::simulation) const MIN_MARGIN: f32 = 2.0;
/// Factor per step by which a raised AABB margin decays. A margin that has decayed too far causes a rejected step.
const MARGIN_DECAY: f32 = 0.997;
/// The same in scenes with rods or large spheres. Their lists are so long that lengthening them costs more than a rejected
/// step.
const MARGIN_DECAY_OF_LONG: f32 = 0.99;

/// How lists are built. [`Step`](crate::model::step::Step) describes the first three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::simulation) struct ListPlan {
    pub(in crate::simulation) lookahead: f32,
    pub(in crate::simulation) interval: u32,
    pub(in crate::simulation) margin: f32,
    /// Number of these settings. Steps that were submitted with other settings say nothing about the present ones.
    pub(in crate::simulation) version: u32,
}

/// Counts since the lookahead was last reconsidered.
#[derive(Clone, Copy, Debug, Default)]
struct Window {
    steps: u64,
    builds: u32,
    /// Rejected steps in which a body left its AABB.
    rejections: u32,
    /// Whether one of them was treated as an exception.
    forgiven: bool,
}

/// The present settings, and what was observed with them.
#[derive(Clone, Debug)]
pub(in crate::simulation) struct ListPolicy {
    trials: Trials,
    margin: f32,
    /// Whether stages that rebuild lists can be left out of steps.
    may_wait: bool,
    window: Window,
    version: u32,
    /// Version of the settings with which the step was submitted that is rejected now.
    rejected_with: u32,
}

impl ListPolicy {
    /// Starts with these settings.
    pub(in crate::simulation) fn new(lookahead: f32, margin: f32) -> Self {
        let (trials, window) = (Trials::from_steps(lookahead), Window::default());
        Self { trials, margin, may_wait: false, window, version: 0, rejected_with: 0 }
    }

    /// Starts in a new scene. `few_on_device` is set for few movers on a device, where dispatches cost most.
    pub(in crate::simulation) fn start(few_on_device: bool) -> Self {
        Self::new(if few_on_device { FEW_STEPS } else { 1.0 }, MIN_MARGIN)
    }

    /// Begins steps in which stages that rebuild lists can be left out (`may_wait`) or cannot.
    pub(in crate::simulation) fn begin(&mut self, may_wait: bool) {
        self.may_wait = may_wait;
    }

    pub(in crate::simulation) fn settings(&self) -> ListPlan {
        let lookahead = self.trials.steps;
        ListPlan { lookahead, interval: self.interval(), margin: self.margin, version: self.version }
    }

    /// Steps from one opportunity to rebuild lists to the next: the largest power of two that is not above the lookahead.
    fn interval(&self) -> u32 {
        let most = if self.may_wait { self.trials.steps as u32 } else { 1 };
        (1 << most.ilog2()).min(LONGEST)
    }

    /// Evaluates the status after a portion of steps that was submitted with the settings of this version. `before` is the status
    /// before the portion.
    pub(in crate::simulation) fn observe(&mut self, facts: &ListFacts, version: u32, before: &Status, status: &Status) {
        let done = status.steps.wrapping_sub(before.steps);
        let decay = if facts.has_long_lists { MARGIN_DECAY_OF_LONG } else { MARGIN_DECAY };
        let decayed = self.margin * decay.powf(done as f32);
        self.margin = if decayed.is_finite() { decayed.max(MIN_MARGIN) } else { MIN_MARGIN };
        self.judge_repeats(version, before, status);
        if version != self.version || done == 0 || status.rejected != 0 {
            return;
        }
        self.window.steps += u64::from(done);
        self.window.builds += status.builds.wrapping_sub(before.builds);
        if self.window.steps >= WINDOW {
            let used = self.usage(words_of_rows(status.pair_rows_needed) as f32 / facts.movers);
            self.trials.next_window(facts, &used);
            self.restart();
        }
    }

    /// Judges the steps that the device repeated in a portion. If the portion began with a rejected step, the first of them was
    /// submitted earlier, maybe with other settings.
    fn judge_repeats(&mut self, version: u32, before: &Status, status: &Status) {
        if before.rejected == 0 {
            self.rejected_with = version;
        }
        for _ in 0..status.repeats.wrapping_sub(before.repeats) {
            self.escaped(f32::from_bits(status.repeat_escape), 0);
            self.rejected_with = version;
        }
    }

    /// Changes the settings after a step was rejected because a body left its AABB by `escape`, in units of 0.02 r. `attempts`
    /// is the number of earlier attempts at this step by the host. If the settings have changed since the step was submitted,
    /// the cause may be gone already, so nothing changes unless `attempts` is above 1.
    pub(in crate::simulation) fn escaped(&mut self, escape: f32, attempts: u32) {
        if attempts <= 1 && self.rejected_with != self.version {
            return;
        }
        self.window.rejections += 1;
        let interval = self.interval();
        if interval == 1 {
            self.margin = margin_after_escape(self.margin, escape, attempts);
            // The window goes on, because the margin changes the number of rebuilds little.
            self.version = self.version.wrapping_add(1);
        } else if escape >= NEAR || std::mem::replace(&mut self.window.forgiven, true) {
            // If no trial is under way, the interval becomes half as long.
            self.retreat(0.75 * interval as f32);
        } else if interval == LONGEST {
            self.margin += escape + NEAR_STEP;
        }
    }

    /// Called when lists that take `words` words per mover did not fit. Returns whether they become shorter. Otherwise they
    /// need more memory.
    pub(in crate::simulation) fn overflowed(&mut self, facts: &ListFacts, words: f32) -> bool {
        let shortens = self.trials.steps > 1.0 && words > facts.long();
        if shortens {
            self.retreat(0.5 * self.trials.steps);
        }
        shortens
    }

    fn retreat(&mut self, steps: f32) {
        self.trials.retreat(steps);
        self.restart();
    }

    /// Starts a new window. Portions that are still under way from the previous one do not count.
    fn restart(&mut self) {
        self.window = Window::default();
        self.version = self.version.wrapping_add(1);
    }

    fn usage(&self, words: f32) -> Usage {
        let Window { steps, builds, rejections, .. } = self.window;
        Usage {
            builds: builds as f32 / steps as f32,
            rejections: rejections as f32 / steps as f32,
            words,
            chances: 1.0 / self.interval() as f32,
        }
    }
}

/// The margin to try next when a body left its AABB by `escape` with the margin `margin`, all in units of 0.02 r. `attempts` is
/// the number of attempts before. After 16 attempts the margin becomes infinite: some force or coordinate is then so large that no
/// finite margin suffices.
pub(in crate::simulation) fn margin_after_escape(margin: f32, escape: f32, attempts: u32) -> f32 {
    match attempts {
        0 => margin + margin_for_escape(escape),
        1..=16 => (margin + escape) * 1.25,
        _ => f32::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::status::REJECTED_ESCAPED;
    use crate::simulation::lists::cost::tests::MANY;

    /// Few movers on a device.
    const FEW: ListFacts = ListFacts { movers: 1e3, dispatches: 7.0, ..MANY };
    const FAR: f32 = 3.0;

    fn policy(lookahead: f32) -> ListPolicy {
        let mut policy = ListPolicy::new(lookahead, MIN_MARGIN);
        policy.begin(true);
        policy
    }

    /// The status after `steps` steps in which lists took 10 words per mover and lasted as long as they were built for.
    fn after(policy: &ListPolicy, steps: u32) -> Status {
        let builds = steps as f32 / policy.trials.steps;
        Status { steps, builds: builds as u32, pair_rows_needed: (10.0 * FEW.movers / 32.0) as u32, ..Status::default() }
    }

    /// Takes in portions of `steps` steps, in each of which the device repeats `repeats` steps for escapes of `escape`.
    fn run(policy: &mut ListPolicy, portions: u32, steps: u32, repeats: u32, escape: f32) {
        for _ in 0..portions {
            let status = Status { repeats, repeat_escape: escape.to_bits(), ..after(policy, steps) };
            policy.observe(&FEW, policy.version, &Status::default(), &status);
        }
    }

    #[test]
    fn the_interval_follows_from_the_lookahead() {
        let interval = |lookahead: f32| policy(lookahead).settings().interval;
        assert_eq!([1.0, 1.9, 2.0, 3.9, 4.0, 7.0, 8.0, 32.0].map(interval), [1, 1, 2, 2, 4, 4, 8, 8]);
        let mut every = policy(32.0);
        every.begin(false);
        assert_eq!(every.settings().interval, 1);
    }

    #[test]
    fn lists_that_last_are_built_for_longer() {
        let mut policy = policy(1.0);
        run(&mut policy, 20, 32, 0, 0.0);
        let ListPlan { lookahead, interval, margin, .. } = policy.settings();
        assert_eq!((lookahead, interval, margin), (32.0, LONGEST, MIN_MARGIN));
    }

    /// If bodies leave their AABBs in every portion, steps are hardly ever submitted with lists for several steps.
    #[test]
    fn frequent_escapes_shorten_the_lookahead() {
        for escape in [0.5 * NEAR, FAR] {
            let mut policy = policy(32.0);
            run(&mut policy, 12, 4, 1, escape);
            assert_eq!(policy.settings().interval, 1);
            let long = (0..1_000).filter(|_| {
                let waits = policy.interval() > 1;
                run(&mut policy, 1, 4, u32::from(waits), escape);
                waits
            });
            let long = long.count();
            assert!(long < 60, "{long} of 1000 portions");
        }
    }

    #[test]
    fn one_short_escape_in_a_window_is_forgiven() {
        let mut policy = policy(4.0);
        for _ in 0..10 {
            policy.rejected_with = policy.version;
            policy.escaped(0.5 * NEAR, 1);
            assert_eq!((policy.settings().lookahead, policy.margin), (4.0, MIN_MARGIN));
            policy.restart();
        }
        for _ in 0..2 {
            policy.rejected_with = policy.version;
            policy.escaped(0.5 * NEAR, 1);
        }
        let ListPlan { lookahead, interval, margin, .. } = policy.settings();
        assert_eq!((lookahead, interval, margin), (3.0, 2, MIN_MARGIN));
    }

    #[test]
    fn an_exception_raises_margins_where_lists_last_longest() {
        let mut policy = policy(32.0);
        policy.escaped(0.5 * NEAR, 1);
        let ListPlan { lookahead, margin, .. } = policy.settings();
        assert_eq!((lookahead, margin), (32.0, MIN_MARGIN + 0.5 * NEAR + NEAR_STEP));
        run(&mut policy, 100, 4, 0, 0.0);
        assert_eq!(policy.margin, MIN_MARGIN, "it decays");
    }

    /// Otherwise a scene in which bodies often leave their AABBs would never try other lists.
    #[test]
    fn a_larger_margin_does_not_restart_the_window() {
        for (lookahead, counted) in [(1.0, 20), (2.0, 0)] {
            let mut policy = policy(lookahead);
            run(&mut policy, 5, 4, 0, 0.0);
            let version = policy.version;
            policy.rejected_with = version;
            policy.escaped(FAR, 1);
            assert_ne!(policy.version, version, "portions under way have other settings");
            assert_eq!(policy.window.steps, counted);
        }
    }

    /// The margin after a portion that was submitted with settings 7, began with a step that was rejected for an escape and submitted
    /// with the settings `rejected_with`, and repeated `repeats` steps.
    fn margin_after_repeats(rejected_with: u32, repeats: u32) -> f32 {
        let mut policy = policy(1.0);
        (policy.version, policy.rejected_with) = (7, rejected_with);
        let before = Status { rejected: REJECTED_ESCAPED, ..Status::default() };
        let status = Status { repeats, repeat_escape: FAR.to_bits(), ..Status::default() };
        policy.observe(&FEW, 7, &before, &status);
        policy.margin
    }

    #[test]
    fn a_step_is_judged_by_the_settings_that_it_was_submitted_with() {
        assert_eq!(margin_after_repeats(6, 1), MIN_MARGIN, "the settings have changed since");
        let raised = margin_after_repeats(7, 1);
        assert!(raised > MIN_MARGIN);
        assert_eq!(margin_after_repeats(6, 2), raised, "the second one has the present settings");
        assert_eq!(margin_after_repeats(7, 2), raised, "the first one has changed them");
    }

    #[test]
    fn no_finite_margin_is_tried_for_ever() {
        let mut policy = policy(1.0);
        (1..=17).for_each(|attempts| policy.escaped(FAR, attempts));
        assert_eq!(policy.margin, f32::INFINITY);
        run(&mut policy, 1, 4, 0, 0.0);
        assert_eq!(policy.margin, MIN_MARGIN, "once the step is done");
    }

    #[test]
    fn the_lookahead_is_shortened_before_memory_grows() {
        let rods = ListFacts { has_rods: true, ..MANY };
        let mut policy = policy(3.0);
        assert!(!policy.overflowed(&MANY, 10.0), "there is room for that many");
        for expected in [1.5, 1.0] {
            assert!(policy.overflowed(&rods, 100.0));
            assert_eq!(policy.settings().lookahead, expected);
        }
        assert!(!policy.overflowed(&rods, 100.0), "they are what one step needs");
    }
}
