//! Runs phases until all steps are done. The cause of a rejected step is removed, and the step is repeated.

use crate::error::BadStage;
use crate::error::{Error, Result};
use crate::model::muscles::BASE_STEPS;
use crate::model::residue::has_residues;
use crate::model::status::{
    BAD_STAGE_SHIFT, NO_BODY, REJECTED_BEFORE, REJECTED_COLLISIONS, REJECTED_COUNT, REJECTED_ESCAPED, REJECTED_HISTORY,
    REJECTED_MANY, REJECTED_NETWORKS, REJECTED_NON_FINITE, REJECTED_PAIRS, Status,
};
use crate::profile::Recorder;
use crate::report::Passage;
use crate::simulation::Simulation;
use crate::simulation::edit::Dirty;
use crate::step::schedule::Phase;

/// Maximum number of times in a row that a step may be rejected.
pub(super) const MAX_ATTEMPTS: u32 = 64;
/// The order of the phases in a whole step. Collisions come first and use the lists of the step before. Those lists hold every
/// pair that overlaps now, which `find_collisions` checks. AABBs that are computed after the impulses need not be grown for the
/// velocity changes that impulses cause. Lists do not change results, so this is the same step as in the order of
/// [`Phase::STEP`]. AABBs and lists are rebuilt only if some body requests it (`rebuild`).
pub(super) const COLLISIONS_FIRST: [Phase; 4] =
    [Phase::HandleCollisions, Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];
/// A whole step in a scene without collisions and friction impulses, which therefore needs no collision phase.
pub(super) const WITHOUT_COLLISIONS: [Phase; 3] = [Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];

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
        if has_residues(dt) != self.world.step.has_residues() {
            // The arrays get room for residues, or lose it.
            self.dirty = Dirty::Everything;
        }
        Ok(())
    }

    /// Runs `phases` in order, `times` times. With a recorder every stage is timed.
    pub(super) async fn drive(&mut self, phases: &[Phase], times: u64, mut recorder: Option<&mut Recorder>) -> Result<()> {
        if !self.is_watched() || !phases.contains(&Phase::UpdatePositions) {
            return self.drive_on(phases, times, recorder).await;
        }
        for _ in 0..times {
            self.drive_on(phases, 1, recorder.as_deref_mut()).await?;
            self.note_events().await?;
        }
        Ok(())
    }

    /// [`Simulation::drive`] without a look at the states in between.
    async fn drive_on(&mut self, phases: &[Phase], times: u64, mut recorder: Option<&mut Recorder>) -> Result<()> {
        self.flush_async().await?;
        if self.has_frames() {
            return match self.drive_frames(phases, times).await {
                Err(error) => Err(self.blame_law(error).await),
                done => done,
            };
        }
        if phases.contains(&Phase::HandleCollisions) {
            self.status.collided = 0;
        }
        let mut left = times;
        let mut attempts = 0;
        while left > 0 {
            let until = self.pass().await?;
            self.keep_order().await?;
            let overdue = self.overdue(phases);
            let all: Vec<Phase> = overdue.iter().chain(phases).copied().collect();
            // Overdue phases run once, not in every step.
            let most = if overdue.is_empty() { left.min(until).min(self.in_order_for()).min(BASE_STEPS) } else { 1 };
            let done = self.stretch(&all, most, recorder.as_deref_mut()).await?;
            left -= done;
            attempts = if done > 0 { 0 } else { attempts + 1 };
            self.note_lists(&all, done);
            if self.status.rejected & REJECTED_HISTORY != 0 {
                self.grow_histories().await?;
            }
            if let Err(error) = self.handle_rejection(attempts) {
                return Err(self.blame_law(error).await);
            }
        }
        Ok(())
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
                status.pair_rows_needed,
                self.lists.settings().margin,
                status.history_needed,
                self.world.step.layout.history_pool
            );
            return Err(Error::Stuck { step: self.report.steps + 1, attempts, reason });
        }
        self.report.replays += 1;
        if status.rejected & REJECTED_COLLISIONS != 0 {
            self.begin_sweeps()?;
            if status.rejected & !(REJECTED_MANY | REJECTED_BEFORE) == REJECTED_COLLISIONS {
                return Ok(());
            }
        }
        if status.rejected & REJECTED_ESCAPED != 0 {
            self.lists.escaped(f32::from_bits(status.escape_ratio), attempts);
        }
        if status.rejected & REJECTED_COUNT != 0 {
            self.status.pair_rows_needed = u32::MAX;
        }
        if status.rejected & (REJECTED_PAIRS | REJECTED_COUNT) != 0 {
            self.make_lists_fit()?;
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
        self.scene.advance_shear(done, self.time_step);
        self.report.contacts = status.last_contacts;
        self.report.max_overlap = f32::from_bits(status.last_max_overlap);
        self.report.collisions = status.last_collisions;
        self.report.total_collisions += total(status) - total(before);
        self.report.non_finite += u64::from(status.total_bad.wrapping_sub(before.total_bad));
        self.report.passages += u64::from(status.total_passages.wrapping_sub(before.total_passages));
        let has_begun = self.report.passages > 0 && self.report.first_passage.is_none();
        if has_begun && status.first_passing != NO_BODY {
            let step = self.report.steps - done + u64::from(status.passage_step.wrapping_sub(before.steps));
            self.report.first_passage = Some(Passage { sphere: status.first_passing as usize, step });
        }
    }
}
