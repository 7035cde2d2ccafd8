//! Running phases until they are done: void steps are mended and run again.

use crate::error::BadStage;
use crate::error::{Error, Result};
use crate::model::layout::{MAX_PAIR_ROWS, words_of};
use crate::model::status::{
    BAD_STAGE_SHIFT, NO_BODY, REJECTED_COLLISIONS, REJECTED_COUNT, REJECTED_ESCAPED, REJECTED_MANY, REJECTED_NON_FINITE,
    REJECTED_PAIRS, Status,
};
use crate::profile::Recorder;
use crate::settings::Integrator;
use crate::simulation::Simulation;
use crate::simulation::interval::LONGEST;
use crate::simulation::lookahead::{Lists, Lookahead};
use crate::step::fused::run_steps::is_small;
use crate::step::schedule::Phase;

/// The thesis's fixed time step, in s.
pub const DEFAULT_TIME_STEP: f32 = 0.02;

/// Steps after which lookahead and interval are looked at anew.
const BATCH: u64 = 32;
/// The same where a scene is so small that every other interval changes much, for each step from one chance of making lists to
/// the next.
const BATCH_OF_SMALL: u64 = 16;
/// A step that was void so often in a row is given up.
const MAX_ATTEMPTS: u32 = 64;
/// How fast a margin that had to be raised sinks again, per step: what has sunk too far makes a step void.
const MARGIN_DECAY: f32 = 0.997;
/// The same where there are rods or large spheres: their lists are so long that to make them longer costs more than a void step.
const MARGIN_DECAY_OF_LONG: f32 = 0.99;
const MIN_MARGIN: f32 = 2.0;
/// What it is raised by at least, in 0.02 r.
const MARGIN_STEP: f32 = 1.0;
/// A body that was less far outside of its AABB, in 0.02 r, is an exception; lists for too many steps are told by one that was further.
const NEAR: f32 = 1.0;
/// What the margin is raised by after such an exception besides, in 0.02 r, where lists last longest: of many millions at rest there
/// would be another soon, and what is added to lists that are seldom made costs less.
const NEAR_STEP: f32 = 0.5;

/// The order in which a whole step runs its phases. Collisions come first, with the lists of the step before: those hold
/// every pair that overlaps now (`find_collisions` sees to it), and AABBs that are made after the impulses need not be
/// grown for what they do to velocities. Lists do not change results, so this is the same step as in the order of
/// [`Phase::STEP`]. AABBs and lists are made only where some body asks for them (`rebuild`).
pub(super) const COLLISIONS_FIRST: [Phase; 4] =
    [Phase::HandleCollisions, Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];
/// The same with collisions switched off and without friction impulses, which that phase gives too.
pub(super) const WITHOUT_COLLISIONS: [Phase; 3] = [Phase::UpdateAabbs, Phase::BroadPhase, Phase::UpdatePositions];

/// What was seen since lookahead or interval may have changed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Window {
    steps: u64,
    builds: u32,
    /// Steps in which a body left its AABB, and which changed nothing.
    voids: u32,
    /// Which lookahead and interval these are.
    pub(super) settings: u32,
}

impl Window {
    /// With another lookahead or interval: portions under way with the last ones do not count.
    fn restart(&mut self) {
        *self = Self { settings: self.settings.wrapping_add(1), ..Self::default() };
    }
}

impl Simulation {
    /// Sets the time step that AABBs are grown for.
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

    /// Runs `phases` in their order, `times` over, timed where there is a recorder.
    pub(super) async fn drive(&mut self, phases: &[Phase], times: u64, mut recorder: Option<&mut Recorder>) -> Result<()> {
        self.flush_async().await?;
        if phases.contains(&Phase::HandleCollisions) {
            self.status.collided = 0;
        }
        let mut left = times;
        let mut attempts = 0;
        while left > 0 {
            self.keep_order().await?;
            let overdue = self.overdue(phases);
            let all: Vec<Phase> = overdue.iter().chain(phases).copied().collect();
            // What is overdue is made once, not in every step.
            let most = if overdue.is_empty() { left.min(self.in_order_for()) } else { 1 };
            let done = self.stretch(&all, most, recorder.as_deref_mut()).await?;
            left -= done;
            attempts = if done > 0 { 0 } else { attempts + 1 };
            self.note_lists(&all, done);
            self.mend(attempts)?;
        }
        Ok(())
    }

