//! Trajectories: files with the states over time.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::glam::Vec3;
use rockfall_trajectory::{Format, Reader, States, Writer};

use crate::errors::Raise;
use crate::fork::{Owned, detached};
use crate::scene::Scene;
use crate::simulation::Simulation;

use numpy::{PyArray1, PyArray2, PyArrayMethods};

/// A trajectory that is being written. `None` once it is finished.
#[pyclass(frozen, module = "rockfall._rockfall")]
pub(crate) struct TrajectoryWriter(Mutex<Option<Owned<Writer>>>);

fn finished() -> PyErr {
    PyValueError::new_err("the recording is finished")
}

#[pymethods]
impl TrajectoryWriter {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let Some(format) = Format::of(&path) else {
            let text =
                format!("path: {} is not a trajectory, expected a name that ends in .npz, .pvd, .vtp or .csv", path.display());
            return Err(PyValueError::new_err(text));
        };
        detached(py, || Ok(Self(Mutex::new(Some(Owned::new(Writer::create(path, format).or_raise()?))))))
    }

    fn frame(&self, simulation: &Bound<'_, Simulation>) -> PyResult<()> {
        simulation.get().read(simulation.py(), |running| {
            let mut writer = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let writer = writer.as_mut().ok_or_else(finished)?;
            // The file belongs to the process that began it.
            if writer.is_inherited() { Ok(()) } else { writer.frame(&mut running.simulation).or_raise() }
        })
    }

    fn finish(&self, simulation: &Bound<'_, Simulation>) -> PyResult<()> {
        simulation.get().flushed(simulation.py(), |running| {
            let writer = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
            match writer.ok_or_else(finished)?.into_own() {
                Some(writer) => writer.finish(running.simulation.scene()).or_raise(),
                None => Ok(()),
            }
        })
    }
}

/// A trajectory that is read from a file.
#[pyclass(frozen, module = "rockfall._rockfall")]
pub(crate) struct TrajectoryReader(Mutex<Reader>);

/// Moves states towards later ones by a part of the way. Spheres that are not there later stay.
fn mix(states: &mut States, after: &States, part: f32) {
    let places: HashMap<u32, usize> = after.ids.iter().copied().zip(0..).collect();
    for (now, id) in states.ids.iter().enumerate() {
        let Some(&then) = places.get(id) else { continue };
        let pair = |now: &mut Vec3, then: Vec3| *now = now.lerp(then, part);
        pair(&mut states.positions[now], after.positions[then]);
        pair(&mut states.velocities[now], after.velocities[then]);
        pair(&mut states.angular_momenta[now], after.angular_momenta[then]);
        states.orientations[now] = states.orientations[now].lerp(after.orientations[then], part);
    }
}

type Rows<'py> = Bound<'py, PyArray2<f32>>;
type Frame<'py> = (Rows<'py>, Rows<'py>, Rows<'py>, Rows<'py>, Bound<'py, PyArray1<i64>>);

#[pymethods]
impl TrajectoryReader {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        detached(py, || Ok(Self(Mutex::new(Reader::open(path).or_raise()?))))
    }

    fn scene(&self, py: Python<'_>) -> Scene {
        detached(py, || Scene::of(self.0.lock().unwrap_or_else(PoisonError::into_inner).scene().clone()))
    }

    /// Step and time of every frame.
    fn moments(&self, py: Python<'_>) -> Vec<(u64, f64)> {
        detached(py, || {
            let reader = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            reader.moments().iter().map(|moment| (moment.step, moment.time)).collect()
        })
    }

    /// Gives the state between two frames to a simulation of the scene, with its step and time.
    fn show(&self, simulation: &Bound<'_, Simulation>, frame: usize, next: usize, blend: f32) -> PyResult<()> {
        simulation.get().change(simulation.py(), |simulation| {
            let mut reader = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let mut states = reader.frame(frame).or_raise()?;
            let [from, to] = [frame, next].map(|place| reader.moments()[place]);
            if blend > 0.0 {
                mix(&mut states, &reader.frame(next).or_raise()?, blend);
            }
            reader.apply(&states, simulation).or_raise()?;
            let mut state = simulation.checkpoint().or_raise()?;
            state.report.time = from.time + f64::from(blend) * (to.time - from.time);
            state.report.steps = from.step;
            simulation.restore(&state).or_raise()
        })
    }

    fn is_constant(&self, py: Python<'_>) -> bool {
        detached(py, || self.0.lock().unwrap_or_else(PoisonError::into_inner).is_constant())
    }

    /// Radii of all spheres, by their numbers.
    fn radii<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let radii: rockfall::Result<Vec<f32>> = detached(py, || {
            let reader = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            reader.spheres().into_iter().map(|sphere| Ok(reader.scene().sphere(sphere)?.radius)).collect()
        });
        Ok(PyArray1::from_vec(py, radii.or_raise()?))
    }

    /// Positions, velocities, orientations w, x, y, z, angular momenta, and numbers of the spheres.
    fn frame<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Frame<'py>> {
        let states = detached(py, || self.0.lock().unwrap_or_else(PoisonError::into_inner).frame(index)).or_raise()?;
        let States { ids, positions, velocities, orientations, angular_momenta } = states;
        let ids = PyArray1::from_vec(py, ids.into_iter().map(i64::from).collect());
        let rows = |numbers: Vec<f32>, columns: usize| {
            let count = numbers.len() / columns;
            PyArray1::from_vec(py, numbers).reshape([count, columns])
        };
        let vectors = |vectors: Vec<Vec3>| rows(vectors.iter().flat_map(|v| v.to_array()).collect(), 3);
        let turns = orientations.iter().flat_map(|q| [q.w, q.x, q.y, q.z]).collect();
        Ok((vectors(positions)?, vectors(velocities)?, rows(turns, 4)?, vectors(angular_momenta)?, ids))
    }
}
