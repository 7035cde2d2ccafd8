//! The files that `run` writes. Floats are printed as Rust prints them: the shortest text that reads back bit for bit.

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
        Ok(Self {
            path: path.to_owned(),
            file,
        })
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
            numbers(file, &energies)?;
            numbers(file, &energy.momentum.to_array())?;
            numbers(file, &energy.angular_momentum.to_array())?;
            writeln!(file, ",{},{},{}", report.max_overlap, report.contacts, report.collisions)
        })
    }
}

fn numbers(file: &mut AtomicFile, numbers: &[impl std::fmt::Display]) -> io::Result<()> {
    numbers.iter().try_for_each(|number| write!(file, ",{number}"))
}
