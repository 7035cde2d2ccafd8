//! `rockfall bench repeat`: runs scenes several times and compares the bits of their states and the schedules of their steps.

use std::fmt::Write as _;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::Path;

use rockfall::generate::{Benchmark, Kind};
use rockfall::{Scene, Simulation, SphereState};

use crate::failure::Failure;
use crate::options::{Engine, Physics, whole};
use crate::output;
use crate::source::Source;

/// Greatest number of spheres that the report of a difference names.
const NAMED: usize = 8;

/// Run scenes several times, and compare the bits of all states and the schedules of the steps
///
/// A schedule is the number of steps that were repeated, the number of times that lists were built, and their margin, length and room.
/// The exit code is 1 if two runs of a scene differ.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Scene files, scenes of `rockfall bench` and kinds of `rockfall generate` [default: all scenes and kinds]
    scenes: Vec<String>,
    /// Number of spheres of a generated scene (for the scenes mixed and boxes: number of bodies)
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = whole(1_u32, u32::MAX), allow_negative_numbers = true)]
    spheres: u32,
    /// Number of steps of a run
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    steps: u64,
    /// Compare after every so many steps [default: at the end alone]
    #[arg(long, value_name = "K", value_parser = whole(1, u64::MAX), allow_negative_numbers = true)]
    every: Option<u64>,
    /// Number of runs of each scene
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = whole(2, u32::MAX), allow_negative_numbers = true)]
    runs: u32,
    #[command(flatten)]
    physics: Physics,
    #[command(flatten)]
    engine: Engine,
    /// Seed of the random numbers; the same seed gives the same scenes
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = whole(0, u64::MAX), allow_negative_numbers = true)]
    seed: u64,
}

/// What two runs must have in common after some steps.
struct Mark {
    steps: u64,
    /// Hashes of everything that determines how the run continues, and of the schedule.
    state: u64,
    schedule: u64,
    /// Hash of each sphere.
    spheres: Vec<u32>,
}

pub(crate) fn bench(arguments: &Arguments) -> Result<(), Failure> {
    let mut text = String::new();
    let mut differs = false;
    let all = Benchmark::ALL.iter().map(ToString::to_string).chain(Kind::ALL.iter().map(|kind| format!("generate:{kind}")));
    let names = if arguments.scenes.is_empty() { all.collect() } else { arguments.scenes.clone() };
    for name in names {
        let scene = arguments.scene(&name)?;
        let first = arguments.run(&name, &scene, 1)?;
        let mut found = None;
        for run in 2..=arguments.runs {
            found = found.or(difference(&first, &arguments.run(&name, &scene, run)?).map(|what| (run, what)));
        }
        let last = first.last().map_or([0; 2], |mark| [mark.state, mark.schedule]);
        let _ = match &found {
            None => writeln!(text, "{name}: {} equal runs, state {:016x}, schedule {:016x}", arguments.runs, last[0], last[1]),
            Some((run, what)) => writeln!(text, "{name}: run {run} differs from run 1 {what}"),
        };
        differs |= found.is_some();
    }
    output::print(&text)?;
    if differs { Err(Failure::Run("runs of the same scene differ".to_owned())) } else { Ok(()) }
}

impl Arguments {
    fn scene(&self, name: &str) -> Result<Scene, Failure> {
        let mut scene = if let Ok(scene) = name.parse::<Benchmark>() {
            scene.generate(self.spheres, self.seed)?
        } else if let Ok(kind) = name.strip_prefix("generate:").unwrap_or(name).parse::<Kind>() {
            kind.generate(self.spheres, self.seed)?
        } else {
            Source::read(Some(Path::new(name)))?.loaded.scene
        };
        self.physics.change(&mut scene.settings)?;
        Ok(scene)
    }

    fn run(&self, name: &str, scene: &Scene, run: u32) -> Result<Vec<Mark>, Failure> {
        output::note(&format!("{name}: run {run} of {}", self.runs));
        let mut simulation = Simulation::with_options(scene.clone(), self.engine.options(&self.physics))?;
        let every = self.every.unwrap_or(self.steps);
        let mut marks = Vec::new();
        let mut done = 0;
        while done < self.steps {
            let steps = every.min(self.steps - done);
            simulation.run(steps, self.physics.part_for(scene))?;
            done += steps;
            let digest = simulation.checkpoint()?.digest();
            let spheres = simulation.spheres()?.iter().map(hash_of).collect();
            marks.push(Mark { steps: done, state: digest.state, schedule: digest.schedule, spheres });
        }
        Ok(marks)
    }
}

fn hash_of(sphere: &SphereState) -> u32 {
    let mut hasher = DefaultHasher::new();
    let vectors = [sphere.position, sphere.position_low, sphere.velocity, sphere.angular_momentum];
    vectors.iter().for_each(|vector| vector.to_array().map(f32::to_bits).hash(&mut hasher));
    sphere.orientation.to_array().map(f32::to_bits).hash(&mut hasher);
    hasher.finish() as u32
}

/// Says how two runs differ for the first time.
fn difference(first: &[Mark], other: &[Mark]) -> Option<String> {
    let (one, two) = first.iter().zip(other).find(|(one, two)| (one.state, one.schedule) != (two.state, two.schedule))?;
    let steps = one.steps;
    if one.state == two.state {
        return Some(format!("after {steps} steps in the schedule alone"));
    }
    let pairs = one.spheres.iter().zip(&two.spheres).enumerate();
    let spheres: Vec<usize> = pairs.filter(|(_, (one, two))| one != two).map(|(sphere, _)| sphere).collect();
    let named: Vec<String> = spheres.iter().take(NAMED).map(ToString::to_string).collect();
    Some(format!("after {steps} steps in {} spheres, by number from 0: {}", spheres.len(), named.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(states: [u64; 2], schedules: [u64; 2], spheres: [u32; 3]) -> Vec<Mark> {
        let mark =
            |k: usize| Mark { steps: 10 + k as u64, state: states[k], schedule: schedules[k], spheres: spheres.to_vec() };
        vec![mark(0), mark(1)]
    }

    #[test]
    fn the_first_difference_is_named() {
        let first = run([1, 2], [3, 4], [5, 6, 7]);
        assert_eq!(difference(&first, &run([1, 2], [3, 4], [5, 6, 7])), None);
        let schedule = difference(&first, &run([1, 2], [3, 5], [5, 6, 7])).expect("a difference");
        assert_eq!(schedule, "after 11 steps in the schedule alone");
        let state = difference(&first, &run([0, 2], [3, 4], [5, 0, 0])).expect("a difference");
        assert_eq!(state, "after 10 steps in 2 spheres, by number from 0: 1, 2");
    }
}
