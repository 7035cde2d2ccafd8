//! Where the time of a step goes: what [`Simulation::profile`](crate::Simulation::profile) gives.

use crate::model::status::Status;
use crate::model::step::Step;
use crate::step::schedule::{Phase, Run};
use crate::traffic;

/// What the times of the stages were taken with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Clock {
    /// Timestamps of the device, between the dispatches of one compute pass.
    DeviceInPass,
    /// Timestamps of the device, at the beginning and end of compute passes, each with one dispatch: for devices without
    /// the others. What lies between passes is left out.
    DeviceAroundPasses,
    /// The host's clock: the CPU backend.
    Host,
}

impl Clock {
    /// Its name in reports.
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
    /// The stages that did anything, in the order of the step; what is run in several passes is added up.
    pub stages: Vec<StageTime>,
    /// Wall time of all steps, in s, with what the host does; the timestamps themselves cost time too. 0 in a browser.
    pub seconds: f64,
    /// Steps done.
    pub steps: u64,
    /// Time of stages in steps that turned out void and were run again, in s; it is not in `stages`.
    pub rejected_seconds: f64,
    /// What the times were taken with.
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
    /// How often it was dispatched.
    pub runs: u64,
    /// Time of all its runs, in s.
    pub seconds: f64,
    /// Bytes that all its runs had to move at least; see ARCHITECTURE.md, "Bytes that a step must move".
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

    /// Bytes that all steps had to move at least.
    pub fn least_bytes(&self) -> u64 {
        self.stages.iter().map(|stage| stage.least_bytes).sum()
    }

    /// Dispatches of all steps.
    pub fn runs(&self) -> u64 {
        self.stages.iter().map(|stage| stage.runs).sum()
    }
}

/// A buffer and its size.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BufferSize {
    /// What it holds.
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
    /// The phase of each run of the batch under way.
    phases: Vec<Phase>,
    pub(crate) stages: Vec<StageTime>,
    pub(crate) rejected_seconds: f64,
}

/// The times of a batch: of each step, of each run, in s; `None` where there was nothing to do.
pub(crate) type Times = Vec<Vec<Option<f64>>>;

impl Recorder {
    /// Tells which phases the runs of the next batch belong to.
    pub(crate) fn expect(&mut self, phases: Vec<Phase>) {
        self.phases = phases;
    }

    /// Takes the times of a batch. Of its steps, the first were `done`; what came after was void.
    pub(crate) fn book(&mut self, runs: &[Run], times: &Times, done: u32, step: &Step, status: &Status) {
        let (done, void) = times.split_at(times.len().min(done as usize));
        self.rejected_seconds += void.iter().flatten().flatten().sum::<f64>();
        for (index, run) in runs.iter().enumerate() {
            let taken: Vec<f64> = done.iter().filter_map(|step| step[index]).collect();
            if taken.is_empty() {
                continue;
            }
            let least_bytes = traffic::least_bytes(run, step, status);
            let stage = self.stage(run.stage.name, self.phases[index]);
            stage.runs += taken.len() as u64;
            stage.seconds += taken.iter().sum::<f64>();
            stage.least_bytes += taken.len() as u64 * least_bytes;
        }
    }

    fn stage(&mut self, name: &'static str, phase: Phase) -> &mut StageTime {
        let known = self.stages.iter().position(|stage| stage.name == name && stage.phase == phase);
        let at = known.unwrap_or(self.stages.len());
        if known.is_none() {
            self.stages.push(StageTime { name, phase, runs: 0, seconds: 0.0, least_bytes: 0 });
        }
        &mut self.stages[at]
    }
}
