//! The states of the last seconds, so that one can go back.

use std::collections::VecDeque;

use rockfall::{Checkpoint, Scene};

/// Simulated time that the states cover, in s.
const SPAN: f64 = 10.0;
/// Greatest number of states.
const MOST: usize = 200;
/// Least number of states that is worth keeping.
const LEAST: usize = 20;
/// Memory that the states may take, in bytes.
const BUDGET: usize = 256 << 20;
/// Greatest fraction of the wall time that recording may take.
const SHARE: f64 = 0.1;

/// Returns the approximate size of a copy of a scene, in bytes.
pub(super) fn bytes_of(scene: &Scene) -> usize {
    let counts = scene.counts();
    let spheres = counts.spheres * (size_of::<rockfall::Sphere>() + 16);
    let others = counts.rods + counts.capsules + counts.springs + counts.tethers + counts.boxes + counts.polygons;
    spheres + 80 * others
}

/// The recorded states, in the order of their times.
#[derive(Clone, Debug, Default)]
pub struct Past {
    states: VecDeque<Checkpoint>,
    /// Wall time before which nothing is recorded, in s.
    next_at: f64,
}

impl Past {
    /// Returns how many states of a scene are kept; 0 if the scene is too large to keep any.
    pub fn capacity(scene: &Scene) -> usize {
        let most = BUDGET / bytes_of(scene).max(1);
        if most < LEAST { 0 } else { most.min(MOST) }
    }

    /// Returns the simulated time between two states of a scene, in s.
    pub(super) fn interval(scene: &Scene) -> f64 {
        SPAN / Self::capacity(scene).max(1) as f64
    }

    /// Returns the simulated times of the states, in s.
    pub fn times(&self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
        self.states.iter().map(|state| state.report.time)
    }

    /// Returns a state.
    pub fn state(&self, index: usize) -> Option<&Checkpoint> {
        self.states.get(index)
    }

    /// Returns all states.
    pub fn states(&self) -> impl Iterator<Item = &Checkpoint> {
        self.states.iter()
    }

    /// Whether a state at this simulated time is due; `now` is the wall time in s.
    pub(super) fn is_due(&self, scene: &Scene, time: f64, now: f64) -> bool {
        let capacity = Self::capacity(scene);
        let interval = SPAN / capacity.max(1) as f64;
        capacity > 0 && now >= self.next_at && self.states.back().is_none_or(|last| time - last.report.time >= 0.999 * interval)
    }

    /// Adds a state that took `seconds` of wall time to record.
    pub(super) fn record(&mut self, state: Checkpoint, now: f64, seconds: f64) {
        self.forget_from(state.report.steps);
        let capacity = Self::capacity(&state.scene);
        self.states.push_back(state);
        while self.states.len() > capacity {
            self.states.pop_front();
        }
        self.next_at = now + seconds / SHARE;
    }

    /// Removes the states after this number of steps.
    pub(super) fn forget_after(&mut self, steps: u64) {
        self.forget_from(steps.saturating_add(1));
    }

    /// Removes the states at and after this number of steps.
    pub(super) fn forget_from(&mut self, steps: u64) {
        while self.states.back().is_some_and(|last| last.report.steps >= steps) {
            self.states.pop_back();
        }
    }

    /// Returns the index of the state nearest to a simulated time.
    pub fn nearest(&self, time: f64) -> Option<usize> {
        let far = |at: &usize| (self.states[*at].report.time - time).abs();
        (0..self.states.len()).min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    /// Returns the index of the next state before or after a number of steps.
    pub(super) fn next(&self, steps: u64, forward: bool) -> Option<usize> {
        if forward {
            self.states.iter().position(|state| state.report.steps > steps)
        } else {
            self.states.iter().rposition(|state| state.report.steps < steps)
        }
    }
}
