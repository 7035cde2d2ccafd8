//! Arrays that the Python layer passes: contiguous, and of the right type. Laws.

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::glam::{Quat, Vec3};
use rockfall::{ContactForceLaw, ForceLaw};

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

/// A law: its name, the WGSL text, and names and values of its parameters.
pub(crate) type Law = (String, String, Vec<(String, f32)>);

/// The law of the library.
pub(crate) fn law((name, wgsl, parameters): Law) -> ForceLaw {
    parameters.into_iter().fold(ForceLaw::new(name).wgsl(wgsl), |law, (name, value)| law.parameter(name, value))
}

/// A contact law: its name, the WGSL text, names and values of its parameters; the materials, name and value of parameters of pairs.
pub(crate) type ContactLaw = (String, String, Vec<(String, f32)>, Vec<(String, String, String, f32)>);

/// The contact law of the library.
pub(crate) fn contact_law((name, wgsl, parameters, pairs): ContactLaw) -> ContactForceLaw {
    let law = ContactForceLaw::new(name).wgsl(wgsl);
    let law = parameters.into_iter().fold(law, |law, (name, value)| law.parameter(name, value));
    pairs.into_iter().fold(law, |law, (one, other, name, value)| law.pair_parameter([&one, &other], name, value))
}
