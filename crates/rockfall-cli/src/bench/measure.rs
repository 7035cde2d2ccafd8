//! Measuring one size.

use std::time::Instant;

use rockfall::step::schedule::Phase;
use rockfall::{BackendInfo, BroadPhase, BufferSize, Counts, Profile, Report, Simulation};

use crate::bench::Arguments;
use crate::bench::spread::Spread;
use crate::failure::Failure;
use crate::output;

/// What was measured of a scene of one size.
pub(crate) struct Measured {
    /// The number that was asked for.
    pub(crate) bodies: u32,
    pub(crate) counts: Counts,
    pub(crate) backend: BackendInfo,
    /// What was taken, where the choice was `auto`.
    pub(crate) broad_phase: BroadPhase,
    /// Steps of a run.
    pub(crate) steps: u64,
    /// Wall time of a run, in s.
    pub(crate) seconds: Spread,
    /// Of the last run, with its warm-up.
    pub(crate) report: Report,
    /// After the last run.
    pub(crate) buffers: Vec<BufferSize>,
    /// What a plain copy reaches, in bytes read and written a second, if that can be timed.
    pub(crate) copy_bandwidth: Option<f64>,
    /// Time by stage, if the device can tell.
    pub(crate) profile: Option<Profile>,
}

impl Measured {
    pub(crate) fn steps_per_second(&self) -> Spread {
        self.seconds.inverse(self.steps as f64)
    }

    pub(crate) fn sphere_steps_per_second(&self) -> Spread {
        self.seconds.inverse(self.steps as f64 * self.counts.spheres as f64)
    }

    /// Bytes of all buffers.
    pub(crate) fn memory(&self) -> u64 {
        self.buffers.iter().map(|buffer| buffer.bytes).sum()
    }

    /// Bytes that a step must move at least.
    pub(crate) fn least_bytes_per_step(&self) -> Option<f64> {
        let profile = self.profile.as_ref()?;
        Some(profile.least_bytes() as f64 / profile.steps.max(1) as f64)
    }

    /// How near a plain run comes to the bandwidth of a copy: the part of its time in which a copy would have moved what
    /// the steps must move at least.
    pub(crate) fn bandwidth_used(&self) -> Option<f64> {
        let bytes_per_second = self.least_bytes_per_step()? * self.steps_per_second().median;
        Some(bytes_per_second / self.copy_bandwidth?)
    }

    /// Time of a phase in a step, in s.
    pub(crate) fn phase_seconds(&self, phase: Phase) -> Option<f64> {
        let profile = self.profile.as_ref()?;
        Some(profile.phase_seconds(phase) / profile.steps.max(1) as f64)
    }
}

/// A simulation of the scene, its kernels compiled, past its warm-up.
fn start(arguments: &Arguments, bodies: u32) -> Result<Simulation, Failure> {
    let mut scene = arguments.scene.generate(bodies, arguments.seed)?;
    arguments.physics.change(&mut scene.settings)?;
    let options = arguments.engine.options(&arguments.physics);
    let mut simulation = Simulation::with_options(scene, options)?;
    simulation.prepare()?;
    simulation.run(arguments.warmup(), arguments.physics.dt)?;
    Ok(simulation)
}

pub(crate) fn measure(arguments: &Arguments, bodies: u32) -> Result<Measured, Failure> {
    let (steps, dt) = (arguments.steps, arguments.physics.dt);
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
    // Its memory goes before the next takes as much.
    drop(simulation);

    output::note(&format!("{scene} {bodies}: stage by stage"));
    let mut simulation = start(arguments, bodies)?;
    let profile = match simulation.clock() {
        Ok(_) => Some(simulation.profile(steps, dt)?),
        Err(error) => {
            output::note(&format!("warning: no times by stage: {error}"));
            None
        }
    };
    let copy_bandwidth = simulation.copy_bandwidth();
    if let Err(error) = &copy_bandwidth {
        output::note(&format!("warning: no bandwidth to compare with: {error}"));
    }
    Ok(Measured {
        bodies,
        counts: simulation.scene().counts(),
        backend: simulation.backend().clone(),
        broad_phase: simulation.broad_phase_method(),
        steps,
        seconds: Spread::of(seconds),
        report,
        buffers,
        copy_bandwidth: copy_bandwidth.ok(),
        profile,
    })
}

/// Wall time of a plain run, in s. A run ends with a look at the device's status, so nothing is left under way.
fn timed(simulation: &mut Simulation, steps: u64, dt: f32) -> Result<f64, Failure> {
    let start = Instant::now();
    simulation.run(steps, dt)?;
    Ok(start.elapsed().as_secs_f64())
}
