//! Measures a scene of one size.

use std::time::Instant;

use rockfall::step::schedule::Phase;
use rockfall::{BackendInfo, BroadPhase, BufferSize, Counts, Integrator, Profile, Report, Simulation};

use crate::bench::Arguments;
use crate::bench::spread::Spread;
use crate::failure::Failure;
use crate::output;

/// Measurements of a scene of one size.
pub(crate) struct Measured {
    /// Requested number of spheres or bodies.
    pub(crate) bodies: u32,
    pub(crate) counts: Counts,
    pub(crate) backend: BackendInfo,
    pub(crate) integrator: Integrator,
    /// Method in use; never `auto`.
    pub(crate) broad_phase: BroadPhase,
    /// Number of timed steps in a run.
    pub(crate) steps: u64,
    /// Wall time of a run, in s.
    pub(crate) seconds: Spread,
    /// Report of the last run, including its warm-up.
    pub(crate) report: Report,
    /// Buffer sizes after the last run.
    pub(crate) buffers: Vec<BufferSize>,
    /// Bandwidth of a plain copy, in bytes read plus bytes written per second, if it can be timed.
    pub(crate) copy_bandwidth: Option<f64>,
    /// Time of each stage, if the device supports timestamps.
    pub(crate) profile: Option<Profile>,
}

impl Measured {
    pub(crate) fn steps_per_second(&self) -> Spread {
        self.seconds.inverse(self.steps as f64)
    }

    pub(crate) fn sphere_steps_per_second(&self) -> Spread {
        self.seconds.inverse(self.steps as f64 * self.counts.spheres as f64)
    }

    /// Total size of all buffers, in bytes.
    pub(crate) fn memory(&self) -> u64 {
        self.buffers.iter().map(|buffer| buffer.bytes).sum()
    }

    /// Smallest number of bytes that a step has to read and write.
    pub(crate) fn least_bytes_per_step(&self) -> Option<f64> {
        let profile = self.profile.as_ref()?;
        Some(profile.least_bytes() as f64 / profile.steps.max(1) as f64)
    }

    /// Share of the copy bandwidth that a plain run uses: the least bytes per step, divided by the bytes that a copy moves in
    /// the same time.
    pub(crate) fn bandwidth_used(&self) -> Option<f64> {
        let bytes_per_second = self.least_bytes_per_step()? * self.steps_per_second().median;
        Some(bytes_per_second / self.copy_bandwidth?)
    }

    /// Time of a phase per step, in s.
    pub(crate) fn phase_seconds(&self, phase: Phase) -> Option<f64> {
        let profile = self.profile.as_ref()?;
        Some(profile.phase_seconds(phase) / profile.steps.max(1) as f64)
    }
}

/// Creates a simulation of the scene, compiles its kernels and runs the warm-up steps.
fn start(arguments: &Arguments, bodies: u32) -> Result<Simulation, Failure> {
    let mut scene = arguments.scene.generate(bodies, arguments.seed)?;
    arguments.physics.change(&mut scene.settings)?;
    let options = arguments.engine.options(&arguments.physics);
    let mut simulation = Simulation::with_options(scene, options)?;
    simulation.prepare()?;
    simulation.run(arguments.warmup(), arguments.dt())?;
    Ok(simulation)
}

pub(crate) fn measure(arguments: &Arguments, bodies: u32) -> Result<Measured, Failure> {
    let (steps, dt) = (arguments.steps, arguments.dt());
    let scene = arguments.scene;
    let mut seconds = Vec::new();
    for run in 1..arguments.runs {
        output::note(&format!("{scene} {bodies}: run {run} of {}", arguments.runs));
        seconds.push(timed(&mut start(arguments, bodies)?, steps, dt)?);
    }
    output::note(&format!("{scene} {bodies}: run {0} of {0}", arguments.runs));
    let mut simulation = start(arguments, bodies)?;
    seconds.push(timed(&mut simulation, steps, dt)?);
    let (report, buffers) = (simulation.report(), simulation.buffer_sizes());
    // Frees the memory before the next simulation allocates the same amount.
    drop(simulation);

    output::note(&format!("{scene} {bodies}: stage times"));
    let mut simulation = start(arguments, bodies)?;
    let profile = match simulation.clock() {
        Ok(_) => Some(simulation.profile(steps, dt)?),
        Err(error) => {
            output::note(&format!("warning: stage times are not available: {error}"));
            None
        }
    };
    let copy_bandwidth = simulation.copy_bandwidth();
    if let Err(error) = &copy_bandwidth {
        output::note(&format!("warning: the bandwidth of a copy is not available: {error}"));
    }
    Ok(Measured {
        bodies,
        counts: simulation.scene().counts(),
        backend: simulation.backend().clone(),
        integrator: simulation.integrator(),
        broad_phase: simulation.broad_phase_method(),
        steps,
        seconds: Spread::of(seconds),
        report,
        buffers,
        copy_bandwidth: copy_bandwidth.ok(),
        profile,
    })
}

/// Wall time of a plain run, in s. A run ends by reading the status of the device, so all its work is complete.
fn timed(simulation: &mut Simulation, steps: u64, dt: f32) -> Result<f64, Failure> {
    let start = Instant::now();
    simulation.run(steps, dt)?;
    Ok(start.elapsed().as_secs_f64())
}
