//! The native evolution of creatures.

use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rockfall::Backend;
use rockfall_evolve::{Genome, Ground, Outcome, Plan};

use crate::errors::Raise;
use crate::fork::{Owned, check_graphics, detached, graphics_opened};
use crate::scene::Scene;

/// An evolution.
#[pyclass(frozen, module = "rockfall._rockfall")]
#[derive(Debug)]
pub(crate) struct Evolution(Mutex<Owned<rockfall_evolve::Evolution>>);

/// The report on a generation.
#[derive(Debug, IntoPyObject)]
pub(crate) struct Generation {
    number: u64,
    champion: f64,
    best: f64,
    mean: f64,
    niches: usize,
    not_finite: usize,
    exploded: usize,
    unsteady: usize,
    downhill: usize,
    failed_audits: usize,
}

impl From<&rockfall_evolve::Generation> for Generation {
    fn from(generation: &rockfall_evolve::Generation) -> Self {
        Self {
            number: generation.number,
            champion: generation.champion,
            best: generation.best,
            mean: generation.mean,
            niches: generation.niches,
            not_finite: generation.not_finite,
            exploded: generation.exploded,
            unsteady: generation.unsteady,
            downhill: generation.downhill,
            failed_audits: generation.failed_audits,
        }
    }
}

/// A creature and what it did.
#[derive(IntoPyObject)]
pub(crate) struct Creature {
    scene: Scene,
    fitness: f64,
    distance: f64,
    bounce: f64,
    length: f32,
    frequency: f32,
    masses: usize,
}

/// What determines an evolution.
#[derive(Debug, IntoPyObject)]
pub(crate) struct PlanOf {
    population: usize,
    seed: u64,
    body: String,
    goal: String,
    seconds: f64,
    dt: f32,
    integrator: String,
    ground: String,
    settling_steps: u64,
    steps: u64,
}

impl Evolution {
    /// Calls a function without the GIL, while no other thread uses the evolution.
    fn locked<R: Send>(
        &self,
        py: Python<'_>,
        call: impl FnOnce(&mut rockfall_evolve::Evolution) -> PyResult<R> + Send,
    ) -> PyResult<R> {
        detached(py, || {
            let mut evolution = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            if evolution.trial().options.backend != Backend::Cpu {
                check_graphics()?;
            }
            call(&mut evolution)
        })
    }
}

/// Notes the use of a graphics adapter by an evolution with this backend. An error if a fork has made that impossible.
fn open_graphics(backend: Backend) -> PyResult<()> {
    if backend == Backend::Cpu {
        return Ok(());
    }
    check_graphics()?;
    if backend == Backend::Gpu || rockfall::devices().iter().any(|device| !device.software) {
        graphics_opened();
    }
    Ok(())
}

fn creature(evolution: &rockfall_evolve::Evolution, genome: &Genome, outcome: &Outcome) -> PyResult<Creature> {
    Ok(Creature {
        scene: Scene::of(genome.scene(&evolution.trial().ground).or_raise()?),
        fitness: outcome.fitness,
        distance: outcome.distance,
        bounce: outcome.bounce,
        length: genome.length(),
        frequency: genome.frequency,
        masses: genome.nodes.len(),
    })
}

/// An error of a name: which argument it is and what was expected.
fn named<T: std::str::FromStr<Err = String>>(argument: &str, name: &str) -> PyResult<T> {
    name.parse().map_err(|expected| PyValueError::new_err(format!("{argument}: {expected}, got {name:?}")))
}

