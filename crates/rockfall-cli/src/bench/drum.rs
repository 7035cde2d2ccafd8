//! `rockfall bench drum`: measures grains in a rotating drum, with the contact law `hertz-mindlin`.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::time::Instant;

use rockfall::generate::Drum;
use rockfall::{Integrator, Options, Report, Scene, Simulation};
use serde_json::json;

use crate::bench::measure::Measured;
use crate::bench::spread::Spread;
use crate::bench::{json as sizes_as_json, table};
use crate::failure::Failure;
use crate::options::{Engine, as_written, time_step, whole};
use crate::output;

/// Steps of the run with timestamps around every dispatch.
const PROFILED: u64 = 200;

/// Measure grains in a rotating drum, with the contact law hertz-mindlin and rolling resistance
///
/// The drum and the grains are those of the benchmark of PhasicFlow: glass, an effective modulus of 1 MPa, e = 0.97,
/// mu = 0.65, mu_r = 0.1 (model C), a drum four times as long as its radius (0.2 m for 1,000,000 grains; see --length). The direction of
/// gravity turns in the frame of the drum. The grains start as a loose lattice and fall for about 0.2 s, which are 20,000
/// steps of 1e-5 s. At 12 revolutions per minute the bed begins to flow after about 45,000 steps: --warmup 60000 measures the
/// flow. Under mpirun, processes share the drum (docs/cluster.md), with --triangles or --rpm 0. The warm-up steps, and the same timed steps for comparison,
/// are taken by every process alone first.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Numbers of grains, separated by commas; each is measured separately
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "2000,16000",
        value_parser = whole(1_u32, u32::MAX), allow_negative_numbers = true)]
    pub(super) grains: Vec<u32>,
    /// Radius of the grains in m; the drum grows with it
    #[arg(long, value_name = "M", default_value = "0.002", value_parser = positive, allow_negative_numbers = true)]
    radius: f32,
    /// Length of the drum over its radius, from 0.01 to 100. Twice the length and twice the grains give a bed of the same depth
    #[arg(long, value_name = "N", default_value = "4", value_parser = positive, allow_negative_numbers = true)]
    length: f32,
    /// Number of polygons of the drum
    #[arg(long, value_name = "N", default_value_t = 48, value_parser = whole(6_u32, 10_000), allow_negative_numbers = true)]
    facets: u32,
    /// Let the walls turn instead of the direction of gravity, and make them of triangles
    #[arg(long)]
    triangles: bool,
    /// Make every grain a rigid body of three spheres, which fit into a sphere of its radius
    #[arg(long)]
    clumps: bool,
    /// Number of timed steps in each run
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    pub(super) steps: u64,
    /// Steps before the timed ones
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    pub(super) warmup: u64,
    /// Number of runs, one after the other in the same drum; their median is reported
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    pub(super) runs: u32,
    /// Time step in seconds
    #[arg(long, value_name = "S", default_value = "0.00001", value_parser = time_step, allow_negative_numbers = true)]
    pub(super) dt: f32,
    /// Revolutions per minute
    #[arg(long, value_name = "N", default_value = "12", value_parser = finite, allow_negative_numbers = true)]
    rpm: f64,
    /// Number of steps between two changes of the direction of gravity
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    turn_every: u64,
    /// Integrator: symplectic-euler or velocity-verlet
    #[arg(long, default_value_t = Integrator::VelocityVerlet)]
    pub(super) integrator: Integrator,
    #[command(flatten)]
    engine: Engine,
    /// Seed of the random numbers; the same seed gives the same drum
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Print one JSON object instead of tables
    #[arg(long)]
    pub(super) json: bool,
}

fn positive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err("expected a finite number greater than 0".to_owned()),
    }
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(|| "expected a finite number".to_owned())
}

/// A drum that turns.
struct Turning {
    simulation: Simulation,
    /// Number of steps done.
    steps: u64,
}

impl Turning {
    /// Runs some steps. Gravity changes in every step whose number is divisible by `turn_every`.
    fn run(&mut self, arguments: &Arguments, steps: u64) -> Result<Report, Failure> {
        let end = self.steps + steps;
        while self.steps < end {
            let until = (self.steps / arguments.turn_every + 1).saturating_mul(arguments.turn_every).min(end);
            if !arguments.triangles && self.steps.is_multiple_of(arguments.turn_every) {
                let mut settings = *self.simulation.settings();
                settings.gravity_direction = Drum::down(arguments.angle(self.steps));
                self.simulation.set_settings(settings)?;
            }
            self.simulation.run(until - self.steps, arguments.dt)?;
            self.steps = until;
        }
        Ok(self.simulation.report())
    }
}

impl Arguments {
    /// Angle, in rad, by which the drum has turned after some steps.
    fn angle(&self, steps: u64) -> f64 {
        TAU * self.rpm / 60.0 * as_written(self.dt) * steps as f64
    }

    /// Whether the direction of gravity stays as it is.
    #[cfg(feature = "mpi")]
    pub(super) fn has_still_gravity(&self) -> bool {
        self.triangles || self.rpm == 0.0
    }

