//! `rockfall bench worlds`: measures many small worlds side by side.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use rockfall::generate::{creature, creature_without_pairs};
use rockfall::{BackendInfo, Integrator, Scene, Simulation, WorldPath, Worlds};
use serde_json::json;

use crate::bench::spread::Spread;
use crate::failure::Failure;
use crate::options::{Engine, as_written, time_step, whole};
use crate::output;

/// Worlds that are also run one by one, each in a simulation of its own, for comparison.
const ONE_BY_ONE: u32 = 16;

/// Measure many creatures with muscles, each in a world of its own
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Numbers of worlds, separated by commas; each is measured separately
    #[arg(long, visible_alias = "creatures", value_name = "N", value_delimiter = ',', default_value = "1024,10240",
        value_parser = whole(1_u32, 1_000_000), allow_negative_numbers = true)]
    worlds: Vec<u32>,
    /// Copies of the scene of a file in place of creatures, in steps of its own
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Number of spheres of a creature, which has three springs per sphere
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = whole(1_u32, 10_000), allow_negative_numbers = true)]
    spheres: u32,
    /// What the spheres of a creature may touch: each other and the ground (all), or the ground alone
    #[arg(long, value_name = "WHAT", value_enum, default_value_t = Contacts::All)]
    contacts: Contacts,
    /// Number of timed steps in each run
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    steps: u64,
    /// Number of runs of each size; their median is reported
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    /// Time step in seconds
    #[arg(long, value_name = "S", default_value = "0.005", value_parser = time_step, allow_negative_numbers = true)]
    dt: f32,
    /// Integrator: rk4, symplectic-euler or velocity-verlet
    #[arg(long, default_value_t)]
    integrator: Integrator,
    /// Read all states and set the rest lengths of all springs after every so many steps, as a program does that controls creatures
    #[arg(long, value_name = "N", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    control_every: Option<u64>,
    /// Handle collisions as impulses, as in other scenes; creatures have contact forces alone
    #[arg(long)]
    collisions: bool,
    #[command(flatten)]
    engine: Engine,
    /// Seed of the random numbers; world n has the creature of seed S + n
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// What the spheres of a creature may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Contacts {
    All,
    Ground,
}

/// Measurements of a number of worlds.
struct Measured {
    worlds: u32,
    path: WorldPath,
    /// World-steps per second.
    speed: Spread,
    /// The same for simulations that run one by one.
    one_by_one: f64,
    stopped: usize,
}

impl Arguments {
    fn scene(&self, world: u32) -> Result<Scene, rockfall::Error> {
        if let Some(path) = &self.scene {
            return Scene::load(path).map(|loaded| loaded.scene);
        }
        let generate = if self.contacts == Contacts::Ground { creature_without_pairs } else { creature };
        let mut scene = generate(self.spheres, self.seed.wrapping_add(world.into()))?;
        scene.settings.collisions |= self.collisions;
        Ok(scene)
    }

    fn measure(&self, count: u32) -> Result<(Measured, BackendInfo), Failure> {
        let options = self.engine.with_integrator(self.integrator);
        let first = self.scene(0)?;
        let dt = self.dt_of(&first);
        let scenes = match self.scene {
            Some(_) => vec![first; count as usize],
            None => (0..count).map(|world| self.scene(world)).collect::<Result<Vec<_>, _>>()?,
        };
        let mut worlds = Worlds::new(scenes, options.clone())?;
        // The first steps compile kernels and build lists.
        worlds.run(20, dt)?;
        let mut seconds = Vec::new();
        for run in 1..=self.runs {
            output::note(&format!("{count} worlds: run {run} of {}", self.runs));
            let start = Instant::now();
            self.run(&mut worlds, dt)?;
            seconds.push(start.elapsed().as_secs_f64());
        }
        let reports = (0..worlds.len()).map(|world| worlds.report(world, None)).collect::<Result<Vec<_>, _>>()?;
        let few = count.min(ONE_BY_ONE);
        let mut simulations = Vec::new();
        for world in 0..few {
            let mut simulation = Simulation::with_options(self.scene(world)?, options.clone())?;
            simulation.run(20, dt)?;
            simulations.push(simulation);
        }
        let steps = self.steps.min(200);
        let start = Instant::now();
        for simulation in &mut simulations {
            simulation.run(steps, dt)?;
        }
        let measured = Measured {
            worlds: count,
            path: reports[0].path,
            speed: Spread::of(seconds).inverse(f64::from(count) * self.steps as f64),
            one_by_one: f64::from(few) * steps as f64 / start.elapsed().as_secs_f64(),
            stopped: reports.iter().filter(|report| report.stopped.is_some()).count(),
        };
        Ok((measured, worlds.backend().clone()))
    }

