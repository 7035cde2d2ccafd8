//! Gauges: loads on walls, and the flow through planes.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use rockfall::glam::DVec3;
use rockfall::{Gauge, GaugeReading};

use crate::doors::with;
use crate::errors::Raise;
use crate::simulation::Simulation;

/// Force, torque and number of contacts of a wall, or mass and number of what has passed a plane.
type Reading = (Option<([f64; 3], [f64; 3], u64)>, Option<(f64, i64)>);

/// Adds a gauge of a wall, or of a plane with a point and a normal.
#[pyfunction]
#[pyo3(signature = (target, name, wall, plane))]
pub(crate) fn add_gauge(target: &Bound<'_, PyAny>, name: &str, wall: Option<&str>, plane: [f64; 6]) -> PyResult<()> {
    let gauge = match wall {
        Some(wall) => Gauge::wall(name, wall),
        None => Gauge::plane(name, DVec3::from_slice(&plane), DVec3::from_slice(&plane[3..])),
    };
    with(target, |doors, _| doors.add_gauge(gauge).or_raise())
}

/// The name and the reading of every gauge.
#[pyfunction]
pub(crate) fn gauges(target: &Bound<'_, PyAny>) -> PyResult<Vec<(String, Reading)>> {
    let simulation = target.cast::<Simulation>().map_err(|_| PyTypeError::new_err("target: expected a Simulation"))?;
    simulation.get().read(target.py(), |running| {
        let readings = running.simulation.gauges().or_raise()?;
        let row = |(gauge, reading): (&Gauge, GaugeReading)| match reading {
            GaugeReading::Wall(load) => {
                let load = (load.force.to_array(), load.torque.to_array(), load.contacts);
                (gauge.name.clone(), (Some(load), None))
            }
            GaugeReading::Plane { mass, count } => (gauge.name.clone(), (None, Some((mass, count)))),
            _ => (gauge.name.clone(), (None, None)),
        };
        Ok(running.simulation.scene().gauges().iter().zip(readings).map(row).collect())
    })
}
