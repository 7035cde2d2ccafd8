//! A closer look at a creature that would become the champion. Evolution finds every error of a simulation that moves it forward:
//! an audit finds those that the rules of a trial do not exclude.

use rockfall::{Backend, Result, Simulation};
use serde::{Deserialize, Serialize};

use crate::genome::Genome;
use crate::goal::{Outcome, Verdict};
use crate::trial::Trial;

/// Share of the fitness that must remain at half and at a quarter of the time step, and with each disturbed start.
const KEPT: f64 = 0.7;
/// Number of disturbed starts.
const DISTURBED_STARTS: u64 = 4;
/// Energy that may appear from nowhere, as a share of the work that went into and came out of the muscles.
const TOLERANCE: f64 = 0.05;

/// What an audit found. Each fitness is in the unit of the goal ([`Goal::unit`](crate::Goal::unit)). It is 0 if the creature does not
/// count under these conditions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Audit {
    /// Fitness at half the time step.
    pub fitness_at_half_step: f64,
    /// Fitness at a quarter of the time step.
    pub fitness_at_quarter_step: f64,
    /// Least fitness of four disturbed starts at the time step of the trial. In a disturbed start, each sphere is up to 0.0001 units
    /// from its place along each axis, and not lower.
    pub fitness_when_disturbed: f64,
    /// Work of the muscles, in mass units²/s².
    pub work: f64,
    /// Sum of the magnitudes of that work, step by step.
    pub throughput: f64,
    /// Energy gained, which dissipation makes less than the work. The greatest difference to the work counts.
    pub excess: f64,
    /// Whether the creature passes.
    pub passed: bool,
}

/// Audits a creature whose trial had this outcome: its fitness at smaller time steps and with disturbed starts, and its energy against
/// the work of its muscles, step by step.
///
/// The variants that cost least run first. If the creature fails there, the audit ends: `fitness_at_quarter_step`, `work`,
/// `throughput` and `excess` are 0 then.
///
/// # Errors
/// As for [`Simulation::with_options`] and [`Trial::run`].
pub fn audit(genome: &Genome, outcome: &Outcome, trial: &Trial) -> Result<Audit> {
    let keeps = |fitness: f64| fitness >= KEPT * outcome.fitness;
    let fitness_when_disturbed = fitness_when_disturbed(genome, trial)?;
    let fitness_at_half_step = fitness_at_step(genome, trial, 0.5 * trial.dt)?;
    let mut found = Audit { fitness_at_half_step, fitness_when_disturbed, ..Audit::default() };
    if keeps(fitness_when_disturbed) && keeps(fitness_at_half_step) {
        // The device and the CPU work at the same time.
        let quarter = || fitness_at_step(genome, trial, 0.25 * trial.dt);
        let (quarter, books) = rayon::join(quarter, || keep_books(genome, trial));
        found.fitness_at_quarter_step = quarter?;
        Books { work: found.work, throughput: found.throughput, excess: found.excess } = books?;
        found.passed = keeps(found.fitness_at_quarter_step) && found.excess <= TOLERANCE * found.throughput;
    }
    Ok(found)
}

/// The disturbed starts have the same time step, so they run side by side.
fn fitness_when_disturbed(genome: &Genome, trial: &Trial) -> Result<f64> {
    let scenes: Vec<_> =
        (1..=DISTURBED_STARTS).map(|seed| genome.disturbed_scene(&trial.ground, seed)).collect::<Result<_>>()?;
    let outcomes = trial.run_scenes(&vec![genome.clone(); scenes.len()], scenes, &|| false)?.unwrap_or_default();
    Ok(outcomes.iter().map(counting).reduce(f64::min).unwrap_or(0.0))
}

fn fitness_at_step(genome: &Genome, trial: &Trial, dt: f32) -> Result<f64> {
    let mut finer = trial.clone();
    finer.dt = dt;
    let outcomes = finer.run(std::slice::from_ref(genome), &|| false)?;
    Ok(outcomes.and_then(|found| found.first().map(counting)).unwrap_or(0.0))
}

/// The fitness, or 0 if the creature does not count.
fn counting(outcome: &Outcome) -> f64 {
    if outcome.verdict == Verdict::Valid { outcome.fitness } else { 0.0 }
}

struct Books {
    work: f64,
    throughput: f64,
    excess: f64,
}

/// Runs a creature alone, and compares its energy with the work of its muscles after each step. It runs on the CPU, because reading
/// every state back from a GPU takes a hundred times as long as the step.
fn keep_books(genome: &Genome, trial: &Trial) -> Result<Books> {
    let options = trial.options.clone().backend(Backend::Cpu);
    let mut simulation = Simulation::with_options(genome.scene(&trial.ground)?, options)?;
    let mut books = Books { work: 0.0, throughput: 0.0, excess: 0.0 };
    simulation.set_time_step(trial.dt)?;
    let start = simulation.energy()?.total();
    let mut before = tensions(&mut simulation)?;
    for _ in 0..trial.steps() {
        if simulation.run(1, trial.dt).is_err() {
            return Ok(Books { excess: f64::INFINITY, ..books });
        }
        let after = tensions(&mut simulation)?;
        for ((force, length), (next_force, next_length)) in before.iter().zip(&after) {
            // The power of a muscle is minus its tension times the rate of its rest length.
            let work = -0.5 * (force + next_force) * (next_length - length);
            books.work += work;
            books.throughput += work.abs();
        }
        before = after;
        books.excess = books.excess.max(simulation.energy()?.total() - start - books.work);
    }
    Ok(books)
}

