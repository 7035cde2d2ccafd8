//! Fields of spheres as tables, in order of addition.

use std::str::FromStr;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::{Result, Scene, Simulation, Sphere, SphereId, SphereState};

use crate::arguments::{quaternion, vector};

/// A field of spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Field {
    Position,
    Velocity,
    Orientation,
    AngularMomentum,
    Force,
    Radius,
    Mass,
    Fixed,
    Impulse,
}

impl FromStr for Field {
    type Err = PyErr;

    fn from_str(name: &str) -> PyResult<Self> {
        Ok(match name {
            "position" => Self::Position,
            "velocity" => Self::Velocity,
            "orientation" => Self::Orientation,
            "angular_momentum" => Self::AngularMomentum,
            "force" => Self::Force,
            "radius" => Self::Radius,
            "mass" => Self::Mass,
            "fixed" => Self::Fixed,
            "impulse" => Self::Impulse,
            _ => return Err(PyValueError::new_err(format!("field: {name} is not a field of a sphere"))),
        })
    }
}

impl Field {
    /// Numbers per sphere.
    pub(crate) fn columns(self) -> usize {
        match self {
            Self::Orientation => 4,
            Self::Radius | Self::Mass | Self::Fixed => 1,
            _ => 3,
        }
    }

    /// Whether a sphere's state has the field.
    pub(crate) fn is_state(self) -> bool {
        matches!(self, Self::Position | Self::Velocity | Self::Orientation | Self::AngularMomentum)
    }

    /// Appends the field of a sphere to a table.
    pub(crate) fn append(self, sphere: &Sphere, to: &mut Vec<f32>) {
        match self {
            Self::Force | Self::Impulse => to.extend(sphere.force.to_array()),
            Self::Radius => to.push(sphere.radius),
            Self::Mass => to.push(sphere.mass),
            Self::Fixed => to.push(f32::from(u8::from(sphere.fixed))),
            _ => self.append_state(&SphereState::from(sphere), to),
        }
    }

    /// Appends the field of a sphere's state to a table. Other fields than those of a state have no numbers.
    pub(crate) fn append_state(self, state: &SphereState, to: &mut Vec<f32>) {
        let q = state.orientation;
        match self {
            Self::Position => to.extend(state.position.to_array()),
            Self::Velocity => to.extend(state.velocity.to_array()),
            Self::Orientation => to.extend([q.w, q.x, q.y, q.z]),
            Self::AngularMomentum => to.extend(state.angular_momentum.to_array()),
            Self::Force | Self::Impulse | Self::Radius | Self::Mass | Self::Fixed => {}
        }
    }

    /// Sets the field of a sphere from a row. Fields that cannot be set stay as they are.
    pub(crate) fn set(self, simulation: &mut Simulation, id: SphereId, rows: &[f32], row: usize) -> Result<()> {
        match self {
            Self::Position => simulation.set_position(id, vector(rows, row)),
            Self::Velocity => simulation.set_velocity(id, vector(rows, row)),
            Self::Orientation => simulation.set_orientation(id, quaternion(rows, row)),
            Self::AngularMomentum => simulation.set_angular_momentum(id, vector(rows, row)),
            Self::Force => simulation.set_force(id, vector(rows, row)),
            Self::Impulse => simulation.apply_impulse(id, vector(rows, row)),
            Self::Radius | Self::Mass | Self::Fixed => Ok(()),
        }
    }
}

/// A field of all spheres.
#[derive(Debug)]
pub(crate) struct Table {
    field: Field,
    numbers: Vec<f32>,
}

impl Table {
    pub(crate) fn of(scene: &Scene, field: Field) -> Self {
        let mut numbers = Vec::with_capacity(field.columns() * scene.spheres().len());
        scene.spheres().iter().for_each(|sphere| field.append(sphere, &mut numbers));
        Self { field, numbers }
    }

    /// Makes an array of shape (N,) or (N, columns), which takes over the memory.
    pub(crate) fn array(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let columns = self.field.columns();
        let rows = self.numbers.len() / columns;
        let array = PyArray1::from_vec(py, self.numbers);
        if columns == 1 { Ok(array.into_any()) } else { Ok(array.reshape([rows, columns])?.into_any()) }
    }

    /// The rows in which `rows` differs, after a check that it has the same shape.
    pub(crate) fn differences(&self, rows: &[f32]) -> PyResult<Vec<usize>> {
        if rows.len() != self.numbers.len() {
            let columns = self.field.columns();
            let text = format!("expected {} rows, got {}", self.numbers.len() / columns, rows.len() / columns);
            return Err(PyValueError::new_err(text));
        }
        let bits = |row: &[f32], old: &[f32]| row.iter().zip(old).any(|(a, b)| a.to_bits() != b.to_bits());
        let columns = self.field.columns();
        let both = rows.chunks_exact(columns).zip(self.numbers.chunks_exact(columns));
        Ok(both.enumerate().filter(|(_, (row, old))| bits(row, old)).map(|(index, _)| index).collect())
    }
}
