//! Runs phases until all steps are done. The cause of a rejected step is removed, and the step is repeated.

use crate::error::BadStage;
use crate::error::{Error, Result};
use crate::model::layout::{LAW_THESIS, MAX_PAIR_ROWS, words_of_rows};
use crate::model::muscles::BASE_STEPS;
use crate::model::status::{
    BAD_STAGE_SHIFT, NO_BODY, REJECTED_COLLISIONS, REJECTED_COUNT, REJECTED_ESCAPED, REJECTED_HISTORY, REJECTED_MANY,
    REJECTED_NETWORKS, REJECTED_NON_FINITE, REJECTED_PAIRS, Status,
};
use crate::profile::Recorder;
use crate::simulation::Simulation;
use crate::simulation::lookahead::{Lists, Lookahead};
use crate::step::schedule::Phase;

/// Number of steps after which lookahead and interval are adapted.
const BATCH: u64 = 32;
/// The same in a trial of exact lists.
const BATCH_OF_EXACT: u64 = 8;
/// Maximum number of times in a row that a step may be rejected.
pub(super) const MAX_ATTEMPTS: u32 = 64;
/// Factor per step by which a raised AABB margin decays. A margin that has decayed too far causes a rejected step.
const MARGIN_DECAY: f32 = 0.997;
/// The same in scenes with rods or large spheres. Their lists are so long that lengthening them costs more than a rejected
/// step.
const MARGIN_DECAY_OF_LONG: f32 = 0.99;
/// Smallest AABB margin, in units of 0.02 r.
pub(super) const MIN_MARGIN: f32 = 2.0;

/// The order of the phases in a whole step. Collisions come first and use the lists of the step before. Those lists hold every
/// pair that overlaps now, which `find_collisions` checks. AABBs that are computed after the impulses need not be grown for the
/// velocity changes that impulses cause. Lists do not change results, so this is the same step as in the order of
/// [`Phase::STEP`]. AABBs and lists are rebuilt only if some body requests it (`rebuild`).
pub(super) const COLLISIONS_FIRST: [Phase; 4] =
    [Phase::HandleCollisions, Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];
/// A whole step with exact lists, which are built before the collisions and again after them. The second time the stages return at
/// once unless an impulse has moved a sphere.
pub(super) const WITH_EXACT_LISTS: [Phase; 6] = [
    Phase::UpdateAabbs,
    Phase::BroadPhase,
    Phase::HandleCollisions,
    Phase::UpdateAabbs,
    Phase::BroadPhase,
    Phase::UpdatePositions,
];
/// The same with collisions switched off and without friction impulses, which the collision phase also applies.
pub(super) const WITHOUT_COLLISIONS: [Phase; 3] = [Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];

/// Counts since lookahead and interval were last adapted.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Window {
    steps: u64,
    builds: u32,
    /// Rejected steps in which a body left its AABB and the interval did not change.
    pub(super) rejections: u32,
    /// Number of the present settings: lookahead, interval and margin. Only the margin may change within a window.
    pub(super) settings: u32,
    /// Number of the settings with which the step was submitted that is rejected now.
    pub(super) rejected_with: u32,
}

impl Window {
    /// Starts a new window. Portions that are still under way from the previous one do not count.
    pub(super) fn restart(&mut self) {
        *self = Self { settings: self.settings.wrapping_add(1), rejected_with: self.rejected_with, ..Self::default() };
    }

    /// Notes a larger margin. The counts go on, because it changes the number of rebuilds little. Portions that are still under way do
    /// not count.
    pub(super) fn change_margin(&mut self) {
        self.settings = self.settings.wrapping_add(1);
    }
}