    /// What has to be made first, because it does not fit the scene any more.
    fn overdue(&self, phases: &[Phase]) -> &'static [Phase] {
        let (mut aabbs_due, mut lists_due) = (self.aabbs_due, self.lists_due);
        for phase in phases {
            match phase {
                Phase::UpdateAabbs => aabbs_due = false,
                Phase::BroadPhase if aabbs_due => return &[Phase::UpdateAabbs],
                Phase::BroadPhase => lists_due = false,
                // Those of this step are done: nobody looks at lists.
                Phase::HandleCollisions if self.status.collided != 0 => {}
                _ if lists_due => return &[Phase::UpdateAabbs, Phase::BroadPhase],
                _ => {}
            }
        }
        &[]
    }

    /// Dispatches a step of the last batch that made lists, or looked whether to.
    fn list_dispatches(&self) -> f32 {
        if !self.engine.dispatches() {
            return 0.0;
        }
        let making = Phase::STEP.into_iter().filter(|phase| phase.makes_lists());
        let runs = making.flat_map(|phase| phase.stages(self.options.integrator, self.broad_phase_method()));
        runs.filter(|run| run.workgroups(&self.world.step) > 0).count() as f32 / self.world.step.list_interval
    }

    /// Keeps account of whether AABBs and lists fit the scene.
    fn note_lists(&mut self, phases: &[Phase], done: u64) {
        let void = self.status.rejected;
        if phases.contains(&Phase::UpdateAabbs) {
            self.aabbs_due = false;
        }
        if phases.contains(&Phase::BroadPhase) && (done > 0 || void & REJECTED_PAIRS == 0) {
            self.lists_due = false;
        }
        // A step that is void from its collisions on may have begun to make AABBs and lists.
        self.lists_due |= void & (REJECTED_PAIRS | REJECTED_ESCAPED | REJECTED_COLLISIONS) != 0;
        self.aabbs_due |= void & (REJECTED_ESCAPED | REJECTED_COLLISIONS) != 0;
    }

    /// Mends what made a step void, for it to be run again.
    fn mend(&mut self, attempts: u32) -> Result<()> {
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
        if status.rejected == 0 {
            return Ok(());
        }
        self.report.replays += 1;
        if status.rejected & REJECTED_COLLISIONS != 0 {
            self.begin_sweeps()?;
            if status.rejected & !REJECTED_MANY == REJECTED_COLLISIONS {
                return Ok(());
            }
        }
        let escape = f32::from_bits(status.escape_ratio);
        let interval = self.world.step.list_interval as u32;
        if status.rejected == REJECTED_ESCAPED && escape < NEAR && self.interval.forgives(interval) {
            self.window.voids += 1;
            if interval == LONGEST {
                self.world.step.margin_scale += escape + NEAR_STEP;
            }
            return Ok(());
        }
        self.window.restart();
        if attempts > MAX_ATTEMPTS {
            let reason =
                format!("{} rows of pairs needed, AABB margin {}", status.pair_rows_needed, self.world.step.margin_scale);
            return Err(Error::Stuck { step: self.report.steps + 1, attempts, reason });
        }
        if status.rejected & REJECTED_COUNT != 0 {
            self.status.pair_rows_needed = u32::MAX;
        }
        if status.rejected & (REJECTED_PAIRS | REJECTED_COUNT) != 0 {
            let movers = (self.world.step.spheres + self.world.step.rods).max(1) as f32;
            match self.lookahead.shorter(words_of(status.pair_rows_needed) as f32 / movers, self.world.step.rods > 0) {
                Some(steps) => self.world.step.lookahead = steps,
                None => self.grow_lists()?,
            }
        }
        if status.rejected & REJECTED_ESCAPED != 0 {
            self.make_room(escape, attempts);
        }
        Ok(())
    }

    /// After a step in which a body was so far outside of its AABB, in 0.02 r.
    fn make_room(&mut self, escape: f32, attempts: u32) {
        let step = &mut self.world.step;
        if self.interval.failed(step.list_interval as u32) {
            step.lookahead = self.lookahead.give_up().unwrap_or(step.lookahead);
            return;
        }
        // At first a little more: all AABBs become so much larger. After so many attempts no finite margin will do: some force is beyond all
        // measure.
        step.margin_scale = match attempts {
            0 => step.margin_scale + 1.25 * escape + MARGIN_STEP,
            1..=16 => (step.margin_scale + escape) * 1.25,
            _ => f32::INFINITY,
        };
    }

    /// Adds what a portion did, since the status before it, to the report.
    pub(super) fn book(&mut self, done: u64, before: &Status) {
        if done == 0 {
            return;
        }
        self.count_calm(done, before);
        let status = &self.status;
        // Small spheres between large ones are pushed hard. Among others to look at it would take longer than it saves.
        self.has_stages = self.options.integrator == Integrator::Rk4 && self.world.step.large > 0;
        let total = |status: &Status| u64::from(status.total_collisions_high) << 32 | u64::from(status.total_collisions_low);
        self.report.steps += done;
        self.report.time += done as f64 * f64::from(self.time_step);
        self.report.contacts = status.last_contacts;
        self.report.max_overlap = f32::from_bits(status.last_max_overlap);
        self.report.collisions = status.last_collisions;
        self.report.total_collisions += total(status) - total(before);
        self.report.non_finite += u64::from(status.total_bad.wrapping_sub(before.total_bad));
        self.report.list_builds += u64::from(status.builds.wrapping_sub(before.builds));
        let step = &mut self.world.step;
        let decay = if step.has_long_lists() { MARGIN_DECAY_OF_LONG } else { MARGIN_DECAY };
        let sunk = step.margin_scale * decay.powf(done as f32);
        step.margin_scale = if sunk.is_finite() { sunk.max(MIN_MARGIN) } else { MIN_MARGIN };
    }

    /// Looks at lookahead and interval anew, once enough steps were done with them.
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
            rejections_per_step: self.window.voids as f32 / self.window.steps as f32,
            words_per_mover: words_of(self.status.pair_rows_needed) as f32 / movers,
            room_per_mover: Lookahead::room(words_of(step.pair_rows) as f32 / movers, step.rods > 0),
            movers,
            has_rods: step.rods > 0,
            dispatches: self.list_dispatches(),
        };
        self.world.step.lookahead = self.lookahead.after(&seen, self.broad_phase_method());
        if self.interval.lasted() {
            self.lookahead.hurry();
        }
        self.window.restart();
    }

    /// Steps of a window.
    fn batch(&self) -> u64 {
        if !is_small(&self.world.step) {
            return BATCH;
        }
        BATCH.max(BATCH_OF_SMALL * u64::from(self.list_interval(true)))
    }

    /// Makes the pair lists a quarter larger than what was needed.
    fn grow_lists(&mut self) -> Result<()> {
        let needed = self.status.pair_rows_needed;
        let rows = room_for(needed)?;
        let before = self.world.step.pair_rows;
        self.world.set_pair_room(rows);
        self.engine.complete(&mut self.world);
        let grown = self.engine.resize_lists(&self.world);
        if grown.is_err() {
            // With fewer objects it may go on: they must not ask for the room that there is not.
            self.world.set_pair_room(before);
        }
        grown
    }
}

