//! What can be found out about worlds.

use std::collections::HashMap;

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;
use rockfall::{Backend, Result};

use crate::errors::{Raise, in_python};
use crate::fork::{check_graphics, detached};
use crate::ids::Ids;
use crate::observe::{ContactArrays, contact_arrays, contact_rows};
use crate::simulation::Simulation;
use crate::worlds::Worlds;

/// Numbers per world in the table of energies.
const ENERGIES: usize = 10;

/// The warnings of every `stride`-th world.
fn concerns(worlds: &rockfall::Worlds, dt: f32, stride: usize) -> Result<Vec<Vec<String>>> {
    let some: Vec<usize> = (0..worlds.len()).step_by(stride.max(1)).collect();
    some.into_par_iter().map(|world| Ok(worlds.scene(world)?.concerns(dt, worlds.integrator(world)?))).collect()
}

/// Warnings about a time step or constants that do not suit the scenes, each with the worlds that it is about. Only every
/// `stride`-th world is checked.
#[pyfunction]
pub(crate) fn world_concerns(worlds: &Bound<'_, Worlds>, dt: f32, stride: usize) -> PyResult<Vec<(String, Vec<usize>)>> {
    let found = worlds.get().locked(worlds.py(), |worlds| concerns(worlds, dt, stride))?;
    let mut texts: Vec<(String, Vec<usize>)> = Vec::new();
    let mut places: HashMap<String, usize> = HashMap::new();
    for (world, text) in found.iter().enumerate().flat_map(|(world, own)| own.iter().map(move |text| (world, text))) {
        let place = *places.entry(in_python(text)).or_insert_with_key(|text| {
            texts.push((text.clone(), Vec::new()));
            texts.len() - 1
        });
        texts[place].1.push(world * stride);
    }
    Ok(texts)
}

/// The time step of the last run.
#[pyfunction]
pub(crate) fn worlds_time_step(worlds: &Bound<'_, Worlds>) -> PyResult<f32> {
    worlds.get().locked(worlds.py(), |worlds| Ok(worlds.time_step()))
}

/// Sets the time step that observations before the next step assume.
#[pyfunction]
pub(crate) fn set_worlds_time_step(worlds: &Bound<'_, Worlds>, dt: f32) -> PyResult<()> {
    worlds.get().locked(worlds.py(), |worlds| worlds.set_time_step(dt))
}

/// Kinetic energy, potential energy, that of springs and that of contacts, momentum and angular momentum of each world.
#[pyfunction]
pub(crate) fn world_energies<'py>(worlds: &Bound<'py, Worlds>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let found = worlds.get().locked(worlds.py(), rockfall::Worlds::energies)?;
    let mut numbers = Vec::with_capacity(ENERGIES * found.len());
    for energy in &found {
        numbers.extend([energy.kinetic, energy.potential, energy.spring, energy.contact]);
        [energy.momentum, energy.angular_momentum].iter().for_each(|vector| numbers.extend(vector.to_array()));
    }
    PyArray1::from_vec(worlds.py(), numbers).reshape([found.len(), ENERGIES])
}

/// The contacts of a world, as those of a simulation.
#[pyfunction]
pub(crate) fn world_contacts<'py>(worlds: &Bound<'py, Worlds>, world: usize) -> PyResult<ContactArrays<'py>> {
    let (whole, real) =
        worlds.get().locked(worlds.py(), |worlds| contact_rows(worlds.contacts(world)?, worlds.scene(world)?))?;
    contact_arrays(worlds.py(), whole, real)
}

/// A simulation that goes on where a world is, on the backend of the worlds or on another one.
#[pyfunction]
pub(crate) fn world_simulation(worlds: &Bound<'_, Worlds>, world: usize, backend: Option<&str>) -> PyResult<Simulation> {
    let backend = backend.map(str::parse::<Backend>).transpose().or_raise()?;
    let mut checkpoint = worlds.get().locked(worlds.py(), |worlds| worlds.checkpoint(world))?;
    checkpoint.options.backend = backend.unwrap_or(checkpoint.options.backend);
    if checkpoint.options.backend != Backend::Cpu {
        check_graphics()?;
    }
    detached(worlds.py(), || {
        let simulation = rockfall::Simulation::resume(checkpoint).or_raise()?;
        let ids = Ids::of(simulation.scene());
        Ok(Simulation::of(simulation, ids))
    })
}
