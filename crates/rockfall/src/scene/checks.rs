//! Checks of the numbers of objects.

use glam::Vec3;

use crate::error::{Error, Result};

pub(crate) fn invalid(field: &'static str, value: impl std::fmt::Debug, expected: &'static str) -> Error {
    Error::Invalid { field, value: format!("{value:?}"), expected }
}

pub(crate) fn finite(field: &'static str, value: Vec3) -> Result<()> {
    if value.is_finite() { Ok(()) } else { Err(invalid(field, value.to_array(), "three finite numbers")) }
}

pub(crate) fn positive(field: &'static str, value: f32) -> Result<()> {
    if value.is_finite() && value > 0.0 { Ok(()) } else { Err(invalid(field, value, "a finite number greater than 0")) }
}

pub(crate) fn not_negative(field: &'static str, value: f32) -> Result<()> {
    if value.is_finite() && value >= 0.0 { Ok(()) } else { Err(invalid(field, value, "a finite number, not negative")) }
}
