//! The files that `run` writes.

use std::fmt::{Display, LowerExp};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rockfall::output::AtomicFile;
use rockfall::{Report, Simulation, SphereState};

use crate::failure::Failure;

const STATE_HEADER: &str = "sphere,x,y,z,vx,vy,vz,qw,qx,qy,qz,lx,ly,lz";
const TRACE_HEADER: &str = "step,time,kinetic,potential,spring,contact,momentum_x,momentum_y,momentum_z,\
                            angular_x,angular_y,angular_z,max_overlap,contacts,collisions";

/// A file that was opened before the run, so that a bad path shows before it.
pub(crate) struct Output {
    path: PathBuf,
    file: AtomicFile,
}

impl Output {
    pub(crate) fn create(path: &Path) -> Result<Self, Failure> {
        let file = AtomicFile::create(path).map_err(|error| Failure::file(path, &error))?;
        Ok(Self { path: path.to_owned(), file })
    }

    fn write(&mut self, write: impl FnOnce(&mut AtomicFile) -> io::Result<()>) -> Result<(), Failure> {
        write(&mut self.file).map_err(|error| Failure::file(&self.path, &error))
    }

    /// Puts the file in its place.
    pub(crate) fn commit(self) -> Result<(), Failure> {
        self.file.commit().map_err(|error| Failure::file(&self.path, &error))
    }

    /// One line a sphere, in order of addition.
    pub(crate) fn state(&mut self, spheres: &[SphereState]) -> Result<(), Failure> {
        self.write(|file| {
            writeln!(file, "{STATE_HEADER}")?;
            for (index, sphere) in spheres.iter().enumerate() {
                let q = sphere.orientation;
                write!(file, "{index}")?;
                numbers(file, &sphere.position.to_array())?;
                numbers(file, &sphere.velocity.to_array())?;
                numbers(file, &[q.w, q.x, q.y, q.z])?;
                numbers(file, &sphere.angular_momentum.to_array())?;
                writeln!(file)?;
            }
            Ok(())
        })
    }

    pub(crate) fn trace_header(&mut self) -> Result<(), Failure> {
        self.write(|file| writeln!(file, "{TRACE_HEADER}"))
    }

    /// The line of the state that the simulation is in.
    pub(crate) fn trace(&mut self, simulation: &mut Simulation) -> Result<(), Failure> {
        let energy = simulation.energy()?;
        let report: Report = simulation.report();
        self.write(|file| {
            write!(file, "{}", report.steps)?;
            let energies = [energy.kinetic, energy.potential, energy.spring, energy.contact];
            numbers(file, &[report.time])?;
            // An empty sum is -0, which nobody wants to read.
            numbers(file, &energies.map(|energy| energy + 0.0))?;
            numbers(file, &(energy.momentum + 0.0).to_array())?;
            numbers(file, &(energy.angular_momentum + 0.0).to_array())?;
            numbers(file, &[report.max_overlap])?;
            writeln!(file, ",{},{}", report.contacts, report.collisions)
        })
    }
}

/// Writes numbers so that they read back bit for bit, in as few digits as that takes.
fn numbers<N: Copy + Display + LowerExp + Into<f64>>(file: &mut AtomicFile, numbers: &[N]) -> io::Result<()> {
    numbers.iter().try_for_each(|number| {
        let size = Into::<f64>::into(*number).abs();
        // Without an exponent, 1e-300 would be three hundred zeros.
        if size == 0.0 || (1e-6..1e16).contains(&size) { write!(file, ",{number}") } else { write!(file, ",{number:e}") }
    })
}
