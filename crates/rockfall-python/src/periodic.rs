//! Periodic boundaries.

use pyo3::prelude::*;

use crate::doors::with;
use crate::errors::Raise;
use crate::scene::Scene;

/// Bounds of the box along x, y and z, `None` where the scene is not periodic.
#[pyfunction]
pub(crate) fn periodic(target: &Bound<'_, PyAny>) -> PyResult<[Option<[f32; 2]>; 3]> {
    with(target, |doors, _| Ok(doors.objects().periodic()))
}

/// Makes a scene periodic along an axis.
#[pyfunction]
pub(crate) fn set_periodic(scene: &Scene, axis: usize, bounds: Option<[f32; 2]>) -> PyResult<()> {
    scene.lock().scene.set_periodic(axis, bounds).or_raise()
}
