//! What simulations report, as dictionaries and columns.

use pyo3::prelude::*;
use rockfall::profile::StageTime;
use rockfall::step::schedule::Phase;

use crate::fork::{check_graphics, detached};

/// Counts and times of all steps so far.
#[derive(Debug, IntoPyObject)]
pub(crate) struct Report {
    steps: u64,
    time: f64,
    contacts: u32,
    max_overlap: f32,
    collisions: u32,
    total_collisions: u64,
    replays: u64,
    list_builds: u64,
    non_finite: u64,
    passages: u64,
    /// Sphere and step.
    first_passage: Option<(usize, u64)>,
}

impl From<rockfall::Report> for Report {
    fn from(report: rockfall::Report) -> Self {
        Self {
            steps: report.steps,
            time: report.time,
            contacts: report.contacts,
            max_overlap: report.max_overlap,
            collisions: report.collisions,
            total_collisions: report.total_collisions,
            replays: report.replays,
            list_builds: report.list_builds,
            non_finite: report.non_finite,
            passages: report.passages,
            first_passage: report.first_passage.map(|first| (first.sphere, first.step)),
        }
    }
}

/// The backend that runs a simulation.
#[derive(Debug, IntoPyObject)]
pub(crate) struct BackendInfo {
    kind: String,
    device: String,
    driver: String,
    reason: String,
}

impl From<&rockfall::BackendInfo> for BackendInfo {
    fn from(info: &rockfall::BackendInfo) -> Self {
        Self {
            kind: info.kind.to_string(),
            device: info.device.clone(),
            driver: info.driver.clone(),
            reason: info.reason.clone(),
        }
    }
}

/// Energies and momenta.
#[derive(Debug, IntoPyObject)]
pub(crate) struct Energy {
    kinetic: f64,
    potential: f64,
    spring: f64,
    contact: f64,
    momentum: [f64; 3],
    angular_momentum: [f64; 3],
}

impl From<rockfall::Energy> for Energy {
    fn from(energy: rockfall::Energy) -> Self {
        Self {
            kinetic: energy.kinetic,
            potential: energy.potential,
            spring: energy.spring,
            contact: energy.contact,
            momentum: energy.momentum.to_array(),
            angular_momentum: energy.angular_momentum.to_array(),
        }
    }
}

/// The time that steps took.
#[derive(Debug, IntoPyObject)]
pub(crate) struct ProfileOf {
    /// Name, phase, number of dispatches, seconds and least number of bytes of every stage.
    stages: Vec<(String, String, u64, f64, u64)>,
    seconds: f64,
    steps: u64,
    rejected_seconds: f64,
    clock: String,
}

impl From<rockfall::Profile> for ProfileOf {
    fn from(profile: rockfall::Profile) -> Self {
        let stage = |stage: &StageTime| {
            (stage.name.to_owned(), phase(stage.phase).to_owned(), stage.runs, stage.seconds, stage.least_bytes)
        };
        Self {
            stages: profile.stages.iter().map(stage).collect(),
            seconds: profile.seconds,
            steps: profile.steps,
            rejected_seconds: profile.rejected_seconds,
            clock: profile.clock.name().to_owned(),
        }
    }
}

/// The name of a phase, which is that of the method that runs it alone.
fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::UpdateAabbs => "update_aabbs",
        Phase::BroadPhase => "broad_phase",
        Phase::HandleCollisions => "handle_collisions",
        Phase::UpdatePositions => "update_positions",
    }
}

/// A graphics adapter.
#[derive(Debug, IntoPyObject)]
pub(crate) struct DeviceInfo {
    name: String,
    backend: String,
    kind: String,
    driver: String,
    software: bool,
}

/// All graphics adapters.
#[pyfunction]
pub(crate) fn devices(py: Python<'_>) -> PyResult<Vec<DeviceInfo>> {
    check_graphics()?;
    let info = |info: rockfall::DeviceInfo| DeviceInfo {
        name: info.name,
        backend: info.backend,
        kind: info.kind,
        driver: info.driver,
        software: info.software,
    };
    Ok(detached(py, || rockfall::devices().into_iter().map(info).collect()))
}

/// Name, default, unit and meaning of every constant.
#[pyfunction]
pub(crate) fn constants() -> Vec<(&'static str, String, &'static str, &'static str)> {
    let defaults = rockfall::Settings::default();
    let row = |constant: &rockfall::settings::Constant| {
        (constant.name, defaults.get(constant.name).unwrap_or_default(), constant.unit, constant.doc)
    };
    rockfall::Settings::TABLE.iter().map(row).collect()
}
