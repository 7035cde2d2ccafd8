//! Handing steps to the engine, portion by portion, and looking at what became of them without making it wait.
//!
//! A device works on one portion while the status after the one before travels to the host. Where that tells of a void step, the
//! portion under way is void, too: its stages return at once, and nothing is lost but their time.

use std::collections::VecDeque;

use crate::error::Result;
use crate::model::layout::FLAG_STAGES;
use crate::model::status::{Counters, NO_BODY, REBUILD_REQUESTED, Status};
use crate::profile::Recorder;
use crate::simulation::Simulation;
use crate::simulation::drive::{COLLISIONS_FIRST, WITHOUT_COLLISIONS};
use crate::simulation::engine::Look;
use crate::step::fused::run_steps::is_small;
use crate::step::schedule::{Phase, Run};

/// Portions that a device has before it at a time.
const DEPTH: usize = 2;
/// Steps of a portion of a small scene, and on the CPU: there a void step costs little.
const LARGE_PORTION: u64 = 32;
/// The most of any other: after a void step what is left of two portions is void, and costs a dispatch a stage.
const PORTION: u64 = 4;
/// Movers times steps of one that takes a large device some milliseconds, many times as long as the status takes to come.
const MOVED: u32 = 1 << 21;
/// AABBs stand half a step ahead: then they need to reach half as far for its way.
const LEAD: f32 = 0.5;

/// A portion that was submitted.
struct Portion {
    look: Look,
    steps: u64,
    /// Which lookahead and interval it ran with.
    settings: u32,
}

/// What one run through phases needs to know from portion to portion.
struct Stretch<'a> {
    phases: &'a [Phase],
    is_step: bool,
    interval: u32,
    /// Steps since the last chance of making lists.
    since: u32,
}

impl Simulation {
    /// Runs phases up to `most` times over, until a step is void; returns how often they were done.
    pub(super) async fn stretch(&mut self, phases: &[Phase], most: u64, mut recorder: Option<&mut Recorder>) -> Result<u64> {
        let is_step = phases.starts_with(&COLLISIONS_FIRST) || phases.starts_with(&WITHOUT_COLLISIONS);
        let mut stretch = Stretch { phases, is_step, interval: 1, since: 0 };
        self.begin(&stretch)?;
        // To time the stages of a portion is to wait for it.
        let depth = if self.engine.dispatches() && recorder.is_none() { DEPTH } else { 1 };
        let mut flight = VecDeque::with_capacity(depth);
        let (mut submitted, mut done) = (0, 0);
        loop {
            while self.status.rejected == 0 && submitted < most && flight.len() < depth {
                let steps = self.portion().min(most - submitted);
                flight.push_back(self.submit(&mut stretch, steps, recorder.as_deref_mut()).await?);
                submitted += steps;
            }
            let Some(portion) = flight.pop_front() else {
                return Ok(done);
            };
            done += self.land(&stretch, portion).await?;
        }
    }

    /// Gives the engine the status to begin with.
    fn begin(&mut self, stretch: &Stretch<'_>) -> Result<()> {
        let makes_lists = stretch.phases.iter().any(|phase| phase.makes_lists());
        if (makes_lists && !stretch.is_step) || self.status.rejected != 0 || self.lists_due || self.aabbs_due {
            self.status.rebuild = REBUILD_REQUESTED;
        }
        self.status = resumed(self.status);
        self.world.status = self.status;
        self.engine.begin(&self.world)
    }

    async fn submit(&mut self, stretch: &mut Stretch<'_>, steps: u64, mut recorder: Option<&mut Recorder>) -> Result<Portion> {
        let interval = self.list_interval(stretch.is_step);
        if interval != stretch.interval {
            (stretch.interval, stretch.since) = (interval, 0);
        }
        let (integrator, broad_phase) = (self.options.integrator, self.broad_phase_method());
        let runs = |phase: Phase| {
            let every = if phase.makes_lists() { interval } else { 1 };
            phase.stages(integrator, broad_phase).iter().map(move |run| (phase, Run { every, ..*run }))
        };
        let (owners, stages): (Vec<Phase>, Vec<Run>) = stretch.phases.iter().copied().flat_map(runs).unzip();
        let step = &mut self.world.step;
        step.dt = self.time_step;
        step.list_interval = interval as f32;
        step.flags = step.flags & !FLAG_STAGES | if self.has_stages { FLAG_STAGES } else { 0 };
        // Where impulses come after the lists, a body may turn back at once.
        step.lead = if stretch.is_step { LEAD } else { 0.0 };
        self.synced = false;
        let range = stretch.since..stretch.since + steps as u32;
        stretch.since = range.end % interval;
        if let Some(recorder) = &mut recorder {
            recorder.expect(owners);
        }
        let look = self.engine.submit(&mut self.world, &stages, range, recorder).await?;
        Ok(Portion { look, steps, settings: self.window.settings })
    }

    /// Looks at the status after a portion, and takes over what it tells; returns how often the phases were done.
    async fn land(&mut self, stretch: &Stretch<'_>, portion: Portion) -> Result<u64> {
        let status = portion.look.status().await?;
        let before = std::mem::replace(&mut self.status, status);
        if !stretch.phases.contains(&Phase::UpdatePositions) {
            return Ok(if status.rejected == 0 { portion.steps } else { 0 });
        }
        let done = u64::from(status.steps.wrapping_sub(before.steps));
        self.book(done, &before);
        if done == portion.steps && portion.settings == self.window.settings {
            self.adapt(done, status.builds.wrapping_sub(before.builds));
        }
        Ok(done)
    }

    /// Steps to hand over at once.
    fn portion(&self) -> u64 {
        let step = &self.world.step;
        if !self.engine.dispatches() || is_small(step) {
            return LARGE_PORTION;
        }
        u64::from(MOVED / (step.spheres + step.rods).max(1)).clamp(1, PORTION)
    }

    /// Steps from one chance of making lists to the next.
    pub(super) fn list_interval(&self, is_step: bool) -> u32 {
        let may_wait = is_step && self.engine.dispatches();
        if may_wait { self.interval.steps(self.world.step.lookahead) } else { 1 }
    }
}

/// The status with which steps are begun, or tried again: counters begin at zero, those of a void attempt are dropped, what was
/// done stays done.
fn resumed(status: Status) -> Status {
    let is_done = status.collided != 0;
    Status {
        counters: status
            .counters
            .map(|told| Counters { collisions: if is_done { told.collisions } else { 0 }, ..Counters::default() }),
        collides: if is_done { status.collides } else { 0 },
        listed: 0,
        clustered: if is_done { status.clustered } else { 0 },
        clustered_steps: 0,
        many_steps: 0,
        rejected: 0,
        escape_ratio: 0,
        bad_count: 0,
        bad_body: NO_BODY,
        collided: status.collided.min(1),
        steps: 0,
        builds: 0,
        total_collisions_low: 0,
        total_collisions_high: 0,
        total_bad: 0,
        ..status
    }
}
