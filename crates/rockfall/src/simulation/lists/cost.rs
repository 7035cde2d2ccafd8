//! The cost of a step with its pair lists. Work is counted, not timed, so that a run can be reproduced.

use crate::settings::BroadPhase;

/// If lists need more memory and take more than this number of words per mover, the lookahead is shortened before more memory
/// is allocated.
const LONG: f32 = 20.0;
/// The same for scenes with rods, whose neighbours are many and costly to find. In a scene of rods at rest, lists of 23 words
/// per mover must be rebuilt in every step, lists of 29 words in every fourth.
const LONG_OF_RODS: f32 = 36.0;
/// Estimated relative growth of lists when the number of steps ahead doubles. In scenes with rods, it is multiplied by the
/// current number of steps. Lists that do not fit cost a rejected step.
const GROWTH: f32 = 0.15;

// Costs in ns per mover on a large GPU, measured by timestamps. Only their ratios matter.
/// Rebuilding a list, regardless of its length.
const BUILD: f32 = 0.2;
/// Finding one entry.
const FIND: f32 = 0.04;
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

/// What decisions about lists depend on, apart from how the bodies move.
#[derive(Clone, Copy, Debug)]
pub(in crate::simulation) struct ListFacts {
    /// Number of spheres and rods.
    pub(in crate::simulation) movers: f32,
    /// Words per mover that memory has room for.
    pub(in crate::simulation) capacity: f32,
    pub(in crate::simulation) has_rods: bool,
    /// Whether bodies may have long lists.
    pub(in crate::simulation) has_long_lists: bool,
    /// Whether the contact law has history.
    pub(in crate::simulation) has_history: bool,
    pub(in crate::simulation) broad_phase: BroadPhase,
    /// Dispatches that rebuild lists or check whether to; 0 on the CPU.
    pub(in crate::simulation) dispatches: f32,
}

impl ListFacts {
    /// Words per mover that lists may take before they are shortened rather than given more memory.
    pub(super) fn long(&self) -> f32 {
        if self.has_rods { LONG_OF_RODS } else { LONG }
    }

    /// Whether lists that take `words` per mover for `steps` steps can be expected to fit for twice as many.
    pub(super) fn may_double(&self, steps: f32, words: f32) -> bool {
        let steps = if self.has_rods { steps } else { 1.0 };
        words * (1.0 + GROWTH * steps) <= self.capacity.max(self.long())
    }

    /// The cost of a step per mover, in ns.
    pub(super) fn cost(&self, used: &Usage) -> f32 {
        let search = match self.broad_phase {
            BroadPhase::Grid => 0.0,
            // Movers in the slab of the scene that overlaps a block.
            BroadPhase::SortAndSkip => TEST * 8.0 * self.movers.powf(2.0 / 3.0),
            _ => TEST * self.movers,
        };
        let wait = WAIT + used.builds * WAIT_TO_FIND;
        let on_device = DISPATCH * self.dispatches * used.chances + wait * used.words;
        let alone = if self.dispatches > 0.0 { on_device } else { 0.0 };
        used.builds * (BUILD + search + FIND * used.words)
            + if self.has_history { LOOK_OF_LAW } else { LOOK } * used.words
            + REJECTION * used.rejections
            + alone / self.movers
    }
}

/// How lists were used in some steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Usage {
    /// Rebuilds per step.
    pub(super) builds: f32,
    /// Number of rejections because a body left its AABB, per completed step.
    pub(super) rejections: f32,
    /// Words that the entries take per mover.
    pub(super) words: f32,
    /// Opportunities to rebuild lists per step.
    pub(super) chances: f32,
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A million movers on the CPU.
    pub(in super::super) const MANY: ListFacts = ListFacts {
        movers: 1e6,
        capacity: 50.0,
        has_rods: false,
        has_long_lists: false,
        has_history: false,
        broad_phase: BroadPhase::Grid,
        dispatches: 0.0,
    };
    /// Lists that are rebuilt in every step.
    pub(in super::super) const USED: Usage = Usage { builds: 1.0, rejections: 0.0, words: 10.0, chances: 1.0 };

    #[test]
    fn few_bodies_on_a_device_get_a_longer_lookahead() {
        // A quarter of the dispatches for lists of twice the length is cheaper with a thousand movers, but not with a million.
        let cost = |movers: f32, words: f32, chances: f32| {
            ListFacts { movers, dispatches: 7.0, ..MANY }.cost(&Usage { words, chances, ..USED })
        };
        assert!(cost(1e3, 16.0, 0.25) < cost(1e3, 8.0, 1.0));
        assert!(cost(1e6, 16.0, 0.25) > cost(1e6, 8.0, 1.0));
    }

    #[test]
    fn repeated_steps_cost_more_than_rebuilt_lists() {
        let cost = |builds: f32, rejections: f32| MANY.cost(&Usage { builds, rejections, words: 14.0, ..USED });
        // Halving the rebuilds pays with one rejected step in 32, but not with one in ten.
        assert!(cost(0.5, 1.0 / 32.0) < cost(1.0, 0.0));
        assert!(cost(0.5, 0.1) > cost(1.0, 0.0));
    }

    #[test]
    fn lists_cost_more_with_brute_force() {
        let cost = |broad_phase: BroadPhase| ListFacts { movers: 1e4, broad_phase, ..MANY }.cost(&USED);
        assert!(cost(BroadPhase::BruteForce) > 10.0 * cost(BroadPhase::Grid));
    }

    #[test]
    fn lists_of_rods_grow_faster() {
        let facts = ListFacts { capacity: 36.0, ..MANY };
        assert!(facts.may_double(4.0, 29.0));
        assert!(!ListFacts { has_rods: true, ..facts }.may_double(4.0, 29.0));
    }
}
