//! Arrays on the device that PyTorch, CuPy and others use without a copy through the host, by DLPack.

use std::sync::Arc;

use cudarc::driver::CudaContext;
use dlpark::ffi::{DLDataType, DLDevice, DLManagedTensor, DLManagedTensorVersioned};
use dlpark::metadata::Fixed;
use dlpark::python::consumer::{DlpackStream, ImportRequest, StreamArg, stream};
use dlpark::python::{DlpackExporter, ExportRequest, export_dlpack};
use dlpark::{DlpackElement, DlpackFlags, Managed, ManagedTensorBase};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyBufferError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use rockfall::gpu::Table;
use rockfall::wgpu;

use crate::errors::{Raise, SimulationError};
use crate::fork::{Owned, detached};
use crate::states::Field;

mod memory;

use memory::{Memory, Reason, cuda_device_of};

/// The table on the device that holds a field.
fn table_of(field: Field) -> Option<Table> {
    Some(match field {
        Field::Position => Table::Positions,
        Field::Velocity => Table::Velocities,
        Field::Orientation => Table::Orientations,
        Field::AngularMomentum => Table::AngularMomenta,
        Field::Force => Table::Forces,
        _ => return None,
    })
}

fn failed(reason: Reason) -> PyErr {
    SimulationError::new_err(format!("memory of the GPU could not be shared: {reason}"))
}

/// The memory that a simulation shares with CUDA. Memory is used again when nobody else uses it any more.
#[derive(Debug)]
pub(crate) struct Sharing {
    device: wgpu::Device,
    cuda: Arc<CudaContext>,
    pool: Vec<Arc<Memory>>,
}

impl Sharing {
    /// Finds the CUDA side of a simulation's device. The error says why there is none.
    pub(crate) fn open(simulation: &rockfall::Simulation) -> Result<Self, Reason> {
        let world = simulation.gpu_view().ok_or("the simulation runs on the CPU")?;
        let device = world.gpu().device().clone();
        let cuda = cuda_device_of(&device)?;
        Ok(Self { device, cuda, pool: Vec::new() })
    }

    /// Memory that nobody else uses, of at least this size.
    fn memory(&mut self, bytes: u64) -> Result<Arc<Memory>, Reason> {
        let bytes = bytes.max(16);
        self.pool.retain(|memory| Arc::strong_count(memory) > 1 || memory.buffer.size() == bytes);
        if let Some(free) = self.pool.iter().find(|memory| Arc::strong_count(memory) == 1 && memory.buffer.size() == bytes) {
            // An array is released when the last reference is gone, but work on the device that reads it may still be waiting.
            free.wait_for_cuda()?;
            return Ok(Arc::clone(free));
        }
        let made = Arc::new(Memory::new(&self.device, &self.cuda, bytes)?);
        self.pool.push(Arc::clone(&made));
        Ok(made)
    }

    fn wait_for_vulkan(&self, submission: wgpu::SubmissionIndex) -> PyResult<()> {
        let until = wgpu::PollType::Wait { submission_index: Some(submission), timeout: None };
        let done = self.device.poll(until);
        done.map(drop).map_err(|error| SimulationError::new_err(format!("waiting for the device failed: {error}")))
    }

    /// The device, as DLPack names it.
    pub(crate) fn device(&self) -> (u32, i32) {
        number(device_of(&self.cuda))
    }

    /// Copies a field to shared memory, and waits for the copy. `None` for fields that the device has no table of.
    pub(crate) fn read(&mut self, simulation: &mut rockfall::Simulation, field: Field) -> PyResult<Option<SharedArray>> {
        let Some(table) = table_of(field).filter(|table| *table != Table::Forces) else { return Ok(None) };
        self.read_table(simulation, table).map(Some)
    }

    /// The same for a field of all rigid bodies.
    pub(crate) fn read_bodies(&mut self, simulation: &mut rockfall::Simulation, field: Field) -> PyResult<Option<SharedArray>> {
        let table = match field {
            Field::Position => Table::BodyPositions,
            Field::Velocity => Table::BodyVelocities,
            Field::AngularMomentum => Table::BodyAngularMomenta,
            Field::Orientation => Table::BodyOrientations,
            _ => return Ok(None),
        };
        self.read_table(simulation, table).map(Some)
    }

    fn read_table(&mut self, simulation: &mut rockfall::Simulation, table: Table) -> PyResult<SharedArray> {
        let scene = simulation.scene();
        let rows = if table.is_of_bodies() { scene.bodies().len() } else { scene.spheres().len() };
        let memory = self.memory(table.bytes(rows)).map_err(failed)?;
        let submission = simulation.read_table(table, &memory.buffer).or_raise()?;
        self.wait_for_vulkan(submission)?;
        Ok(SharedArray { memory: Owned::new(memory), rows, columns: table.columns() as usize })
    }

    /// Sets a field from an array on the device, and waits for the copy.
    pub(crate) fn write(&mut self, simulation: &mut rockfall::Simulation, field: Field, given: &Given) -> PyResult<()> {
        let Some(table) = table_of(field) else {
            return Err(PyValueError::new_err("the field cannot be set from an array on the device"));
        };
        let rows = simulation.scene().spheres().len();
        let expected = [rows as i64, i64::from(table.columns())];
        if given.shape != expected {
            return Err(PyValueError::new_err(format!("expected shape {expected:?}, got {:?}", given.shape)));
        }
        let bytes = table.bytes(rows);
        let memory = self.memory(bytes).map_err(failed)?;
        // SAFETY: `Given` was made from a tensor of this shape on this device, whose owner it keeps.
        #[allow(unsafe_code)]
        unsafe { memory.copy_from(given.address, bytes as usize) }.map_err(failed)?;
        let submission = simulation.write_table(table, &memory.buffer).or_raise()?;
        self.wait_for_vulkan(submission)
    }
}