impl Simulation {
    /// Sets the time step that AABBs are grown for, and that observations assume until the next step. With symplectic Euler and
    /// collisions, [`Simulation::energy`] and [`Simulation::contacts`] depend on it. `step`, `run` and `update_positions` set it too.
    ///
    /// # Errors
    /// [`Error::Invalid`] when it is not positive and finite.
    pub fn set_time_step(&mut self, dt: f32) -> Result<()> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(Error::Invalid {
                field: "dt",
                value: dt.to_string(),
                expected: "a time step in seconds, finite and greater than 0",
            });
        }
        self.time_step = dt;
        Ok(())
    }

    /// Runs `phases` in order, `times` times. With a recorder every stage is timed.
    pub(super) async fn drive(&mut self, phases: &[Phase], times: u64, mut recorder: Option<&mut Recorder>) -> Result<()> {
        self.flush_async().await?;
        if phases.contains(&Phase::HandleCollisions) {
            self.status.collided = 0;
        }
        let mut left = times;
        let mut attempts = 0;
        while left > 0 {
            self.keep_order().await?;
            let phases = self.phases_for_lists(phases);
            let was_exact = self.world.step.has_exact_lists();
            let overdue = self.overdue(phases);
            let all: Vec<Phase> = overdue.iter().chain(phases).copied().collect();
            // Overdue phases run once, not in every step.
            let most = if overdue.is_empty() { left.min(self.in_order_for()).min(BASE_STEPS) } else { 1 };
            let done = self.stretch(&all, most, recorder.as_deref_mut()).await?;
            left -= done;
            attempts = if done > 0 { 0 } else { attempts + 1 };
            self.note_lists(&all, done);
            self.note_end_of_exact_lists(was_exact);
            if self.status.rejected & REJECTED_HISTORY != 0 {
                self.grow_histories().await?;
            }
            if let Err(error) = self.handle_rejection(attempts) {
                return Err(self.blame_law(error).await);
            }
        }
        Ok(())
    }

    /// The phases that must run first because AABBs or lists do not match the scene.
    fn overdue(&self, phases: &[Phase]) -> &'static [Phase] {
        let (mut aabbs_due, mut lists_due) = (self.aabbs_due, self.lists_due);
        for phase in phases {
            match phase {
                Phase::UpdateAabbs => aabbs_due = false,
                Phase::BroadPhase if aabbs_due => return &[Phase::UpdateAabbs],
                Phase::BroadPhase => lists_due = false,
                // The collisions of this step are done, so the lists are not read.
                Phase::HandleCollisions if self.status.collided != 0 => {}
                _ if lists_due => return &[Phase::UpdateAabbs, Phase::BroadPhase],
                _ => {}
            }
        }
        &[]
    }

    /// Dispatches per step, in the last batch, that rebuild lists or check whether to.
    fn list_dispatches(&self) -> f32 {
        if !self.engine.dispatches() {
            return 0.0;
        }
        let phases = if self.world.step.has_exact_lists() { &WITH_EXACT_LISTS[..] } else { &Phase::STEP };
        let making = phases.iter().filter(|phase| phase.makes_lists());
        let runs = making.flat_map(|phase| phase.stages(self.options.integrator, self.broad_phase_method()));
        runs.filter(|run| run.workgroups(&self.world.step) > 0).count() as f32 / self.world.step.list_interval
    }

    /// Records whether AABBs and lists match the scene.
    fn note_lists(&mut self, phases: &[Phase], done: u64) {
        let rejected = self.status.rejected;
        if phases.contains(&Phase::UpdateAabbs) {
            self.aabbs_due = false;
        }
        if phases.contains(&Phase::BroadPhase) && (done > 0 || rejected & REJECTED_PAIRS == 0) {
            self.lists_due = false;
        }
        // If a step is rejected in or after its collisions, its AABBs and lists may be incomplete.
        self.lists_due |= rejected & (REJECTED_PAIRS | REJECTED_ESCAPED | REJECTED_COLLISIONS) != 0;
        self.aabbs_due |= rejected & (REJECTED_ESCAPED | REJECTED_COLLISIONS) != 0;
    }

    /// Removes the cause of a rejected step, so that the step can be repeated.
    fn handle_rejection(&mut self, attempts: u32) -> Result<()> {
        let status = self.status;
        if status.rejected & REJECTED_NON_FINITE != 0 {
            self.status.rejected = 0;
            let bad = std::mem::replace(&mut self.status.first_bad, NO_BODY);
            return Err(Error::NonFinite {
                sphere: (bad & ((1 << BAD_STAGE_SHIFT) - 1)) as usize,
                step: self.report.steps,
                stage: BadStage::from_number(bad >> BAD_STAGE_SHIFT),
            });
        }
        if status.rejected & REJECTED_NETWORKS != 0 {
            self.status.rejected = 0;
            return Err(Error::Networks { step: self.report.steps + 1 });
        }
        if status.rejected == 0 {
            return Ok(());
        }
        // Before the remedies: no cause may be removed without end.
        if attempts > MAX_ATTEMPTS {
            let reason = format!(
                "{} rows of pairs needed, AABB margin {}, {} blocks of springs needed of {}",
                status.pair_rows_needed, self.world.step.margin_scale, status.history_needed, self.world.step.history_pool
            );
            return Err(Error::Stuck { step: self.report.steps + 1, attempts, reason });
        }
        self.report.replays += 1;
        if status.rejected & REJECTED_COLLISIONS != 0 {
            self.begin_sweeps()?;
            if status.rejected & !REJECTED_MANY == REJECTED_COLLISIONS {
                return Ok(());
            }
        }
        let escape = f32::from_bits(status.escape_ratio);
        if status.rejected == REJECTED_ESCAPED {
            // Otherwise the cause may be gone already. The first attempt may have been repeated by the device.
            if attempts > 1 || self.window.rejected_with == self.window.settings {
                self.judge_escape(escape, attempts);
            }
            return Ok(());
        }
        self.window.restart();
        if status.rejected & REJECTED_COUNT != 0 {
            self.status.pair_rows_needed = u32::MAX;
        }
        if status.rejected & (REJECTED_PAIRS | REJECTED_COUNT) != 0 {
            let movers = (self.world.step.spheres + self.world.step.rods).max(1) as f32;
            match self.lookahead.shorter(words_of_rows(status.pair_rows_needed) as f32 / movers, self.world.step.rods > 0) {
                Some(steps) => self.world.step.lookahead = steps,
                None => self.grow_lists()?,
            }
        }
        if status.rejected & REJECTED_ESCAPED != 0 {
            self.handle_escape(escape, attempts);
        }
        Ok(())
    }

    /// Adds the results of a portion to the report. `before` is the status before the portion.
    pub(super) fn book(&mut self, done: u64, before: &Status) {
        let status = &self.status;
        self.report.list_builds += u64::from(status.builds.wrapping_sub(before.builds));
        self.report.replays += u64::from(status.repeats.wrapping_sub(before.repeats));
        if done == 0 {
            return;
        }
        self.count_calm(done, before);
        let status = &self.status;
        let total = |status: &Status| u64::from(status.total_collisions_high) << 32 | u64::from(status.total_collisions_low);
        self.clock.add(done, self.time_step, &mut self.report);
        self.muscle_clock.steps += done;
        self.report.contacts = status.last_contacts;
        self.report.max_overlap = f32::from_bits(status.last_max_overlap);
        self.report.collisions = status.last_collisions;
        self.report.total_collisions += total(status) - total(before);
        self.report.non_finite += u64::from(status.total_bad.wrapping_sub(before.total_bad));
        let step = &mut self.world.step;
        let decay = if step.has_long_lists() { MARGIN_DECAY_OF_LONG } else { MARGIN_DECAY };
        let decayed = step.margin_scale * decay.powf(done as f32);
        step.margin_scale = if decayed.is_finite() { decayed.max(MIN_MARGIN) } else { MIN_MARGIN };
    }

    /// Adapts lookahead and interval once enough steps were done with them.
    pub(super) fn adapt(&mut self, done: u64, builds: u32) {
        self.window.steps += done;
        self.window.builds += builds;
        if self.window.steps < self.batch() {
            return;
        }
        let step = &self.world.step;
        let movers = (step.spheres + step.rods).max(1) as f32;
        let seen = Lists {
            builds_per_step: self.window.builds as f32 / self.window.steps as f32,
            rejections_per_step: self.window.rejections as f32 / self.window.steps as f32,
            words_per_mover: words_of_rows(self.status.pair_rows_needed) as f32 / movers,
            room_per_mover: Lookahead::room(words_of_rows(step.pair_rows) as f32 / movers, step.rods > 0),
            movers,
            has_rods: step.rods > 0,
            has_history: step.law != LAW_THESIS,
            may_be_exact: self.may_have_exact_lists(),
            are_exact: step.has_exact_lists(),
            dispatches: self.list_dispatches(),
        };
        self.world.step.lookahead = self.lookahead.after(&seen, self.broad_phase_method());
        if !self.world.step.has_exact_lists() && self.interval.lasted() {
            self.lookahead.hurry();
        }
        self.window.restart();
    }

    /// Number of steps of a window.
    fn batch(&self) -> u64 {
        if self.lookahead.changes_exactness() { BATCH_OF_EXACT } else { BATCH }
    }

    /// Makes the pair lists a quarter larger than needed.
    fn grow_lists(&mut self) -> Result<()> {
        let needed = self.status.pair_rows_needed;
        let rows = room_for(needed)?;
        let before = self.world.step.pair_rows;
        self.world.set_pair_room(rows);
        self.engine.complete(&mut self.world);
        let grown = self.engine.resize_lists(&self.world);
        if grown.is_err() {
            // The simulation may go on with fewer objects, so the world must not keep the size that could not be allocated.
            self.world.set_pair_room(before);
        }
        grown
    }
}