/// Rows for entries where so many are needed.
fn room_for(needed: u32) -> Result<u32> {
    if needed > MAX_PAIR_ROWS {
        let bytes = |rows: u32| 4 * words_of(rows);
        return Err(Error::DeviceLimit { what: "the pair lists", needed: bytes(needed), limit: bytes(MAX_PAIR_ROWS) });
    }
    Ok(needed.saturating_add(needed.div_ceil(4)).min(MAX_PAIR_ROWS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::layout::{SLICE, most_objects};

    /// In the second attempt at a step whose collisions are done, lists are not made twice, and not for bodies that may turn back.
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

    /// The margin after a step in which a body left its AABB by half of what an exception may.
    #[cfg(not(target_family = "wasm"))]
    fn margin_after_exception(interval: u32) -> f32 {
        let options = crate::Options::new().backend(crate::Backend::Cpu);
        let mut simulation = Simulation::with_options(crate::Scene::new(), options).unwrap();
        simulation.world.step.list_interval = interval as f32;
        (simulation.status.rejected, simulation.status.escape_ratio) = (REJECTED_ESCAPED, (0.5 * NEAR).to_bits());
        simulation.mend(0).unwrap();
        simulation.world.step.margin_scale
    }

    #[test]
    #[cfg(not(target_family = "wasm"))]
    fn an_exception_raises_margins_where_lists_last_longest() {
        assert_eq!(margin_after_exception(LONGEST / 2), MIN_MARGIN);
        assert_eq!(margin_after_exception(LONGEST), MIN_MARGIN + 0.5 * NEAR + NEAR_STEP);
    }

    #[test]
    fn lists_grow_up_to_what_32_bits_can_number() {
        assert_eq!(room_for(1_000).unwrap(), 1_250);
        // A quarter more is more than there may be, or than 32 bits hold.
        for needed in [MAX_PAIR_ROWS / 8 * 7, MAX_PAIR_ROWS] {
            assert_eq!(room_for(needed).unwrap(), MAX_PAIR_ROWS);
        }
        assert!(matches!(room_for(MAX_PAIR_ROWS + 1), Err(Error::DeviceLimit { .. })));
        assert!(matches!(room_for(u32::MAX), Err(Error::DeviceLimit { .. })));
        // Counts and slice offsets of as many movers as there may be stand before the entries.
        let slices = most_objects(false).div_ceil(SLICE);
        assert!(MAX_PAIR_ROWS.checked_add(slices + slices.div_ceil(SLICE) + 1).is_some());
    }
}
