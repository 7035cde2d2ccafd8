//! One scene in two simulations whose results must be bitwise identical: brute force on one thread, and the grid on three.

use std::fmt::Debug;
use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuilder};
use rockfall::glam::Vec3;
use rockfall::{Backend, BroadPhase, Checkpoint, Contact, ContactAction, Error, Options, Result, RigidBody, Scene, Simulation};

use super::message::assert_short;

/// Upper bound of the memory of a simulation, in bytes: far more than such a small scene needs, and far less than would cause
/// problems.
const MEMORY: u64 = 64 << 20;
/// Maximum number of times that one step may be rejected.
const REPLAYS: u64 = 64;

pub(crate) struct Twins {
    simulations: Vec<(Simulation, &'static ThreadPool)>,
    /// Checkpoints of both, if they were saved.
    saved: Vec<Checkpoint>,
}

fn pool(threads: usize) -> &'static ThreadPool {
    static POOLS: [OnceLock<ThreadPool>; 4] = [const { OnceLock::new() }; 4];
    POOLS[threads].get_or_init(|| ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start"))
}

impl Twins {
    /// Opens a scene, whose handles are valid in both simulations.
    pub(crate) fn new(scene: &Scene, options: &Options) -> Result<Self> {
        let open = |broad_phase, threads| {
            let options = options.clone().backend(Backend::Cpu).broad_phase(broad_phase);
            Ok((Simulation::with_options(scene.clone(), options)?, pool(threads)))
        };
        Ok(Self { simulations: vec![open(BroadPhase::BruteForce, 1)?, open(BroadPhase::Grid, 3)?], saved: Vec::new() })
    }

    /// Returns the scene of the first simulation, for its handles.
    pub(crate) fn scene(&self) -> &Scene {
        self.simulations[0].0.scene()
    }

    /// Calls a function with both simulations. Their answers must be identical.
    pub(crate) fn both<T: Debug + Send>(&mut self, what: impl Fn(&mut Simulation) -> Result<T> + Sync) -> Option<T> {
        let mut all = self.simulations.iter_mut().map(|(simulation, pool)| pool.install(|| what(simulation)));
        let first = all.next().expect("there are two");
        for other in all {
            assert_equal(&told(&other), &told(&first));
        }
        first.ok()
    }

    /// Continues both from checkpoints. The checkpoint from a file must be the same, and run the same.
    pub(crate) fn resume(&mut self, steps: u64, dt: f32) {
        self.both(|simulation| {
            let checkpoint = simulation.checkpoint()?;
            let bytes = checkpoint.to_bytes();
            let mut read = Checkpoint::from_bytes(&bytes, "fuzz.ckpt").expect("a written checkpoint can be read");
            simulation.force_laws().iter().try_for_each(|law| read.give_force_law(law.clone()))?;
            simulation.contact_force_law().into_iter().try_for_each(|law| read.give_contact_force_law(law.clone()))?;
            assert!(read.to_bytes() == bytes, "the checkpoint differs when it is written again");
            *simulation = Simulation::resume(checkpoint.clone())?;
            let [one, other] = [checkpoint, read].map(|checkpoint| {
                let mut simulation = Simulation::resume(checkpoint).expect("one was resumed before");
                let end = told(&simulation.run(steps, dt).map(drop));
                [end, told(&simulation.spheres()), told(&simulation.contacts().map(|contacts| unnamed(&contacts)))].join(" ")
            });
            assert_equal(&one, &other);
            Ok(one)
        });
    }

    pub(crate) fn save(&mut self) {
        let taken: Result<Vec<_>> = self.simulations.iter_mut().map(|(simulation, _)| simulation.checkpoint()).collect();
        self.saved = taken.unwrap_or_default();
    }

    pub(crate) fn restore(&mut self) {
        for ((simulation, pool), saved) in self.simulations.iter_mut().zip(&self.saved) {
            let _ = pool.install(|| simulation.restore(saved));
        }
        self.compare();
    }

    /// Advances both simulations and compares them.
    pub(crate) fn advance(&mut self, most_steps: u64, what: impl Fn(&mut Simulation) -> Result<()> + Sync) {
        let before: Vec<u64> = self.simulations.iter().map(|(simulation, _)| simulation.report().replays).collect();
        self.both(what);
        for ((simulation, _), before) in self.simulations.iter().zip(before) {
            let replays = simulation.report().replays - before;
            assert!(replays <= REPLAYS * most_steps.max(1), "{replays} repetitions of {most_steps} steps");
            assert!(simulation.device_memory() < MEMORY, "{} bytes", simulation.device_memory());
        }
        self.compare();
    }

    /// Checks that the states of both are bitwise identical and finite.
    pub(crate) fn compare(&mut self) {
        // Edits may have made a scene that its contact law or its precision does not allow. Both simulations say so.
        let Some(states) = self.both(Simulation::spheres) else { return };
        for (index, state) in states.iter().enumerate() {
            let finite = state.position.is_finite() && state.velocity.is_finite() && state.angular_momentum.is_finite();
            assert!(finite && state.orientation.is_finite(), "sphere {index}: {state:?}");
        }
        let bodies = self.both(|simulation| {
            let state = |body: &RigidBody| (body.position, body.velocity, body.angular_momentum, body.orientation);
            Ok(simulation.sync()?.bodies().iter().map(state).collect::<Vec<_>>())
        });
        for (index, (position, velocity, momentum, orientation)) in bodies.into_iter().flatten().enumerate() {
            let finite = position.is_finite() && velocity.is_finite() && momentum.is_finite() && orientation.is_finite();
            assert!(finite, "body {index}: {position} {velocity} {momentum} {orientation}");
        }
        self.both(|simulation| {
            let report = simulation.report();
            let met = (report.contacts, report.max_overlap.to_bits(), report.collisions, report.total_collisions);
            Ok((report.steps, report.time.to_bits(), report.non_finite, met))
        });
    }

    /// Compares everything that can be read about the present state.
    pub(crate) fn observe(&mut self) {
        self.both(Simulation::contacts);
        self.both(Simulation::diagnostics);
        self.both(Simulation::max_overlap);
        self.both(Simulation::energy);
        self.both(|simulation| Ok(simulation.sync()?.to_text()));
    }
}

/// Contacts without the handles of their objects, which a file does not keep.
fn unnamed(contacts: &[Contact]) -> Vec<(Vec3, Vec3, f32, ContactAction)> {
    contacts.iter().map(|contact| (contact.point, contact.normal, contact.overlap, contact.action)).collect()
}

/// Compares two texts, and shows where they differ.
#[track_caller]
fn assert_equal(one: &str, other: &str) {
    let same = one.bytes().zip(other.bytes()).take_while(|(a, b)| a == b).count();
    let around = |text: &str| text.bytes().skip(same.saturating_sub(150)).take(300).map(char::from).collect::<String>();
    assert!(one == other, "at {same}:\n{}\n{}", around(one), around(other));
}

/// Returns the answer of a call as text, for comparison. Numbers are printed exactly.
///
/// # Panics
/// When a step was given up.
fn told<T: Debug>(result: &Result<T>) -> String {
    match result {
        Ok(value) => format!("{value:?}"),
        Err(Error::Stuck { step, attempts, reason }) => panic!("step {step} was rejected {attempts} times: {reason}"),
        Err(error) => {
            assert_short(error);
            format!("{error}")
        }
    }
}
