//! Periodic boundaries.

use pyo3::prelude::*;
use rockfall::Shear;

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

/// The shear of a scene or simulation: the axes of gradient and flow, the rate in 1/s, and the displacement of the box above at present, in
/// periods.
#[pyfunction]
pub(crate) fn shear(target: &Bound<'_, PyAny>) -> PyResult<Option<(usize, usize, f32, f64)>> {
    with(target, |doors, _| {
        let shear = doors.objects().shear();
        Ok(shear.map(|shear| (shear.gradient, shear.flow, shear.rate, shear.turns())))
    })
}

/// Shears a scene, or no longer.
#[pyfunction]
pub(crate) fn set_shear(scene: &Scene, shear: Option<(usize, usize, f32)>) -> PyResult<()> {
    let shear = shear.map(|(gradient, flow, rate)| Shear::new(gradient, flow, rate));
    scene.lock().scene.set_shear(shear).or_raise()
}
