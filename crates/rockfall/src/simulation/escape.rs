//! What follows when a body left its AABB: the interval of list rebuilds becomes shorter, or the margin of AABBs larger.

use crate::physics::travel::margin_for_escape;
use crate::simulation::Simulation;
use crate::simulation::interval::LONGEST;

/// If a body leaves its AABB by less than this, in units of 0.02 r, the rejected step is treated as an exception. A larger
/// distance shows that the lists were built for too many steps.
const NEAR: f32 = 1.0;
/// Additional amount by which the margin is raised after such an exception at the longest interval, in units of 0.02 r. Among
/// many millions of bodies at rest another exception would soon follow, and longer lists cost little if they are rarely
/// rebuilt.
const NEAR_STEP: f32 = 0.5;

impl Simulation {
    /// Handles a step that was rejected only because a body left its AABB by `escape`, in units of 0.02 r. A short distance may be an
    /// exception.
    pub(super) fn judge_escape(&mut self, escape: f32, attempts: u32) {
        let interval = self.world.step.list_interval as u32;
        if escape >= NEAR || !self.interval.forgives(interval) {
            self.handle_escape(escape, attempts);
            return;
        }
        self.window.rejections += 1;
        if interval == LONGEST {
            self.world.step.margin_scale += escape + NEAR_STEP;
        }
    }

    /// Handles a step in which a body left its AABB by `escape`, in units of 0.02 r: shortens the interval or raises the
    /// margin.
    pub(super) fn handle_escape(&mut self, escape: f32, attempts: u32) {
        let step = &mut self.world.step;
        if step.has_exact_lists() {
            // The step is repeated with new lists, which have the pairs of all present positions.
            self.window.rejections += 1;
            return;
        }
        if self.interval.failed(step.list_interval as u32) {
            self.window.restart();
            step.lookahead = self.lookahead.give_up().unwrap_or(step.lookahead);
            return;
        }
        self.window.rejections += 1;
        self.window.change_margin();
        step.margin_scale = margin_after_escape(step.margin_scale, escape, attempts);
    }
}

/// The margin to try next when a body left its AABB by `escape` with the margin `margin`, all in units of 0.02 r. `attempts` is
/// the number of attempts before. After 16 attempts no finite margin
/// is large enough, because some force or coordinate is beyond all bounds.
pub(super) fn margin_after_escape(margin: f32, escape: f32, attempts: u32) -> f32 {
    match attempts {
        0 => margin + margin_for_escape(escape),
        1..=16 => (margin + escape) * 1.25,
        _ => f32::INFINITY,
    }
}

#[cfg(all(test, not(target_family = "wasm")))]
mod tests {
    use super::*;
    use crate::simulation::drive::MIN_MARGIN;

    /// The margin after a step in which a body left its AABB by half the distance of an exception.
    fn margin_after_exception(interval: u32) -> f32 {
        let options = crate::Options::new().backend(crate::Backend::Cpu);
        let mut simulation = Simulation::with_options(crate::Scene::new(), options).unwrap();
        simulation.world.step.list_interval = interval as f32;
        simulation.judge_escape(0.5 * NEAR, 0);
        simulation.world.step.margin_scale
    }

    #[test]
    fn an_exception_raises_margins_where_lists_last_longest() {
        assert_eq!(margin_after_exception(LONGEST / 2), MIN_MARGIN);
        assert_eq!(margin_after_exception(LONGEST), MIN_MARGIN + 0.5 * NEAR + NEAR_STEP);
    }
}
