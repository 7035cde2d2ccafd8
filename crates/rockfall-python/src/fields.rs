//! Coarse-grained fields.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rockfall_trajectory::fields::{Kernel, Smoothing, Sources};

use crate::errors::Raise;
use crate::fork::detached;
use crate::simulation::Simulation;

/// The fields of the current state by name, with `origin` and `spacing` of the grid.
#[pyfunction]
pub(crate) fn fields<'py>(
    simulation: &Bound<'py, Simulation>,
    width: Option<f64>,
    spacing: Option<f64>,
    kernel: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let py = simulation.py();
    let kernel: Kernel = kernel.parse().or_raise()?;
    let sources = simulation.get().read(py, |running| Sources::of(&mut running.simulation).or_raise())?;
    let found = detached(py, || {
        let smoothing = Smoothing::new(kernel, width.unwrap_or(sources.widest())).or_raise()?;
        let grid = sources.grid(smoothing, spacing.unwrap_or(smoothing.width())).or_raise()?;
        PyResult::Ok(sources.fields(grid, smoothing))
    })?;
    let result = PyDict::new(py);
    let [x, y, z] = found.grid.counts;
    for (name, inner, numbers) in found.named() {
        let array: Bound<'py, PyArrayDyn<f64>> = PyArray1::from_vec(py, numbers).reshape([&[z, y, x], inner].concat())?;
        result.set_item(name, array)?;
    }
    result.set_item("origin", PyArray1::from_vec(py, found.grid.origin.to_array().to_vec()))?;
    result.set_item("spacing", found.grid.spacing)?;
    Ok(result)
}