fn name_of(kind: DLDataType) -> String {
    let name = match kind.code.0 {
        0 => "int",
        1 => "uint",
        2 => "float",
        4 => "bfloat",
        5 => "complex",
        6 => "bool",
        _ => "another type of ",
    };
    format!("{name}{}", kind.bits)
}

fn device_of(cuda: &CudaContext) -> DLDevice {
    DLDevice::cuda(i32::try_from(cuda.ordinal()).unwrap_or(i32::MAX))
}

fn number(device: DLDevice) -> (u32, i32) {
    (device.device_type.0, device.device_id)
}

/// CUDA's legacy default stream, on which `Memory::copy_from` runs.
struct DefaultStream;

// SAFETY: this stream exists on every CUDA device, for ever.
#[allow(unsafe_code)]
unsafe impl DlpackStream for DefaultStream {
    fn as_python_arg(&self, _py: Python<'_>, _device: DLDevice) -> PyResult<StreamArg> {
        Ok(stream::cuda(std::ptr::null_mut()))
    }
}

/// A contiguous array of f32 on the device that belongs to another library.
pub(crate) struct Given {
    address: u64,
    shape: Vec<i64>,
    _owner: dlpark::AllocationDeleter,
}

impl Given {
    /// Takes an array on a device from another library. `None` for arrays elsewhere.
    pub(crate) fn take(array: &Bound<'_, PyAny>, device: (u32, i32)) -> PyResult<Option<Self>> {
        let request = ImportRequest::new(array.as_borrowed())?;
        if number(request.device()?) != device {
            return Ok(None);
        }
        let tensor = request.import(Some(&DefaultStream), None)?;
        let view = tensor.validate().map_err(|error| PyBufferError::new_err(error.to_string()))?;
        if view.dtype() != f32::DTYPE {
            return Err(PyTypeError::new_err(format!("expected float32 on the device, got {}", name_of(view.dtype()))));
        }
        if !view.is_compact().unwrap_or(false) {
            return Err(PyValueError::new_err("expected a contiguous array on the device; call contiguous() first"));
        }
        let address = view.data_ptr() as u64 + view.byte_offset();
        let shape = view.shape().to_vec();
        Ok(Some(Self { address, shape, _owner: tensor.into_deleter() }))
    }
}

/// A field of all spheres in memory of the device that CUDA addresses, too. It does not change with the simulation.
#[pyclass(frozen, module = "rockfall._rockfall")]
#[derive(Debug)]
pub(crate) struct SharedArray {
    memory: Owned<Arc<Memory>>,
    rows: usize,
    columns: usize,
}

impl SharedArray {
    fn tensor<M: ManagedTensorBase>(&self) -> PyResult<Managed<M>> {
        self.memory.check(true)?;
        let (rows, columns) = (self.rows as i64, self.columns as i64);
        let prepared = Fixed::new([rows, columns], [columns, 1]).prepare_as::<M>();
        let prepared = prepared.map_err(|error| PyBufferError::new_err(error.to_string()))?;
        let mut made = prepared.initialize(Arc::clone(&*self.memory));
        made.set_device(self.device());
        made.set_dtype(f32::DTYPE);
        made.set_data(self.memory.address() as *mut _);
        // SAFETY: the owner holds memory for these rows without gaps, at this address of this device.
        #[allow(unsafe_code)]
        Ok(unsafe { made.finish() })
    }
}

impl DlpackExporter for SharedArray {
    fn device(&self) -> DLDevice {
        device_of(self.memory.cuda())
    }

    fn flags(&self) -> DlpackFlags {
        DlpackFlags::empty()
    }

    fn prepare_export(&self, _py: Python<'_>, request: &ExportRequest<'_>) -> PyResult<()> {
        // The copy to this memory was waited for, so it is ready on every stream.
        request.cuda_stream().map(drop)
    }

    fn export_legacy(&self, _py: Python<'_>) -> PyResult<Managed<DLManagedTensor>> {
        self.tensor()
    }

    fn export_versioned(&self, _py: Python<'_>) -> PyResult<Managed<DLManagedTensorVersioned>> {
        self.tensor()
    }
}

#[pymethods]
impl SharedArray {
    #[pyo3(signature = (*, stream=None, max_version=None, dl_device=None, copy=None))]
    fn __dlpack__<'py>(
        &self,
        py: Python<'py>,
        stream: Option<&Bound<'py, PyAny>>,
        max_version: Option<(u32, u32)>,
        dl_device: Option<(u32, i32)>,
        copy: Option<bool>,
    ) -> PyResult<Py<PyAny>> {
        export_dlpack(self, py, ExportRequest::parse(stream, max_version, dl_device, copy)?)
    }

    fn __dlpack_device__(&self) -> (u32, i32) {
        number(self.device())
    }

    /// A copy on the host, of shape (rows, columns).
    fn host<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.memory.check(true)?;
        let numbers = detached(py, || {
            let mut numbers = vec![0.0; self.rows * self.columns];
            self.memory.download(&mut numbers).map(|()| numbers)
        });
        PyArray1::from_vec(py, numbers.map_err(failed)?).reshape([self.rows, self.columns])
    }

    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.rows, self.columns)
    }
}
