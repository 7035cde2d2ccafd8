//! The native simulation: steps, edits of states, checkpoints.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::AtomicUsize;

use numpy::{PyArray1, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rockfall::{Backend, Checkpoint, IntegratorChoice, Options};

use crate::arguments::{ContactLaw, Law, Numbers, Rows, contact_law, law};
use crate::errors::{Raise, in_python, raise_in_step};
use crate::fork::{Owned, check_graphics, detached, graphics_opened};
use crate::ids::{Ids, handle};
use crate::memory::Views;
use crate::portions::in_portions;
use crate::running::Running;
use crate::scene::Scene;
use crate::shared::{Given, SharedArray};
use crate::states::{Field, Table};
use crate::tables::{BackendInfo, ProfileOf, Report};
use crate::team::{Starting, Team};

mod access;
mod together;

/// A simulation.
#[pyclass(frozen, module = "rockfall._rockfall")]
#[derive(Debug)]
pub(crate) struct Simulation {
    running: Mutex<Owned<Running>>,
    /// Number of threads that wait for the simulation.
    waiting: AtomicUsize,
    /// The number of this process among those that share the simulation.
    rank: Option<usize>,
}

impl Simulation {
    pub(crate) fn of(simulation: rockfall::Simulation, ids: Ids) -> Self {
        Self::shared_by(None, simulation, ids)
    }

    fn shared_by(team: Option<Team>, simulation: rockfall::Simulation, ids: Ids) -> Self {
        if simulation.backend().kind == Backend::Gpu {
            graphics_opened();
        }
        let rank = team.as_ref().map(Team::rank);
        let running = Running::new(team, simulation, ids);
        Self { running: Mutex::new(Owned::new(running)), waiting: AtomicUsize::new(0), rank }
    }

    /// A simulation, which the processes of a communicator share if there is one.
    fn begin(starting: Option<Starting>, made: PyResult<rockfall::Simulation>, ids: Option<Ids>) -> PyResult<Self> {
        let (simulation, team) = match starting {
            Some(starting) => starting.share(made).map(|(simulation, team)| (simulation, Some(team)))?,
            None => (made?, None),
        };
        let ids = ids.unwrap_or_else(|| Ids::of(simulation.scene()));
        Ok(Self::shared_by(team, simulation, ids))
    }

    /// A checkpoint with these laws as a simulation.
    fn resumed(mut checkpoint: Checkpoint, laws: Vec<Law>, contact: Option<ContactLaw>) -> PyResult<rockfall::Simulation> {
        if checkpoint.options.backend != Backend::Cpu {
            check_graphics()?;
        }
        laws.into_iter().map(law).try_for_each(|law| checkpoint.give_force_law(law)).or_raise()?;
        contact.map(contact_law).into_iter().try_for_each(|law| checkpoint.give_contact_force_law(law)).or_raise()?;
        rockfall::Simulation::resume(checkpoint).or_raise()
    }
}

/// Names of the backend, the integrator and the broad phase, with the number of the device after the first, and whether to keep going.
pub(crate) type Methods = (String, Option<usize>, String, String, bool);

/// Options from their names.
pub(crate) fn options((backend, device, integrator, broad_phase, keep_going): Methods) -> PyResult<Options> {
    let backend = backend.parse().or_raise()?;
    if backend != Backend::Cpu {
        check_graphics()?;
    }
    let options = Options::new()
        .backend(backend)
        .integrator(integrator.parse::<IntegratorChoice>().or_raise()?)
        .broad_phase(broad_phase.parse().or_raise()?)
        .keep_going(keep_going);
    Ok(device.into_iter().fold(options, Options::device))
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(
        scene: &Bound<'_, Scene>,
        methods: Methods,
        laws: Vec<Law>,
        contact: Option<ContactLaw>,
        comm: Option<i32>,
    ) -> PyResult<Self> {
        let own = scene.get();
        let options = options(methods)?;
        let starting = comm.map(Starting::of).transpose()?;
        let options = starting.iter().fold(options, |options, starting| starting.options(options));
        let options = laws.into_iter().map(law).fold(options, Options::force_law);
        let options = contact.map(contact_law).into_iter().fold(options, Options::contact_force_law);
        detached(scene.py(), || {
            let (objects, ids) = {
                let built = own.lock();
                (built.scene.clone(), built.ids.clone())
            };
            Self::begin(starting, rockfall::Simulation::with_options(objects, options).or_raise(), Some(ids))
        })
    }

    #[staticmethod]
    fn resume(
        py: Python<'_>,
        path: PathBuf,
        backend: Option<&str>,
        laws: Vec<Law>,
        contact: Option<ContactLaw>,
        comm: Option<i32>,
    ) -> PyResult<Self> {
        let backend = backend.map(str::parse).transpose().or_raise()?;
        let starting = comm.map(Starting::of).transpose()?;
        detached(py, || {
            let made = Checkpoint::load(path).or_raise().and_then(|mut checkpoint| {
                checkpoint.options.backend = backend.unwrap_or(checkpoint.options.backend);
                checkpoint.options = starting.iter().fold(checkpoint.options, |options, starting| starting.options(options));
                Self::resumed(checkpoint, laws, contact)
            });
            Self::begin(starting, made, None)
        })
    }

    /// Continues from what [`Simulation::to_bytes`] returned.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8], laws: Vec<Law>, contact: Option<ContactLaw>) -> PyResult<Self> {
        detached(py, || {
            let checkpoint = Checkpoint::from_bytes(bytes, "pickle").or_raise()?;
            Self::begin(None, Self::resumed(checkpoint, laws, contact), None)
        })
    }

    /// The bytes of a checkpoint.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let checkpoint = self.flushed(py, |running| {
            running.check_alone()?;
            running.simulation.checkpoint().or_raise()
        })?;
        Ok(PyBytes::new(py, &detached(py, || checkpoint.to_bytes())))
    }

    /// Another simulation in the same state, in which objects have the same numbers.
    fn copy(&self, py: Python<'_>) -> PyResult<Self> {
        let (checkpoint, ids) = self.flushed(py, |running| {
            running.check_alone()?;
            Ok((running.simulation.checkpoint().or_raise()?, running.ids.clone()))
        })?;
        detached(py, || Ok(Self::of(rockfall::Simulation::resume(checkpoint).or_raise()?, ids)))
    }

    /// Runs steps in portions, and handles signals between them.
    fn run(&self, py: Python<'_>, steps: u64, dt: f32, progress: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        if self.rank.is_some() {
            return together::run(self, py, steps, dt, progress);
        }
        in_portions(py, steps, |count| {
            self.change(py, |simulation| simulation.run(count, dt).map(drop).map_err(raise_in_step))?;
            self.make_way(py);
            progress.map_or(Ok(()), |progress| progress.call1((count,)).map(drop))
        })
    }

    fn phase(&self, py: Python<'_>, phase: &str, dt: f32) -> PyResult<()> {
        self.change(py, |simulation| {
            match phase {
                "update_aabbs" => simulation.update_aabbs(),
                "broad_phase" => simulation.broad_phase(),
                "handle_collisions" => simulation.handle_collisions(),
                _ => simulation.update_positions(dt),
            }
            .map_err(raise_in_step)
        })
    }

    /// Measures steps in portions, and handles signals between them.
    fn profile(&self, py: Python<'_>, steps: u64, dt: f32) -> PyResult<ProfileOf> {
        let mut whole: Option<rockfall::Profile> = None;
        in_portions(py, steps, |count| {
            let part = self.change(py, |simulation| simulation.profile(count, dt).or_raise())?;
            match &mut whole {
                Some(whole) => whole.append(part),
                None => whole = Some(part),
            }
            self.make_way(py);
            Ok(())
        })?;
        let whole = whole.ok_or_else(|| PyValueError::new_err("steps: expected a whole number of at least 1, got 0"))?;
        Ok(whole.into())
    }

    fn sort_memory(&self, py: Python<'_>) -> PyResult<()> {
        self.change(py, |simulation| simulation.sort_memory().or_raise())
    }

    fn report(&self, py: Python<'_>) -> PyResult<Report> {
        self.locked(py, |running| match &mut running.team {
            Some(team) if !team.is_current() => team.report().map(Into::into),
            _ => Ok(running.simulation.report().into()),
        })
    }

    /// Number of steps done, and time in s.
    fn elapsed(&self, py: Python<'_>) -> PyResult<(u64, f64)> {
        self.locked(py, |running| match &running.team {
            Some(team) => Ok(team.elapsed()),
            None => Ok((running.simulation.report().steps, running.simulation.report().time)),
        })
    }

    /// The number of this process among those that share the simulation; `None` if it is alone.
    fn rank(&self) -> Option<usize> {
        self.rank
    }

    /// Gives this process the state after the last step of all processes.
    fn gather(&self, py: Python<'_>) -> PyResult<()> {
        self.read(py, |_| Ok(()))
    }

    /// Ends a call that the first process alone made. If it failed, the others raise an error.
    fn agree(&self, py: Python<'_>, has_failed: bool) -> PyResult<()> {
        self.with_team(py, |team, _| team.agree(has_failed))
    }

    /// Warnings about a time step or constants that do not suit the scene.
    fn concerns(&self, py: Python<'_>, dt: f32) -> PyResult<Vec<String>> {
        self.locked(py, |running| {
            let scene = running.simulation.scene();
            let found = scene.with_grains().concerns(dt, running.simulation.integrator());
            let is_new = running.simulation.report().steps == 0;
            let overlaps = is_new.then(|| scene.overlap_concern()).flatten();
            let found = found.into_iter().chain(scene.inlet_concerns()).chain(overlaps).collect::<Vec<_>>();
            Ok(found.iter().map(|concern| in_python(concern)).collect())
        })
    }

    fn backend(&self, py: Python<'_>) -> PyResult<BackendInfo> {
        self.locked(py, |running| Ok(running.simulation.backend().into()))
    }

    fn methods(&self, py: Python<'_>) -> PyResult<(String, String)> {
        self.locked(py, |running| {
            let simulation = &running.simulation;
            Ok((simulation.integrator().to_string(), simulation.broad_phase_method().to_string()))
        })
    }

    fn device_memory(&self, py: Python<'_>) -> PyResult<u64> {
        self.locked(py, |running| Ok(running.simulation.device_memory()))
    }

    fn time_step(&self, py: Python<'_>) -> PyResult<f32> {
        self.locked(py, |running| Ok(running.simulation.time_step()))
    }

    /// Sets the time step that observations before the next step assume.
    fn set_time_step(&self, py: Python<'_>, dt: f32) -> PyResult<()> {
        self.locked(py, |running| running.simulation.set_time_step(dt).or_raise())
    }

    fn memory_version(&self, py: Python<'_>) -> PyResult<u64> {
        self.locked(py, |running| Ok(running.simulation.memory_version()))
    }

    fn save_checkpoint(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.read(py, |running| running.simulation.save_checkpoint(path).or_raise())
    }

    fn restore(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let checkpoint = detached(py, || Checkpoint::load(path)).or_raise()?;
        self.edit(py, |running| {
            running.lender.release(&mut running.simulation);
            running.simulation.restore(&checkpoint).or_raise()?;
            running.ids = Ids::of(running.simulation.scene());
            Ok(())
        })
    }

    /// A scene with the current state. Its objects are numbered from 0.
    fn scene(&self, py: Python<'_>) -> PyResult<Scene> {
        self.read(py, |running| Ok(Scene::of(running.simulation.sync().or_raise()?.clone())))
    }

    /// The memory of the CPU backend.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Option<Views<'py>>> {
        let loan = self.read(py, |running| Ok(running.lender.lend(&running.simulation)))?;
        loan.map(|loan| loan.views(py)).transpose()
    }

    /// A field of all spheres, in order of addition.
    fn get<'py>(&self, py: Python<'py>, field: &str) -> PyResult<Bound<'py, PyAny>> {
        let field: Field = field.parse()?;
        let table = self.read(py, |running| Ok(Table::of(running.simulation.sync().or_raise()?, field)))?;
        table.array(py)
    }

    /// The positions of all spheres with all digits, x, y, z one after the other, in order of addition.
    fn centres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let all = self.read(py, |running| {
            let scene = running.simulation.sync().or_raise()?;
            Ok(scene.spheres().iter().flat_map(rockfall::Sphere::centre).collect::<Vec<f64>>())
        })?;
        Ok(PyArray1::from_vec(py, all))
    }

    /// Sets the positions of all spheres with all digits.
    fn put_centres(&self, py: Python<'_>, centres: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        let centres = centres.as_slice()?;
        self.edit(py, |running| {
            let ids: Vec<_> = running.simulation.scene().sphere_ids().collect();
            let rows = centres.as_chunks::<3>().0;
            ids.into_iter().zip(rows).try_for_each(|(id, row)| running.simulation.set_centre(id, *row)).or_raise()
        })
    }

    /// Why arrays on the device cannot be used by other libraries there; `None` where they can.
    fn not_shared(&self, py: Python<'_>) -> PyResult<Option<String>> {
        self.locked(py, |running| match running.team {
            Some(_) => Ok(Some("processes share the simulation".to_owned())),
            None => Ok(running.sharing().err().map(str::to_owned)),
        })
    }

    /// A field of all spheres on the device, in order of addition; `None` where memory cannot be shared.
    fn shared(&self, py: Python<'_>, field: &str) -> PyResult<Option<SharedArray>> {
        let field: Field = field.parse()?;
        if self.rank.is_some() {
            return Ok(None);
        }
        self.read(py, |running| match running.sharing() {
            Ok((sharing, simulation)) => sharing.read(simulation, field),
            Err(_) => Ok(None),
        })
    }

    /// A field of all rigid bodies on the device, in order of addition; `None` where memory cannot be shared.
    fn shared_bodies(&self, py: Python<'_>, field: &str) -> PyResult<Option<SharedArray>> {
        let field: Field = field.parse()?;
        if self.rank.is_some() {
            return Ok(None);
        }
        self.read(py, |running| match running.sharing() {
            Ok((sharing, simulation)) => sharing.read_bodies(simulation, field),
            Err(_) => Ok(None),
        })
    }

    /// Sets a field of all spheres from an array on the device. Returns whether the array is there.
    fn put_shared(&self, py: Python<'_>, field: &str, array: &Bound<'_, PyAny>) -> PyResult<bool> {
        let field: Field = field.parse()?;
        let device = self.locked(py, |running| {
            running.check_alone()?;
            Ok(running.sharing().ok().map(|(sharing, _)| sharing.device()))
        })?;
        let Some(given) = device.map(|device| Given::take(array, device)).transpose()?.flatten() else { return Ok(false) };
        self.read(py, |running| match running.sharing() {
            Ok((sharing, simulation)) => sharing.write(simulation, field, &given).map(|()| true),
            Err(_) => Ok(false),
        })
    }

    /// Sets the rows of a field that differ from the current state. Returns their number.
    fn put(&self, py: Python<'_>, field: &str, rows: Rows<'_>) -> PyResult<usize> {
        let (field, rows): (Field, _) = (field.parse()?, rows.as_slice()?);
        self.flushed(py, |running| {
            running.check_alone()?;
            let now = Table::of(running.simulation.sync().or_raise()?, field);
            let changed = now.differences(rows)?;
            running.edited = !changed.is_empty();
            let ids: Vec<_> = running.simulation.scene().sphere_ids().collect();
            for row in &changed {
                field.set(&mut running.simulation, ids[*row], rows, *row).or_raise()?;
            }
            Ok(changed.len())
        })
    }

    /// Sets a field of the spheres with these numbers, or applies impulses.
    fn set(&self, py: Python<'_>, field: &str, numbers: Numbers<'_>, rows: Rows<'_>) -> PyResult<()> {
        let field: Field = field.parse()?;
        if rows.len() != numbers.len() * field.columns() {
            return Err(PyValueError::new_err(format!(
                "expected {} rows, got {}",
                numbers.len(),
                rows.len() / field.columns()
            )));
        }
        let (numbers, rows) = (numbers.as_slice()?, rows.as_slice()?);
        self.edit(py, |running| {
            let spheres: Vec<_> =
                numbers.iter().map(|id| handle(&running.ids.spheres, "sphere", *id)).collect::<PyResult<_>>()?;
            let scene = running.simulation.scene();
            spheres.iter().try_for_each(|id| scene.sphere(*id).map(drop)).or_raise()?;
            let set = |(row, id)| field.set(&mut running.simulation, id, rows, row);
            spheres.into_iter().enumerate().try_for_each(set).or_raise()
        })
    }
}