/// Present tension and rest length of each spring.
fn tensions(simulation: &mut Simulation) -> Result<Vec<(f64, f64)>> {
    simulation.sync()?;
    let scene = simulation.scene();
    let tension = |id| {
        let (spring, length) = (scene.spring(id)?, simulation.rest_length(id)?);
        let [a, b] = [scene.sphere(spring.a)?, scene.sphere(spring.b)?].map(|end| end.position.as_dvec3());
        Ok((f64::from(spring.stiffness) * (a.distance(b) - length), length))
    };
    scene.spring_ids().map(tension).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::genome::{Body, Node, SPACING};
    use crate::goal::Goal;
    use crate::ground::Ground;
    use rand::SeedableRng as _;
    use rand_pcg::Pcg64;
    use rayon::prelude::*;

    fn beam(stiffness: f32) -> Genome {
        let node = |k: u8| Node {
            position: [k & 1, k >> 1 & 1, k >> 2].map(|side| f32::from(side) * SPACING),
            amplitude: 0.15,
            phase: 0.2 * f32::from(k & 1),
        };
        Genome { body: Body::Lattice, nodes: (0..8).map(node).collect(), frequency: 1.5, stiffness }
    }

    fn trial(dt: f32) -> Trial {
        let mut trial = Trial::new(Goal::Height, 2.0, dt, Ground::level(10.0).unwrap());
        trial.options = trial.options.backend(Backend::Cpu);
        trial
    }

    /// Dissipation takes what the muscles give, and no energy comes from elsewhere.
    #[test]
    fn an_honest_creature_passes() {
        let (genome, trial) = (beam(1500.0), trial(0.005));
        let outcome = trial.run(std::slice::from_ref(&genome), &|| false).unwrap().unwrap()[0];
        let audit = audit(&genome, &outcome, &trial).unwrap();
        assert!(audit.passed, "{audit:?}");
        assert!(audit.throughput > 1.0 && audit.work > 0.0, "{audit:?}");
    }

    /// A time step above the stability bound of the springs makes energy.
    #[test]
    fn numerical_energy_does_not_pass() {
        let books = keep_books(&beam(3000.0), &trial(0.05)).unwrap();
        assert!(books.excess > TOLERANCE * books.throughput, "{} of {}", books.excess, books.throughput);
    }

    #[test]
    fn a_fitness_that_half_the_time_step_does_not_confirm_does_not_pass() {
        let (genome, trial) = (beam(1500.0), trial(0.005));
        let outcome = trial.run(std::slice::from_ref(&genome), &|| false).unwrap().unwrap()[0];
        let boast = Outcome { fitness: 2.0 * outcome.fitness, ..outcome };
        assert!(!audit(&genome, &boast, &trial).unwrap().passed);
    }

    /// The audits of random creatures that walk, with their fitness.
    fn audits_of_walkers() -> Vec<(f64, Audit)> {
        let mut trial = trial(0.005);
        (trial.goal, trial.seconds) = (Goal::Distance, 4.0);
        let walker = |seed| {
            let genome = Genome::random(&mut Pcg64::seed_from_u64(seed), Body::Lattice);
            let outcome = trial.run(std::slice::from_ref(&genome), &|| false).unwrap().unwrap()[0];
            (outcome.fitness > 0.2).then(|| (outcome.fitness, audit(&genome, &outcome, &trial).unwrap()))
        };
        (0..60).into_par_iter().filter_map(walker).collect()
    }

    /// Half the time step confirms some creatures that the exact start or a quarter of the time step makes walk.
    #[test]
    fn disturbed_starts_and_a_quarter_of_the_time_step_find_more() {
        let audits = audits_of_walkers();
        let keeps = |fitness: f64, other: f64| other >= KEPT * fitness;
        let confirmed = audits.iter().filter(|(fitness, found)| keeps(*fitness, found.fitness_at_half_step));
        let (steady, sensitive): (Vec<_>, Vec<_>) =
            confirmed.partition(|(fitness, found)| keeps(*fitness, found.fitness_when_disturbed));
        assert!(!sensitive.is_empty() && sensitive.iter().all(|(_, found)| !found.passed), "{sensitive:?}");
        let (converged, others): (Vec<_>, Vec<_>) =
            steady.into_iter().partition(|(fitness, found)| keeps(*fitness, found.fitness_at_quarter_step));
        assert!(!others.is_empty() && others.iter().all(|(_, found)| !found.passed), "{others:?}");
        assert!(!converged.is_empty() && converged.iter().all(|(_, found)| found.passed), "{converged:?}");
    }

    #[test]
    fn the_disturbed_start_that_does_worst_counts() {
        let mut trial = trial(0.005);
        trial.goal = Goal::Distance;
        let genome = beam(1500.0);
        let fitness = |seed| {
            let scene = genome.disturbed_scene(&trial.ground, seed).unwrap();
            trial.run_scenes(std::slice::from_ref(&genome), vec![scene], &|| false).unwrap().unwrap()[0].fitness
        };
        let each: Vec<f64> = (1..=DISTURBED_STARTS).map(fitness).collect();
        let least = each.iter().copied().fold(f64::INFINITY, f64::min);
        assert_eq!(fitness_when_disturbed(&genome, &trial).unwrap(), least);
        assert!(each.iter().any(|found| *found > least), "{each:?}");
    }
}
