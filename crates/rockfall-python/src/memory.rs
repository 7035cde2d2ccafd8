//! Views of the memory of the CPU backend, without copies.
//!
//! The arrays that Python gets are read-only, and each keeps a [`Kept`] alive. Before the simulation changes this memory, moves it
//! or is dropped while such an array exists, it copies the state to new memory and gives the old memory to the [`Kept`]
//! ([`Lender::release`]). So an array always shows the state of the moment that it was taken, at the same address, and nothing
//! writes to it.

use std::sync::{Arc, Mutex, PoisonError, Weak};

use numpy::ndarray::ArrayView2;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use rockfall::glam::Vec4;

/// Memory that arrays use and the simulation does not use any more. `None` while the simulation still uses it.
#[derive(Debug, Default)]
pub(crate) struct Kept(Mutex<Option<[Vec<Vec4>; 2]>>);

/// The owner of arrays, as NumPy sees it.
#[pyclass(frozen, module = "rockfall._rockfall")]
struct StateMemory {
    _kept: Arc<Kept>,
}

/// The simulation's knowledge of arrays that use its memory.
#[derive(Debug, Default)]
pub(crate) struct Lender(Weak<Kept>);

impl Lender {
    /// Leaves the memory to the arrays that use it, if there are any. Called before the memory changes.
    pub(crate) fn release(&mut self, simulation: &mut rockfall::Simulation) {
        if let Some(kept) = std::mem::take(&mut self.0).upgrade() {
            *kept.0.lock().unwrap_or_else(PoisonError::into_inner) = simulation.replace_cpu_state();
        }
    }

    /// The memory of a simulation without pending edits; `None` on the GPU backend.
    pub(crate) fn lend(&mut self, simulation: &rockfall::Simulation) -> Option<Loan> {
        let world = simulation.cpu_view()?;
        let kept = self.0.upgrade().unwrap_or_default();
        self.0 = Arc::downgrade(&kept);
        let spheres = world.orientations.len();
        let place = |array: &Vec<Vec4>| (array.as_ptr() as usize, array.len());
        let order = (0..spheres).map(|slot| world.insertion_index(slot) as i64).collect();
        Some(Loan { kept, state: place(&world.states[0]), orientations: place(&world.orientations), order })
    }
}

/// Addresses and lengths of memory that stays valid as long as `kept` exists.
pub(crate) struct Loan {
    kept: Arc<Kept>,
    state: (usize, usize),
    orientations: (usize, usize),
    order: Vec<i64>,
}

/// The rows of the state (positions and radii, velocities and inverse masses, angular momenta and inverse inertias, one after
/// the other), the orientations x, y, z, w, and the index in order of addition of each slot.
pub(crate) type Views<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<i64>>);

impl Loan {
    /// Makes the arrays.
    pub(crate) fn views(self, py: Python<'_>) -> PyResult<Views<'_>> {
        let owner = Bound::new(py, StateMemory { _kept: self.kept })?.into_any();
        let [state, orientations] = [self.state, self.orientations].map(|place| view(&owner, place));
        Ok((state, orientations, PyArray1::from_vec(py, self.order)))
    }
}

/// A read-only array of the vectors at an address, which `owner` keeps alive.
#[allow(unsafe_code)]
fn view<'py>(owner: &Bound<'py, PyAny>, (address, length): (usize, usize)) -> Bound<'py, PyArray2<f32>> {
    // SAFETY: the address is that of the elements of a `Vec<Vec4>` of this length, and a `Vec4` is four consecutive f32. The
    // owner holds a `Kept`. While it exists, the simulation neither writes to nor frees this memory: `Lender::release` moves the
    // vector into the `Kept` before. The array is made read-only, so that Python does not write to it either.
    let array = unsafe {
        let rows = ArrayView2::from_shape_ptr((length, 4), address as *const f32);
        PyArray2::borrow_from_array(&rows, owner.clone())
    };
    drop(array.readwrite().make_nonwriteable());
    array
}
