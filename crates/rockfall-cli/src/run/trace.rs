//! The file of `--trace`: energies, momenta, counts and work, for every step or every K-th one.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::output::{AtomicFile, Mark};
use rockfall::{Energy, Error, Meter, Report, Simulation};
use rockfall_trajectory::csv::numbers;

use super::errors::lost;
use super::past::{Past, PastFile};
use crate::failure::Failure;

const HEADER: &str = "step,time,kinetic,potential,spring,contact,momentum_x,momentum_y,momentum_z,\
                      angular_x,angular_y,angular_z,max_overlap,contacts,collisions,work,dissipated";

pub(super) struct TraceFile {
    path: PathBuf,
    file: AtomicFile,
    /// Steps between two lines; every step if it is not given.
    every: Option<u64>,
    is_new: bool,
    /// Total number of collisions up to the last line, once it is known.
    collisions: Option<u64>,
    /// Total energy at the first line, once it is known.
    energy: Option<f64>,
}

impl TraceFile {
    /// Begins a file, or continues that of the earlier run `past` at a mark.
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>, past: Option<&Past>) -> Result<Self, Failure> {
        let file = match mark {
            Some(mark) => AtomicFile::resume(&path, mark)
                .map_err(|source| lost(&Error::File { file: path.clone(), source }, "--trace"))?,
            None => AtomicFile::create(&path).map_err(|error| Failure::file(&path, &error))?,
        };
        let past = past.filter(|_| mark.is_some());
        let collisions = past.and_then(|past| past.traced_collisions);
        let energy = past.and_then(|past| past.traced_energy).map(f64::from_bits);
        Ok(Self { path, file, every, is_new: mark.is_none(), collisions, energy })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn is_new(&self) -> bool {
        self.is_new
    }

    /// Steps between two lines.
    pub(super) fn every(&self) -> u64 {
        self.every.unwrap_or(1)
    }

    /// Writes the header and the state before the first step to a new file.
    pub(super) fn begin(&mut self, simulation: &mut Simulation, past: &Past, meter: &Meter) -> Result<(), Failure> {
        self.collisions.get_or_insert(simulation.report().total_collisions);
        if !self.is_new {
            return Ok(());
        }
        writeln!(self.file, "{HEADER}").map_err(|error| Failure::file(&self.path, &error))?;
        self.add(simulation, past, meter)
    }

    /// Adds the line of the present state if one is due after this step.
    pub(super) fn after_step(
        &mut self,
        simulation: &mut Simulation,
        past: &Past,
        meter: &Meter,
        step: u64,
    ) -> Result<(), Failure> {
        if step.is_multiple_of(self.every()) { self.add(simulation, past, meter) } else { Ok(()) }
    }

    fn add(&mut self, simulation: &mut Simulation, past: &Past, meter: &Meter) -> Result<(), Failure> {
        let energy = simulation.energy()?;
        let report: Report = simulation.report();
        let before = self.collisions.replace(report.total_collisions).unwrap_or_default();
        let collisions = report.total_collisions.saturating_sub(before);
        let first = *self.energy.get_or_insert(energy.total());
        let is_known = Meter::knows_dissipation(simulation.scene()) && !past.changed;
        let dissipated = is_known.then(|| meter.work - (energy.total() - first));
        line(&mut self.file, past, &energy, &report, collisions, meter.work, dissipated)
            .map_err(|error| Failure::file(&self.path, &error))
    }

    /// Notes in a checkpoint how far the file was written.
    pub(super) fn put(&mut self, past: &mut Past) -> Result<(), Failure> {
        let mark = self.file.mark().map_err(|error| Failure::file(&self.path, &error))?;
        past.trace = Some(PastFile::new(self.path.clone(), mark));
        (past.trace_every, past.traced_collisions) = (self.every, self.collisions);
        past.traced_energy = self.energy.map(f64::to_bits);
        Ok(())
    }

    pub(super) fn finish(self) -> Result<(), Failure> {
        self.file.commit().map_err(|error| Failure::file(&self.path, &error))
    }
}

fn line(
    file: &mut AtomicFile,
    past: &Past,
    energy: &Energy,
    report: &Report,
    collisions: u64,
    work: f64,
    dissipated: Option<f64>,
) -> io::Result<()> {
    let step = past.step(report.steps);
    write!(file, "{step}")?;
    let energies = [energy.kinetic, energy.potential, energy.spring, energy.contact];
    numbers(file, &[past.time(step)])?;
    // Adding 0 turns -0, the value of an empty sum, into 0.
    numbers(file, &energies.map(|energy| energy + 0.0))?;
    numbers(file, &(energy.momentum + 0.0).to_array())?;
    numbers(file, &(energy.angular_momentum + 0.0).to_array())?;
    numbers(file, &[report.max_overlap])?;
    write!(file, ",{},{collisions}", report.contacts)?;
    numbers(file, &[work + 0.0])?;
    match dissipated {
        Some(dissipated) => numbers(file, &[dissipated + 0.0])?,
        None => write!(file, ",")?,
    }
    writeln!(file)
}
