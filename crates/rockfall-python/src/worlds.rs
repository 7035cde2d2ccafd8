//! The native worlds: many small scenes side by side.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use numpy::{PyArray1, PyArray3, PyArray4, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;
use rockfall::glam::Vec3;
use rockfall::{Backend, Result, SphereState};

use crate::arguments::{Floats, Numbers, quaternion, vector};
use crate::errors::Raise;
use crate::fork::{Owned, check_graphics, detached, graphics_opened};
use crate::portions::in_portions;
use crate::scene::Scene;
use crate::simulation::{Methods, options};
use crate::states::Field;
use crate::tables::{BackendInfo, Report};

pub(crate) mod mechanisms;
pub(crate) mod observe;

/// Worlds, as arrays with room for the largest of them: a row of numbers per world.
#[pyclass(frozen, module = "rockfall._rockfall")]
#[derive(Debug)]
pub(crate) struct Worlds(Mutex<Owned<rockfall::Worlds>>);

/// A report, whether a workgroup runs the world, the sphere that has escaped, why the world is stopped, and whether it sleeps.
type WorldReport = (Report, bool, Option<usize>, Option<String>, bool);

impl Worlds {
    /// Calls a function without the GIL, while no other thread uses the worlds.
    pub(crate) fn locked<R: Send>(
        &self,
        py: Python<'_>,
        call: impl FnOnce(&mut rockfall::Worlds) -> Result<R> + Send,
    ) -> PyResult<R> {
        detached(py, || {
            let mut worlds = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            worlds.check(worlds.backend().kind == Backend::Gpu)?;
            call(&mut worlds).or_raise()
        })
    }

    fn of(worlds: rockfall::Worlds) -> Self {
        if worlds.backend().kind == Backend::Gpu {
            graphics_opened();
        }
        Self(Mutex::new(Owned::new(worlds)))
    }
}

/// Worlds by number. The Python layer has checked that the numbers are not negative.
fn places(numbers: &[i64]) -> impl Iterator<Item = usize> {
    numbers.iter().map(|number| *number as usize)
}

/// Whether these are all worlds, in order.
fn are_all(numbers: &[i64], worlds: usize) -> bool {
    numbers.len() == worlds && places(numbers).eq(0..worlds)
}

/// The numbers of each world in an array that has `room` of them per world.
fn rows(values: &[f32], worlds: usize, room: usize) -> PyResult<impl Iterator<Item = &[f32]>> {
    if values.len() != worlds * room {
        return Err(PyValueError::new_err(format!("expected {} numbers, got {}", worlds * room, values.len())));
    }
    Ok((0..worlds).map(move |row| &values[row * room..(row + 1) * room]))
}

/// Largest number of spheres and of springs in a world.
fn room(worlds: &rockfall::Worlds) -> Result<[usize; 2]> {
    (0..worlds.len()).try_fold([0, 0], |[spheres, springs], world| {
        let scene = worlds.scene(world)?;
        Ok([spheres.max(scene.spheres().len()), springs.max(scene.springs().len())])
    })
}

#[pymethods]
impl Worlds {
    /// A world per scene, or `count` worlds with the one scene.
    #[new]
    fn new(py: Python<'_>, scenes: Vec<Py<Scene>>, count: Option<usize>, methods: Methods) -> PyResult<Self> {
        let options = options(methods)?;
        detached(py, || {
            let scenes: Vec<_> = scenes.iter().map(|scene| scene.get().lock().scene.clone()).collect();
            let built = match count {
                Some(count) => rockfall::Worlds::new(scenes.iter().cycle().take(count).cloned(), options),
                None => rockfall::Worlds::new(scenes, options),
            };
            Ok(Self::of(built.or_raise()?))
        })
    }

