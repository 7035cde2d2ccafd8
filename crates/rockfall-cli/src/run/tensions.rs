//! The file of `--tensions`: the lengths and tensions of springs and tethers at the end, or at a fixed interval.

use std::io::Write;
use std::path::PathBuf;

use rockfall::output::Mark;
use rockfall::{Body, Link, Scene, Simulation, SphereId, Tension};
use rockfall_trajectory::csv::numbers;

use super::past::Past;
use super::samples::Samples;
use crate::failure::Failure;

const HEADER: &str = "step,time,kind,index,a,b,length,tension";

pub(super) struct TensionsFile(pub(super) Samples);

impl TensionsFile {
    pub(super) fn open(path: PathBuf, every: Option<u64>, mark: Option<Mark>) -> Result<Self, Failure> {
        Samples::open("--tensions", HEADER, path, every, mark).map(Self)
    }

    /// Adds the present state if one is due after this step.
    pub(super) fn after_step(&mut self, simulation: &mut Simulation, past: &Past, step: u64) -> Result<(), Failure> {
        if self.0.is_due(step) { self.add(simulation, past) } else { Ok(()) }
    }

    fn add(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        let step = past.step(simulation.report().steps);
        let tensions = simulation.tensions()?;
        let rows = rows(&tensions, simulation.scene())?;
        self.0.add(|file| {
            let mut prefix = step.to_string().into_bytes();
            numbers(&mut prefix, &[past.time(step)])?;
            rows.iter().try_for_each(|row| file.write_all(&prefix).and_then(|()| file.write_all(row)))
        })
    }

    pub(super) fn finish(mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        if self.0.has_end() {
            self.add(simulation, past)?;
        }
        self.0.commit()
    }
}

/// The line of each spring and tether, after the step and the time.
fn rows(tensions: &[Tension], scene: &Scene) -> Result<Vec<Vec<u8>>, Failure> {
    let springs = scene.springs().len();
    let number = |id: SphereId| Body::Sphere(id).index(scene);
    let row = |(place, tension): (usize, &Tension)| {
        let (kind, index) = match tension.link {
            Link::Spring(id) if scene.spring(id)?.muscle.is_some() => ("muscle", place),
            Link::Spring(_) => ("spring", place),
            _ => ("tether", place - springs),
        };
        let b = tension.b.map(number).transpose()?.map_or(String::new(), |b| b.to_string());
        let mut line = format!(",{kind},{index},{},{b}", number(tension.a)?).into_bytes();
        // Adding 0 turns -0 into 0. Writing to memory cannot fail.
        let _ = numbers(&mut line, &[tension.length, tension.force + 0.0]);
        line.push(b'\n');
        Ok(line)
    };
    tensions.iter().enumerate().map(row).collect()
}