/// Number of rows to allocate for entries when `needed` rows are needed.
pub(super) fn room_for(needed: u32) -> Result<u32> {
    if needed > MAX_PAIR_ROWS {
        let bytes = |rows: u32| 4 * words_of_rows(rows);
        return Err(Error::DeviceLimit { what: "the pair lists", needed: bytes(needed), limit: bytes(MAX_PAIR_ROWS) });
    }
    Ok(needed.saturating_add(needed.div_ceil(4)).min(MAX_PAIR_ROWS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::layout::{SLICE, max_objects};

    /// If a step is repeated whose collisions are done, lists are not rebuilt twice, nor for bodies that may turn back.
    #[test]
    #[cfg(not(target_family = "wasm"))]
    fn done_collisions_need_no_lists() {
        let mut scene = crate::Scene::new();
        scene.add_sphere(crate::Sphere::new([0.0; 3], 1.0)).unwrap();
        let mut simulation = Simulation::with_options(scene, crate::Options::new().backend(crate::Backend::Cpu)).unwrap();
        (simulation.aabbs_due, simulation.lists_due) = (true, true);
        assert_eq!(simulation.overdue(&COLLISIONS_FIRST), [Phase::UpdateAabbs, Phase::BroadPhase]);
        simulation.status.collided = 1;
        assert!(simulation.overdue(&COLLISIONS_FIRST).is_empty());
        assert_eq!(simulation.overdue(&[Phase::UpdatePositions]), [Phase::UpdateAabbs, Phase::BroadPhase]);
    }

    /// The steps that a window of 20 steps counts after a body left its AABB at this interval.
    #[cfg(not(target_family = "wasm"))]
    fn counted_after_escape(interval: u32) -> u64 {
        let options = crate::Options::new().backend(crate::Backend::Cpu);
        let mut simulation = Simulation::with_options(crate::Scene::new(), options).unwrap();
        simulation.world.step.list_interval = interval as f32;
        (simulation.window.steps, simulation.window.settings) = (20, 7);
        simulation.handle_escape(3.0, 0);
        assert_ne!(simulation.window.settings, 7, "portions under way have other settings");
        simulation.window.steps
    }

    /// Otherwise a scene in which bodies often leave their AABBs would never try other lists.
    #[test]
    #[cfg(not(target_family = "wasm"))]
    fn a_larger_margin_does_not_restart_the_window() {
        assert_eq!(counted_after_escape(1), 20);
        assert_eq!(counted_after_escape(2), 0, "the interval has changed");
    }

    #[test]
    fn lists_grow_up_to_what_32_bits_can_number() {
        assert_eq!(room_for(1_000).unwrap(), 1_250);
        // A quarter more exceeds the maximum number of rows, or 32 bits.
        for needed in [MAX_PAIR_ROWS / 8 * 7, MAX_PAIR_ROWS] {
            assert_eq!(room_for(needed).unwrap(), MAX_PAIR_ROWS);
        }
        assert!(matches!(room_for(MAX_PAIR_ROWS + 1), Err(Error::DeviceLimit { .. })));
        assert!(matches!(room_for(u32::MAX), Err(Error::DeviceLimit { .. })));
        // Counts and slice offsets of the maximum number of movers precede the entries.
        let slices = max_objects(false).div_ceil(SLICE);
        assert!(MAX_PAIR_ROWS.checked_add(slices + slices.div_ceil(SLICE) + 1).is_some());
    }
}
