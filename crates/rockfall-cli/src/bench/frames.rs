//! `rockfall bench frames`: the time of frames of the contact law `rigid`, and how well they are solved.

use std::time::Instant;

use rockfall::generate::Benchmark;
use rockfall::{BackendInfo, ContactLaw, Scene, Simulation};
use serde_json::json;

use crate::bench::spread::Spread;
use crate::failure::Failure;
use crate::options::{Engine, Physics, whole};
use crate::output;

/// Measure frames of the contact law rigid, for bodies at rest or while they fall
///
/// Each size is run once: some frames first, then turns of timed frames. Overlaps are those of all contact points at the end, relative to
/// the least edge or diameter of a moving body.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene to measure: boxes, pile, lattice, settled, shuffled or radii
    #[arg(default_value_t = Benchmark::Boxes)]
    scene: Benchmark,
    /// Numbers of bodies, separated by commas; each is measured separately
    #[arg(long, value_name = "N", value_delimiter = ',', default_value = "1000,10000", value_parser = whole(1_u32, u32::MAX),
        allow_negative_numbers = true)]
    bodies: Vec<u32>,
    /// Frames before the timed ones
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    warmup: u64,
    /// Timed frames of a turn
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    frames: u64,
    /// Number of turns
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole(1, u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// Seed of the random numbers; the same seed gives the same scenes
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
    /// Print a JSON object for each size instead of the table
    #[arg(long)]
    json: bool,
}

struct Measured {
    bodies: u32,
    backend: BackendInfo,
    substeps: u32,
    /// Wall time of a frame, in s.
    seconds: Spread,
    /// From the finished scene to the end of the first frame, in s.
    first: f64,
    /// Frames that were repeated, before and in the timed ones.
    repeats: [u64; 2],
    contacts: usize,
    /// The 99th of 100 overlaps and the greatest one, relative to the least width.
    overlaps: [f64; 2],
    /// Bodies below everything that there was at the start.
    lost: usize,
}

pub(crate) fn bench(arguments: &Arguments) -> Result<(), Failure> {
    let mut sizes = Vec::new();
    for bodies in &arguments.bodies {
        output::note(&format!("{} {bodies}", arguments.scene));
        sizes.push(arguments.measure(*bodies)?);
    }
    let scene = arguments.scene;
    if arguments.json {
        return sizes.iter().try_for_each(|size| output::print(&format!("{}\n", size.json(scene))));
    }
    let device = sizes.first().map_or("", |size| &size.backend.device);
    let mut text = format!("rockfall bench frames {scene}: {device}\n\n");
    text +=
        "bodies    substeps  ms per frame (least, most)   repeats (before)   contacts  overlap p99, most   lost  first frame\n";
    sizes.iter().for_each(|size| text += &size.line());
    output::print(&text)
}

impl Arguments {
    fn measure(&self, bodies: u32) -> Result<Measured, Failure> {
        let mut scene = self.scene.generate(bodies, self.seed)?;
        scene.settings.set("contact_law", ContactLaw::Rigid.name())?;
        self.physics.change(&mut scene.settings)?;
        let dt = self.physics.dt_or(1.0 / 60.0);
        let bottom = bottom(&scene);
        let started = Instant::now();
        let mut simulation = Simulation::with_options(scene, self.engine.options(&self.physics))?;
        simulation.run(1, dt)?;
        let first = started.elapsed().as_secs_f64();
        simulation.run(self.warmup.saturating_sub(1), dt)?;
        let before = simulation.report().replays;
        let mut seconds = Vec::new();
        for _ in 0..self.runs {
            let started = Instant::now();
            simulation.run(self.frames, dt)?;
            seconds.push(started.elapsed().as_secs_f64() / self.frames as f64);
        }
        let during = simulation.report().replays - before;
        let contacts = simulation.contacts()?;
        let hard = simulation.scene().hard_contacts(dt)?;
        let width = f64::from(hard.width);
        let mut overlaps: Vec<f64> = contacts.iter().map(|contact| f64::from(contact.overlap) / width).collect();
        overlaps.sort_by(f64::total_cmp);
        let rank = |share: f64| overlaps.get((share * overlaps.len() as f64) as usize).or(overlaps.last()).copied();
        let spheres = simulation.sync()?.spheres();
        let lost = spheres.len() - spheres.iter().filter(|sphere| sphere.position.y >= bottom).count();
        Ok(Measured {
            bodies,
            backend: simulation.backend().clone(),
            substeps: simulation.substeps().unwrap_or_default(),
            seconds: Spread::of(seconds),
            first,
            repeats: [before, during],
            contacts: contacts.len(),
            overlaps: [rank(0.99).unwrap_or_default(), rank(1.0).unwrap_or_default()],
            lost,
        })
    }
}

/// The lowest point of all boxes, polygons and bodies.
fn bottom(scene: &Scene) -> f32 {
    let boxes = scene.boxes().iter().map(|cuboid| cuboid.edges.iter().fold(cuboid.corner.y, |low, edge| low + edge.y.min(0.0)));
    let polygons = scene.polygons().iter().map(|polygon| polygon.corner.y + polygon.left.y.min(0.0) + polygon.right.y.min(0.0));
    let spheres = scene.spheres().iter().map(|sphere| sphere.position.y - sphere.radius);
    boxes.chain(polygons).chain(spheres).fold(f32::INFINITY, f32::min)
}

impl Measured {
    fn line(&self) -> String {
        let [median, least, most] = [self.seconds.median, self.seconds.min, self.seconds.max].map(|seconds| 1e3 * seconds);
        let [before, during] = self.repeats;
        let [p99, deepest] = self.overlaps;
        let times = format!("{median:.3} ({least:.3}, {most:.3})");
        format!(
            "{:<10}{:<10}{times:<29}{:<19}{:<10}{:<20}{:<6}{:.2} s\n",
            self.bodies,
            self.substeps,
            format!("{during} ({before})"),
            self.contacts,
            format!("{p99:.4}, {deepest:.4}"),
            self.lost,
            self.first,
        )
    }

    fn json(&self, scene: Benchmark) -> String {
        let Spread { median, min, max, .. } = self.seconds;
        json!({
            "scene": scene.name(), "bodies": self.bodies, "device": self.backend.device,
            "commit": option_env!("ROCKFALL_COMMIT"), "substeps": self.substeps,
            "seconds_per_frame": { "median": median, "min": min, "max": max }, "first_frame_seconds": self.first,
            "repeats_before": self.repeats[0], "repeats": self.repeats[1], "contacts": self.contacts,
            "overlap_p99": self.overlaps[0], "overlap_most": self.overlaps[1], "lost": self.lost,
        })
        .to_string()
    }
}
