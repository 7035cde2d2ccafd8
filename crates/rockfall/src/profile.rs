//! Times of the stages of a step, as returned by [`Simulation::profile`](crate::Simulation::profile).

use crate::model::status::Status;
use crate::model::step::Step;
use crate::step::schedule::{Phase, Run};
use crate::step::traffic;

/// The clock that measured the times of the stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Clock {
    /// Timestamps of the device, between the dispatches of one compute pass.
    DeviceInPass,
    /// Timestamps of the device, at the beginning and end of compute passes with one dispatch each, for devices without
    /// timestamps inside passes. Time between passes is not measured.
    DeviceAroundPasses,
    /// The host's clock, on the CPU backend.
    Host,
}

impl Clock {
    /// Name of the clock in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::DeviceInPass => "device timestamps",
            Self::DeviceAroundPasses => "device timestamps around passes",
            Self::Host => "host clock",
        }
    }
}

/// The time that steps took, stage by stage.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Profile {
    /// The stages that had work, in the order of the step. The passes of a stage are added up.
    pub stages: Vec<StageTime>,
    /// Wall time of all steps, in s, including the host's work and the cost of the timestamps themselves. 0 in a browser.
    pub seconds: f64,
    /// Number of steps done.
    pub steps: u64,
    /// Time of the stages in rejected steps, in s. It is not included in `stages`.
    pub rejected_seconds: f64,
    /// The clock that measured the times.
    pub clock: Clock,
}

/// The time of a stage over all steps.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StageTime {
    /// Name of the stage.
    pub name: &'static str,
    /// The phase that it is part of.
    pub phase: Phase,
    /// Number of dispatches.
    pub runs: u64,
    /// Time of all its dispatches, in s.
    pub seconds: f64,
    /// Least number of bytes that all its dispatches had to move; see docs/performance.md, "Bytes that a step must move".
    pub least_bytes: u64,
}

impl Profile {
    /// Time of a phase over all steps, in s.
    pub fn phase_seconds(&self, phase: Phase) -> f64 {
        let of_phase = self.stages.iter().filter(|stage| stage.phase == phase);
        of_phase.map(|stage| stage.seconds).sum()
    }

    /// Time of all stages over all steps, in s.
    pub fn stage_seconds(&self) -> f64 {
        self.stages.iter().map(|stage| stage.seconds).sum()
    }

    /// Least number of bytes that all steps had to move.
    pub fn least_bytes(&self) -> u64 {
        self.stages.iter().map(|stage| stage.least_bytes).sum()
    }

    /// Adds the times of steps that were measured afterwards, with the same clock.
    pub fn append(&mut self, later: Self) {
        for stage in later.stages {
            let own = stage_of(&mut self.stages, stage.name, stage.phase);
            own.runs += stage.runs;
            own.seconds += stage.seconds;
            own.least_bytes += stage.least_bytes;
        }
        self.seconds += later.seconds;
        self.steps += later.steps;
        self.rejected_seconds += later.rejected_seconds;
    }

    /// Number of dispatches of all steps.
    pub fn runs(&self) -> u64 {
        self.stages.iter().map(|stage| stage.runs).sum()
    }
}

/// A buffer and its size.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BufferSize {
    /// Name of its contents.
    pub name: &'static str,
    /// Its size in bytes.
    pub bytes: u64,
}

impl BufferSize {
    pub(crate) fn new(name: &'static str, bytes: u64) -> Self {
        Self { name, bytes }
    }
}

/// Collects the times of the batches that an engine runs.
#[derive(Debug, Default)]
pub(crate) struct Recorder {
    /// The phase of each run of the current batch.
    phases: Vec<Phase>,
    pub(crate) stages: Vec<StageTime>,
    pub(crate) rejected_seconds: f64,
}

/// The times of a batch in s, indexed by step and then by run; `None` if the run had no work.
pub(crate) type Times = Vec<Vec<Option<f64>>>;

impl Recorder {
    /// Sets the phases that the runs of the next batch belong to.
    pub(crate) fn expect(&mut self, phases: Vec<Phase>) {
        self.phases = phases;
    }

    /// Adds the times of a batch. Its first `done` steps were done, and the later ones were rejected. The batches of a step that may be
    /// rejected have one step, because a step that is done may follow a rejected one.
    pub(crate) fn book(&mut self, runs: &[Run], times: &Times, done: u32, step: &Step, status: &Status) {
        let (done, rejected) = times.split_at(times.len().min(done as usize));
        self.rejected_seconds += rejected.iter().flatten().flatten().sum::<f64>();
        for (index, run) in runs.iter().enumerate() {
            let taken: Vec<f64> = done.iter().filter_map(|step| step[index]).collect();
            if taken.is_empty() {
                continue;
            }
            let least_bytes = traffic::least_bytes(run, step, status);
            let stage = stage_of(&mut self.stages, run.stage.name, self.phases[index]);
            stage.runs += taken.len() as u64;
            stage.seconds += taken.iter().sum::<f64>();
            stage.least_bytes += taken.len() as u64 * least_bytes;
        }
    }
}

/// The times of a stage, which is added if it is not there.
fn stage_of<'a>(stages: &'a mut Vec<StageTime>, name: &'static str, phase: Phase) -> &'a mut StageTime {
    let known = stages.iter().position(|stage| stage.name == name && stage.phase == phase);
    let at = known.unwrap_or(stages.len());
    if known.is_none() {
        stages.push(StageTime { name, phase, runs: 0, seconds: 0.0, least_bytes: 0 });
    }
    &mut stages[at]
}
