//! The interface of `shared.rs` on systems on which memory of the GPU is not shared.

use pyo3::prelude::*;

use crate::states::Field;

/// There is none.
#[derive(Debug)]
pub(crate) enum Sharing {}

/// An array on the device. There is none.
pub(crate) enum Given {}

/// An array on the device. There is none.
#[pyclass(frozen, module = "rockfall._rockfall")]
#[derive(Debug)]
pub(crate) struct SharedArray(());

impl Sharing {
    pub(crate) fn open(_simulation: &rockfall::Simulation) -> Result<Self, String> {
        Err("memory of the GPU is shared on Linux only".to_owned())
    }

    pub(crate) fn device(&self) -> (u32, i32) {
        match *self {}
    }

    pub(crate) fn read(&mut self, _simulation: &mut rockfall::Simulation, _field: Field) -> PyResult<Option<SharedArray>> {
        match *self {}
    }

    pub(crate) fn write(&mut self, _simulation: &mut rockfall::Simulation, _field: Field, given: &Given) -> PyResult<()> {
        match *given {}
    }
}

impl Given {
    pub(crate) fn take(_array: &Bound<'_, PyAny>, _device: (u32, i32)) -> PyResult<Option<Self>> {
        Ok(None)
    }
}