#[pymethods]
impl Evolution {
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        population: usize,
        seed: u64,
        body: &str,
        goal: &str,
        seconds: f64,
        dt: f32,
        integrator: &str,
        ground: Option<Py<Scene>>,
        backend: &str,
    ) -> PyResult<Self> {
        let (body, goal, backend) = (named("body", body)?, named("goal", goal)?, backend.parse::<Backend>().or_raise()?);
        let integrator = integrator.parse::<rockfall::Integrator>().or_raise()?.to_string();
        open_graphics(backend)?;
        detached(py, || {
            let ground = match ground {
                Some(scene) => Ground::of(scene.get().lock().scene.clone()),
                None => Ground::level(seconds).or_raise()?,
            };
            let ground = ground.scene().to_text();
            let plan = Plan { population, seed, body, goal, seconds, dt, integrator, ground };
            let trial = plan.trial(backend).or_raise()?;
            Ok(Self(Mutex::new(Owned::new(rockfall_evolve::Evolution::new(plan, trial)))))
        })
    }

    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, backend: &str) -> PyResult<Self> {
        let backend = backend.parse::<Backend>().or_raise()?;
        open_graphics(backend)?;
        let trial = |plan: &Plan| plan.trial(backend).map_err(std::io::Error::other);
        let found = detached(py, || rockfall_evolve::Evolution::load(&path, trial));
        found.map(|evolution| Self(Mutex::new(Owned::new(evolution)))).map_err(|error| {
            let text = format!("{}: {error}", path.display());
            match error.kind() {
                std::io::ErrorKind::InvalidData | std::io::ErrorKind::Other => PyValueError::new_err(text),
                kind => std::io::Error::new(kind, text).into(),
            }
        })
    }

    /// Makes and tries a generation. A signal such as Ctrl-C leaves everything as it was.
    fn generation(&self, py: Python<'_>) -> PyResult<Generation> {
        self.locked(py, |evolution| {
            let signal = RefCell::new(None);
            let should_stop = || {
                let found = Python::attach(|py| py.check_signals());
                let is_signal = found.is_err();
                *signal.borrow_mut() = found.err();
                is_signal
            };
            let done = evolution.generation(&should_stop).or_raise()?.map(Generation::from);
            let interrupted = || pyo3::exceptions::PyKeyboardInterrupt::new_err(());
            done.ok_or_else(|| signal.take().unwrap_or_else(interrupted))
        })
    }

    /// Takes the creatures of another evolution that are fitter than those of their kinds. Returns their number.
    fn adopt(&self, py: Python<'_>, other: &Bound<'_, Self>) -> PyResult<usize> {
        // A copy, so that two evolutions that adopt from each other do not wait for each other.
        let other = other.get().locked(py, |other| Ok(other.clone()))?;
        self.locked(py, |evolution| evolution.adopt(&other).or_raise())
    }

    fn history(&self, py: Python<'_>) -> PyResult<Vec<Generation>> {
        self.locked(py, |evolution| Ok(evolution.history().iter().map(Generation::from).collect()))
    }

    fn plan(&self, py: Python<'_>) -> PyResult<PlanOf> {
        self.locked(py, |evolution| {
            let (plan, trial) = (evolution.plan(), evolution.trial());
            Ok(PlanOf {
                population: plan.population,
                seed: plan.seed,
                body: plan.body.to_string(),
                goal: plan.goal.to_string(),
                seconds: plan.seconds,
                dt: plan.dt,
                integrator: plan.integrator.clone(),
                ground: plan.ground.clone(),
                settling_steps: trial.settling_steps(),
                steps: trial.steps(),
            })
        })
    }

    /// The best creature that has passed an audit.
    fn champion(&self, py: Python<'_>) -> PyResult<Option<Creature>> {
        self.locked(py, |evolution| {
            let champion = evolution.champion();
            champion.map(|champion| creature(evolution, &champion.genome, &champion.outcome)).transpose()
        })
    }

    /// The fittest creatures of different kinds.
    fn gallery(&self, py: Python<'_>, most: usize) -> PyResult<Vec<Creature>> {
        self.locked(py, |evolution| {
            let gallery = evolution.gallery(most).or_raise()?;
            gallery.into_iter().map(|(_, elite)| creature(evolution, &elite.genome, &elite.outcome)).collect()
        })
    }

    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.locked(py, |evolution| {
            let wrong = |error: std::io::Error| std::io::Error::new(error.kind(), format!("{}: {error}", path.display()));
            Ok(evolution.save(&path).map_err(wrong)?)
        })
    }
}
