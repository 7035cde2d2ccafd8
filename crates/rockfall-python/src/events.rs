//! Events: contacts that begin and end, and what enters and leaves sensors.

use numpy::PyArray1;
use pyo3::prelude::*;
use rockfall::glam::DVec3;
use rockfall::{ContactChange, ObjectId, Party, Sensor, SensorChange};

use crate::doors::with;
use crate::errors::Raise;
use crate::observe::{Matrix, matrix};
use crate::simulation::Simulation;

/// Whole numbers, times, and vectors; a row for each event.
type ContactRows<'py> = (Matrix<'py, i64>, Bound<'py, PyArray1<f64>>, Matrix<'py, f32>);
/// Whole numbers, and times with places, a row for each event; then the names of all sensors.
type SensorRows<'py> = (Matrix<'py, i64>, Matrix<'py, f64>, Vec<String>);

/// Adds a sensor.
#[pyfunction]
pub(crate) fn add_sensor(target: &Bound<'_, PyAny>, name: String, corners: [[f64; 3]; 2]) -> PyResult<()> {
    with(target, |doors, _| doors.add_sensor(Sensor::new(name, corners)).or_raise())
}

/// Begins or stops to note contacts that begin and end.
#[pyfunction]
pub(crate) fn watch_contacts(simulation: &Bound<'_, Simulation>, on: bool) -> PyResult<()> {
    simulation.get().flushed(simulation.py(), |running| {
        running.check_alone()?;
        running.simulation.watch_contacts(on).or_raise()
    })
}

/// Begins or stops to note what enters and leaves sensors.
#[pyfunction]
pub(crate) fn watch_sensors(simulation: &Bound<'_, Simulation>, on: bool) -> PyResult<()> {
    simulation.get().flushed(simulation.py(), |running| {
        running.check_alone()?;
        running.simulation.watch_sensors(on).or_raise()
    })
}

/// The contacts that began and ended. Whole numbers: step, change, kind and index of A, kind and index of B. Vectors: point, normal and
/// force.
#[pyfunction]
pub(crate) fn contact_events<'py>(simulation: &Bound<'py, Simulation>) -> PyResult<ContactRows<'py>> {
    let py = simulation.py();
    let events = simulation.get().locked(py, |running| running.simulation.contact_events().or_raise())?;
    let (mut whole, mut times, mut real) = (Vec::new(), Vec::new(), Vec::new());
    for event in events {
        whole.extend([event.step as i64, i64::from(event.change != ContactChange::Begin)]);
        [event.a, event.b].iter().for_each(|party| whole.extend(numbers(party)));
        times.push(event.time);
        [event.point, event.normal, event.force].iter().for_each(|vector| real.extend(vector.to_array()));
    }
    Ok((matrix(py, whole, 6)?, PyArray1::from_vec(py, times), matrix(py, real, 9)?))
}

/// What entered and left sensors. Whole numbers: step, change, index of the sensor, kind and index of the object. Others: time, centre.
#[pyfunction]
pub(crate) fn sensor_events<'py>(simulation: &Bound<'py, Simulation>) -> PyResult<SensorRows<'py>> {
    let py = simulation.py();
    let (events, names) = simulation.get().locked(py, |running| {
        let events = running.simulation.sensor_events().or_raise()?;
        let sensors = running.simulation.scene().sensors();
        Ok((events, sensors.iter().map(|sensor| sensor.name.clone()).collect()))
    })?;
    let (mut whole, mut real) = (Vec::new(), Vec::new());
    for event in events {
        whole.extend([event.step as i64, i64::from(event.change != SensorChange::Enter), event.sensor as i64]);
        whole.extend(numbers(&event.object));
        let DVec3 { x, y, z } = event.centre;
        real.extend([event.time, x, y, z]);
    }
    Ok((matrix(py, whole, 5)?, matrix(py, real, 4)?, names))
}

/// The kind of an object, by its position in the list of kinds of the Python layer, and its index.
fn numbers(party: &Party) -> [i64; 2] {
    let kind = match party.id {
        ObjectId::Sphere(_) => 0,
        ObjectId::Rod(_) => 1,
        ObjectId::Capsule(_) => 2,
        ObjectId::Body(_) => 3,
        ObjectId::Box(_) => 4,
        _ => 5,
    };
    [kind, party.index as i64]
}