    /// The time step: that of the scene of a file, if it has one.
    fn dt_of(&self, scene: &Scene) -> f32 {
        self.scene.as_ref().and_then(|_| scene.time_step()).unwrap_or(self.dt)
    }

    /// Runs the steps, and waits for the device.
    fn run(&self, worlds: &mut Worlds, dt: f32) -> Result<(), rockfall::Error> {
        let Some(every) = self.control_every else {
            worlds.run(self.steps, dt)?;
            // Reading a state waits for the device.
            return worlds.states(0).map(drop);
        };
        let mut lengths = Vec::new();
        for world in 0..worlds.len() {
            lengths.extend(worlds.scene(world)?.springs().iter().map(|spring| spring.length));
        }
        let mut left = self.steps;
        while left > 0 {
            let portion = left.min(every);
            worlds.run(portion, dt)?;
            worlds.sample(|sample| sample.all_states())?;
            worlds.set_all_rest_lengths(&lengths)?;
            left -= portion;
        }
        Ok(())
    }

    fn title(&self, backend: &BackendInfo) -> String {
        if let Some(path) = &self.scene {
            let dt = self.scene(0).map_or(self.dt, |scene| self.dt_of(&scene));
            return format!(
                "rockfall bench worlds, {}: {}\n{} steps of {dt} s, median (minimum to maximum) of {} runs\n",
                path.display(),
                backend.device,
                self.steps,
                self.runs
            );
        }
        let how = if self.collisions { "collisions and contact forces" } else { "contact forces" };
        let what = if self.contacts == Contacts::Ground { " with the ground alone" } else { "" };
        let control =
            self.control_every.map_or(String::new(), |every| format!(", states read and springs set every {every} steps"));
        format!(
            "rockfall bench worlds, {} spheres and {} springs with muscles each, ground with friction, {how}{what}, {}{control}: {}\n\
             {} steps of {} s, median (minimum to maximum) of {} runs\n",
            self.spheres,
            self.scene(0).map_or(0, |scene| scene.counts().springs),
            self.integrator,
            backend.device,
            self.steps,
            self.dt,
            self.runs
        )
    }

    fn table(&self, sizes: &[Measured], backend: &BackendInfo) -> String {
        let mut text = self.title(backend);
        // Writing to a string cannot fail.
        let _ =
            writeln!(text, "\n{:>8} {:>12} {:>40} {:>18} {:>8}", "worlds", "path", "world-steps/s", "one by one", "stopped");
        for size in sizes {
            let Spread { median, min, max } = size.speed;
            let speed = format!("{median:.4e} ({min:.4e} to {max:.4e})");
            let path = path_name(size.path);
            let _ = writeln!(text, "{:>8} {path:>12} {speed:>40} {:>18.4e} {:>8}", size.worlds, size.one_by_one, size.stopped);
        }
        text
    }

    fn object(&self, sizes: &[Measured], backend: &BackendInfo) -> String {
        let size = |size: &Measured| {
            json!({
                "worlds": size.worlds,
                "path": path_name(size.path),
                "world_steps_per_second": size.speed.json(),
                "one_by_one_world_steps_per_second": size.one_by_one,
                "stopped": size.stopped,
            })
        };
        let object = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "scene": self.scene.as_ref().map_or("worlds".to_owned(), |path| path.display().to_string()),
            "backend": backend.kind.to_string(),
            "device": backend.device,
            "driver": backend.driver,
            "spheres": self.spheres,
            "integrator": self.integrator.to_string(),
            "collisions": self.collisions,
            "contacts": if self.contacts == Contacts::Ground { "ground" } else { "all" },
            "dt": as_written(self.dt),
            "steps": self.steps,
            "control_every": self.control_every,
            "runs": self.runs,
            "seed": self.seed,
            "sizes": sizes.iter().map(size).collect::<Vec<_>>(),
        });
        format!("{object}\n")
    }
}

fn path_name(path: WorldPath) -> &'static str {
    match path {
        WorldPath::Simulation => "simulation",
        WorldPath::Joined => "shared frames",
        _ => "device",
    }
}

pub(crate) fn bench(arguments: &Arguments) -> Result<(), Failure> {
    let mut sizes = Vec::new();
    let mut backend = None;
    for count in &arguments.worlds {
        let (measured, info) = arguments.measure(*count)?;
        sizes.push(measured);
        backend = Some(info);
    }
    let Some(backend) = backend else { return Ok(()) };
    let text = if arguments.json { arguments.object(&sizes, &backend) } else { arguments.table(&sizes, &backend) };
    output::print(&text)
}