    #[staticmethod]
    fn resume(py: Python<'_>, path: PathBuf, backend: Option<&str>) -> PyResult<Self> {
        let backend = backend.map(str::parse).transpose().or_raise()?;
        if backend != Some(Backend::Cpu) {
            check_graphics()?;
        }
        detached(py, || Ok(Self::of(rockfall::Worlds::resume(path, backend).or_raise()?)))
    }

    /// Continues from what [`Worlds::to_bytes`] returned.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        detached(py, || Ok(Self::of(rockfall::Worlds::from_bytes(bytes, "pickle", None).or_raise()?)))
    }

    /// The bytes of a checkpoint.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.locked(py, rockfall::Worlds::to_bytes)?))
    }

    fn save_checkpoint(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.locked(py, |worlds| worlds.save_checkpoint(path))
    }

    fn len(&self, py: Python<'_>) -> PyResult<usize> {
        self.locked(py, |worlds| Ok(worlds.len()))
    }

    /// Number of spheres, springs, joints and rigid bodies of each world.
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray1<i64>>; 4]> {
        let counts = self.locked(py, |worlds| {
            let mut counts = [const { Vec::new() }; 4];
            for world in 0..worlds.len() {
                let scene = worlds.scene(world)?;
                let own = [scene.spheres().len(), scene.springs().len(), scene.joints().len(), scene.bodies().len()];
                counts.iter_mut().zip(own).for_each(|(all, own)| all.push(own as i64));
            }
            Ok(counts)
        })?;
        Ok(counts.map(|counts| PyArray1::from_vec(py, counts)))
    }

    /// Runs steps in portions, and handles signals between them.
    fn run(&self, py: Python<'_>, steps: u64, dt: f32, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        in_portions(py, steps, |count| {
            self.locked(py, |worlds| worlds.run(count, dt))?;
            progress.map_or(Ok(()), |progress| progress.call1((count,)).map(drop))
        })
    }

    /// Runs steps. Returns a field of the states of the spheres of all worlds after every `every` steps, of shape (samples, worlds,
    /// spheres, columns). Missing spheres are 0.
    fn record<'py>(
        &self,
        py: Python<'py>,
        steps: u64,
        dt: f32,
        every: u64,
        field: &str,
    ) -> PyResult<Bound<'py, PyArray4<f32>>> {
        let field: Field = field.parse()?;
        let columns = field.columns();
        let mut interrupt = None;
        let (numbers, shape) = self.locked(py, |worlds| {
            let [spheres, _] = room(worlds)?;
            let (mut numbers, mut samples) = (Vec::new(), 0);
            worlds.run_sampled(steps, dt, every, |sample| {
                for world in 0..sample.len() {
                    let end = numbers.len() + spheres * columns;
                    sample.states(world).iter().for_each(|state| field.append_state(state, &mut numbers));
                    numbers.resize(end, 0.0);
                }
                samples += 1;
                interrupt = Python::attach(|py| py.check_signals().err());
                if interrupt.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })?;
            Ok((numbers, [samples, worlds.len(), spheres, columns]))
        })?;
        match interrupt {
            Some(interrupt) => Err(interrupt),
            None => PyArray1::from_vec(py, numbers).reshape(shape),
        }
    }

    /// A field of the spheres of all worlds, of shape (worlds, spheres, columns). Missing spheres are 0.
    fn get<'py>(&self, py: Python<'py>, field: &str) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let field: Field = field.parse()?;
        let columns = field.columns();
        let (numbers, shape) = self.locked(py, |worlds| {
            let ([spheres, _], count) = (room(worlds)?, worlds.len());
            let shape = [count, spheres, columns];
            if field.is_state() {
                let row = |states: Vec<SphereState>| {
                    let mut row = Vec::with_capacity(spheres * columns);
                    states.iter().for_each(|state| field.append_state(state, &mut row));
                    row.resize(spheres * columns, 0.0);
                    row
                };
                let numbers = worlds.sample(|sample| {
                    (0..count).into_par_iter().flat_map_iter(|world| row(sample.states(world))).collect::<Vec<f32>>()
                })?;
                return Ok((numbers, shape));
            }
            let mut numbers = Vec::with_capacity(count * spheres * columns);
            // Brings the states to the scenes.
            worlds.all_states()?;
            for world in 0..count {
                worlds.scene(world)?.spheres().iter().for_each(|sphere| field.append(sphere, &mut numbers));
                numbers.resize((world + 1) * spheres * columns, 0.0);
            }
            Ok((numbers, shape))
        })?;
        PyArray1::from_vec(py, numbers).reshape(shape)
    }

    /// Rest lengths of the springs of all worlds, one row per world. Missing springs are 0.
    fn rest_lengths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, numpy::PyArray2<f32>>> {
        let (numbers, shape) = self.locked(py, |worlds| {
            let [_, springs] = room(worlds)?;
            let mut numbers = Vec::with_capacity(worlds.len() * springs);
            for world in 0..worlds.len() {
                numbers.extend(worlds.scene(world)?.springs().iter().map(|spring| spring.length));
                numbers.resize((world + 1) * springs, 0.0);
            }
            Ok((numbers, [worlds.len(), springs]))
        })?;
        PyArray1::from_vec(py, numbers).reshape(shape)
    }

    /// Sets a field of the spheres of some worlds, from rows with room for the spheres of the largest world.
    fn put(&self, py: Python<'_>, field: &str, numbers: Numbers<'_>, values: Floats<'_>) -> PyResult<()> {
        let field: Field = field.parse()?;
        let (numbers, values) = (numbers.as_slice()?, values.as_slice()?);
        let [spheres, _] = self.locked(py, |worlds| room(worlds))?;
        let rows = rows(values, numbers.len(), spheres * field.columns())?.collect::<Vec<_>>();
        self.locked(py, |worlds| {
            if field == Field::Force && are_all(numbers, worlds.len()) {
                let mut forces = Vec::with_capacity(values.len() / 3);
                for (world, row) in rows.into_iter().enumerate() {
                    forces.extend((0..worlds.scene(world)?.spheres().len()).map(|sphere| vector(row, sphere)));
                }
                return worlds.set_all_forces(&forces);
            }
            for (world, row) in places(numbers).zip(rows) {
                let spheres = worlds.scene(world)?.spheres().len();
                if field == Field::Force {
                    let forces: Vec<_> = (0..spheres).map(|sphere| vector(row, sphere)).collect();
                    worlds.set_forces(world, &forces)?;
                    continue;
                }
                let mut states = worlds.states(world)?;
                states.iter_mut().enumerate().for_each(|(sphere, state)| put(field, state, row, sphere));
                worlds.set_states(world, &states)?;
            }
            Ok(())
        })
    }

    /// Sets the rest lengths of some worlds, from rows with room for the springs of the largest world.
    fn put_rest_lengths(&self, py: Python<'_>, numbers: Numbers<'_>, values: Floats<'_>) -> PyResult<()> {
        let (numbers, values) = (numbers.as_slice()?, values.as_slice()?);
        let [_, springs] = self.locked(py, |worlds| room(worlds))?;
        let rows = rows(values, numbers.len(), springs)?.collect::<Vec<_>>();
        self.locked(py, |worlds| {
            let counts = (0..worlds.len()).map(|world| worlds.scene(world).map(|scene| scene.springs().len()));
            let counts = counts.collect::<Result<Vec<_>>>()?;
            if are_all(numbers, worlds.len()) {
                let lengths: Vec<f32> = counts.iter().zip(rows).flat_map(|(springs, row)| &row[..*springs]).copied().collect();
                return worlds.set_all_rest_lengths(&lengths);
            }
            let springs = |world: usize| counts.get(world).copied().unwrap_or_default();
            places(numbers).zip(rows).try_for_each(|(world, row)| worlds.set_rest_lengths(world, &row[..springs(world)]))
        })
    }

    fn reset(&self, py: Python<'_>, numbers: Numbers<'_>) -> PyResult<()> {
        let numbers: Vec<usize> = places(numbers.as_slice()?).collect();
        self.locked(py, |worlds| worlds.reset(&numbers))
    }

    /// Replaces worlds, each by a new one with a scene. Stops at the first that is refused.
    fn replace(&self, py: Python<'_>, numbers: Numbers<'_>, scenes: Vec<Py<Scene>>) -> PyResult<()> {
        let numbers: Vec<usize> = places(numbers.as_slice()?).collect();
        self.locked(py, |worlds| {
            for (world, scene) in numbers.into_iter().zip(scenes) {
                let scene = scene.get().lock().scene.clone();
                worlds.replace(world, scene)?;
            }
            Ok(())
        })
    }

    /// Replaces all worlds by a world per scene, or by `count` worlds with the one scene.
    fn replace_all(&self, py: Python<'_>, scenes: Vec<Py<Scene>>, count: Option<usize>) -> PyResult<()> {
        self.locked(py, |worlds| {
            let scenes: Vec<_> = scenes.iter().map(|scene| scene.get().lock().scene.clone()).collect();
            match count {
                Some(count) => worlds.replace_all(scenes.iter().cycle().take(count).cloned()),
                None => worlds.replace_all(scenes),
            }
        })
    }

    /// The greatest speed at rest, the steps without motion, and whether sleeping worlds stand still.
    fn sleep(&self, py: Python<'_>) -> PyResult<(f32, u32, bool)> {
        self.locked(py, |worlds| Ok((worlds.sleep().speed, worlds.sleep().steps, worlds.sleep().skip)))
    }

    fn set_sleep(&self, py: Python<'_>, speed: f32, steps: u32, skip: bool) -> PyResult<()> {
        self.locked(py, |worlds| worlds.set_sleep(rockfall::Sleep::new().speed(speed).steps(steps).skip(skip)))
    }

    /// A scene from which a simulation goes on where the world is.
    fn scene(&self, py: Python<'_>, world: usize) -> PyResult<Scene> {
        self.locked(py, |worlds| worlds.snapshot(world)).map(Scene::of)
    }

    /// Reports on all worlds. The bounds are the least and greatest coordinates of spheres that have not escaped.
    fn reports(&self, py: Python<'_>, bounds: Option<[[f32; 3]; 2]>) -> PyResult<Vec<WorldReport>> {
        self.locked(py, |worlds| {
            let count = worlds.len();
            let report = |world: usize| {
                let found = worlds.report(world, bounds.map(|bounds| bounds.map(Into::into)))?;
                let on_device = found.path == rockfall::WorldPath::Device;
                Ok((found.report.into(), on_device, found.escaped, found.stopped, found.sleeping))
            };
            (0..count).map(report).collect()
        })
    }

    fn backend(&self, py: Python<'_>) -> PyResult<BackendInfo> {
        self.locked(py, |worlds| Ok(worlds.backend().into()))
    }

    /// The integrator of all worlds; "auto" where they have different ones.
    fn integrator(&self, py: Python<'_>) -> PyResult<String> {
        self.locked(py, |worlds| {
            let mut names = (0..worlds.len()).map(|world| worlds.integrator(world));
            let Some(first) = names.next().transpose()? else {
                return Ok(worlds.options().integrator.to_string());
            };
            let differs = names.try_fold(false, |differs, next| next.map(|next| differs || next != first))?;
            Ok(if differs { "auto".to_owned() } else { first.to_string() })
        })
    }
}

/// Sets a field of a state from a row.
fn put(field: Field, state: &mut SphereState, rows: &[f32], row: usize) {
    match field {
        Field::Position => (state.position, state.position_low) = (vector(rows, row), Vec3::ZERO),
        Field::Velocity => state.velocity = vector(rows, row),
        Field::Orientation => state.orientation = quaternion(rows, row),
        Field::AngularMomentum => state.angular_momentum = vector(rows, row),
        _ => {}
    }
}