    fn drum(&self, grains: u32) -> Drum {
        let mut drum = Drum::new(grains);
        (drum.radius, drum.length, drum.facets, drum.clumps) = (self.radius, self.length, self.facets, self.clumps);
        if self.triangles { drum.triangles().spin(TAU * self.rpm / 60.0) } else { drum }
    }

    /// The scene with this number of grains.
    pub(super) fn scene(&self, grains: u32) -> Result<Scene, Failure> {
        Ok(self.drum(grains).scene(self.seed)?)
    }

    pub(super) fn options(&self) -> Options {
        self.engine.with_integrator(self.integrator)
    }

    fn measure(&self, grains: u32) -> Result<Measured, Failure> {
        let mut simulation = Simulation::with_options(self.scene(grains)?, self.options())?;
        simulation.prepare()?;
        let mut drum = Turning { simulation, steps: 0 };
        output::note(&format!("drum {grains}: {} warm-up steps", self.warmup));
        drum.run(self, self.warmup)?;
        let mut seconds = Vec::new();
        for run in 1..=self.runs {
            output::note(&format!("drum {grains}: run {run} of {}", self.runs));
            let start = Instant::now();
            drum.run(self, self.steps)?;
            seconds.push(start.elapsed().as_secs_f64());
        }
        let (report, buffers) = (drum.simulation.report(), drum.simulation.buffer_sizes());
        output::note(&format!("drum {grains}: stage times"));
        let profile = match drum.simulation.clock() {
            Ok(_) => Some(drum.simulation.profile(self.steps.min(PROFILED), self.dt)?),
            Err(error) => {
                output::note(&format!("warning: stage times are not available: {error}"));
                None
            }
        };
        let copy_bandwidth = drum.simulation.copy_bandwidth();
        if let Err(error) = &copy_bandwidth {
            output::note(&format!("warning: the bandwidth of a copy is not available: {error}"));
        }
        Ok(Measured {
            bodies: grains,
            counts: drum.simulation.scene().counts(),
            backend: drum.simulation.backend().clone(),
            integrator: drum.simulation.integrator(),
            broad_phase: drum.simulation.broad_phase_method(),
            steps: self.steps,
            seconds: Spread::of(seconds),
            report,
            buffers,
            copy_bandwidth: copy_bandwidth.ok(),
            profile,
        })
    }

    fn table(&self, sizes: &[Measured]) -> String {
        let device = sizes.first().map_or("", |size| &size.backend.device);
        let turning = match self.triangles {
            true => "walls of triangles turn".to_owned(),
            false => format!("gravity turned every {} steps", self.turn_every),
        };
        let mut text = format!(
            "rockfall bench drum, hertz-mindlin, rolling model c, {}, {} polygons, {} revolutions per minute: {device}\n\
             {} steps of {} s after {} warm-up steps, {turning}, median (minimum to maximum) of {} runs\n",
            self.integrator, self.facets, self.rpm, self.steps, self.dt, self.warmup, self.runs
        );
        for size in sizes {
            let steps = self.warmup + u64::from(self.runs) * self.steps;
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{} grains: turned by {:.1} degrees in {:.3} s, {:.2} contacts per grain",
                size.bodies,
                self.angle(steps).to_degrees(),
                as_written(self.dt) * steps as f64,
                f64::from(size.report.contacts) / f64::from(size.bodies)
            );
        }
        table::sizes(&mut text, sizes);
        text
    }

    fn object(&self, sizes: &[Measured]) -> Result<String, Failure> {
        let backend = sizes.first().map(|size| &size.backend);
        let radii = self.grains.iter().map(|grains| Ok(as_written(self.drum(*grains).drum_radius()?)));
        let radii = radii.collect::<Result<Vec<_>, Failure>>()?;
        let object = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "commit": option_env!("ROCKFALL_COMMIT"),
            "scene": "drum",
            "backend": backend.map(|info| info.kind.to_string()),
            "device": backend.map(|info| &info.device),
            "driver": backend.map(|info| &info.driver),
            "integrator": self.integrator.to_string(),
            "contact_law": "hertz-mindlin",
            "radius": as_written(self.radius),
            "drum_radii": radii,
            "facets": self.facets,
            "triangles": self.triangles,
            "rpm": self.rpm,
            "turn_every": self.turn_every,
            "dt": as_written(self.dt),
            "steps": self.steps,
            "warmup": self.warmup,
            "runs": self.runs,
            "seed": self.seed,
            "sizes": sizes.iter().map(sizes_as_json::size).collect::<Vec<_>>(),
        });
        Ok(format!("{object}\n"))
    }
}

pub(crate) fn bench(arguments: &Arguments) -> Result<(), Failure> {
    let sizes = arguments.grains.iter().map(|grains| arguments.measure(*grains)).collect::<Result<Vec<_>, _>>()?;
    output::print(&if arguments.json { arguments.object(&sizes)? } else { arguments.table(&sizes) })
}
