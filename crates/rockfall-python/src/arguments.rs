//! Arrays that the Python layer passes: contiguous, and of the right type.

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::glam::{Quat, Vec3};

pub(crate) type Floats<'py> = PyReadonlyArray1<'py, f32>;
pub(crate) type Rows<'py> = PyReadonlyArray2<'py, f32>;
pub(crate) type Numbers<'py> = PyReadonlyArray1<'py, i64>;
pub(crate) type Groups<'py> = PyReadonlyArray1<'py, u16>;
pub(crate) type Switches<'py> = PyReadonlyArray1<'py, bool>;

/// Row `k` of an array of vectors.
pub(crate) fn vector(rows: &[f32], k: usize) -> Vec3 {
    Vec3::new(rows[3 * k], rows[3 * k + 1], rows[3 * k + 2])
}

/// Row `k` of an array of quaternions w, x, y, z.
pub(crate) fn quaternion(rows: &[f32], k: usize) -> Quat {
    Quat::from_xyzw(rows[4 * k + 1], rows[4 * k + 2], rows[4 * k + 3], rows[4 * k])
}

/// Checks that every array has `count` rows, so that no index below is out of range.
pub(crate) fn check(count: usize, lengths: &[usize]) -> PyResult<()> {
    match lengths.iter().find(|length| **length != count) {
        Some(length) => Err(PyValueError::new_err(format!("expected {count} rows in every array, got {length}"))),
        None => Ok(()),
    }
}
