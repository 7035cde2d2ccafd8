//! Which groups of objects touch each other.

use pyo3::prelude::*;

use crate::doors::with;
use crate::errors::Raise;
use crate::scene::Scene;

/// The groups that a group has in its list, `None` without a list.
#[pyfunction]
pub(crate) fn group_meets(target: &Bound<'_, PyAny>, group: u16) -> PyResult<Option<Vec<u16>>> {
    with(target, |doors, _| Ok(doors.objects().group_meets(group)))
}

/// Sets the groups that a group meets.
#[pyfunction]
pub(crate) fn set_group_meets(scene: &Scene, group: u16, meets: Vec<u16>) -> PyResult<()> {
    scene.lock().scene.set_group_meets(group, meets).or_raise()
}
