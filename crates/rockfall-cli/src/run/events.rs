//! The file of `--events`: contacts that begin and end, and what enters and leaves sensors.

use std::io::{self, Write};
use std::path::PathBuf;

use rockfall::glam::Vec3;
use rockfall::output::Mark;
use rockfall::{ContactChange, ContactEvent, Party, Scene, SensorChange, SensorEvent, Simulation};
use rockfall_trajectory::csv::numbers;

use super::past::{Past, PastFile};
use super::samples::Samples;
use crate::failure::Failure;

const HEADER: &str = "step,time,event,a,b,x,y,z,nx,ny,nz,fx,fy,fz";

/// A file to which every step may add lines.
pub(super) struct EventsFile(pub(super) Samples);

impl EventsFile {
    pub(super) fn open(path: PathBuf, mark: Option<Mark>) -> Result<Self, Failure> {
        Samples::open("--events", HEADER, path, Some(1), mark).map(Self)
    }

    /// Begins to note events. What is there in the first state has none.
    pub(super) fn begin(simulation: &mut Simulation) -> Result<(), Failure> {
        simulation.watch_contacts(true)?;
        Ok(simulation.watch_sensors(true)?)
    }

    /// Adds the events since the last call: in the order of steps, in each first those of contacts.
    pub(super) fn add(&mut self, simulation: &mut Simulation, past: &Past) -> Result<(), Failure> {
        let (contacts, sensors) = (simulation.contact_events()?, simulation.sensor_events()?);
        let mut sensors = sensors.iter().peekable();
        let scene = simulation.scene();
        self.0.add(|file| {
            for event in &contacts {
                while let Some(sensor) = sensors.next_if(|sensor| sensor.step < event.step) {
                    of_sensor(file, sensor, scene, past)?;
                }
                of_contact(file, event, past)?;
            }
            sensors.try_for_each(|sensor| of_sensor(file, sensor, scene, past))
        })
    }

    pub(super) fn as_past(&mut self) -> Result<PastFile, Failure> {
        self.0.as_past()
    }
}

fn of_contact(file: &mut impl Write, event: &ContactEvent, past: &Past) -> io::Result<()> {
    let change = if event.change == ContactChange::Begin { "begin" } else { "end" };
    begin_line(file, event.step, event.time, change, past)?;
    write!(file, ",{},{}", name(&event.a), name(&event.b))?;
    for vector in [event.point, event.normal, event.force] {
        // Adding 0 turns -0 into 0.
        let vector: Vec3 = vector + 0.0;
        numbers(file, &vector.to_array())?;
    }
    writeln!(file)
}

fn of_sensor(file: &mut impl Write, event: &SensorEvent, scene: &Scene, past: &Past) -> io::Result<()> {
    let change = if event.change == SensorChange::Enter { "enter" } else { "leave" };
    begin_line(file, event.step, event.time, change, past)?;
    let sensor = scene.sensors().get(event.sensor).map_or("", |sensor| sensor.name.as_str());
    write!(file, ",{},{sensor}", name(&event.object))?;
    numbers(file, &(event.centre + 0.0).to_array())?;
    writeln!(file, ",,,,,,")
}

/// The whole step, of which the step of the simulation may be a part, the time, and what happened.
fn begin_line(file: &mut impl Write, step: u64, time: f64, change: &str, past: &Past) -> io::Result<()> {
    write!(file, "{}", past.step(step + u64::from(past.parts()) - 1))?;
    numbers(file, &[time])?;
    write!(file, ",{change}")
}

/// The kind of an object and its index among those of its kind.
fn name(party: &Party) -> String {
    format!("{} {}", party.kind(), party.index)
}
