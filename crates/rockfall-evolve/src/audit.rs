//! A closer look at a creature that would become the champion. Evolution finds every error of a simulation that moves it forward:
//! an audit finds those that the rules of a trial do not exclude.

use rockfall::{Backend, Result, Simulation};
use serde::{Deserialize, Serialize};

use crate::genome::Genome;
use crate::goal::{Outcome, Verdict};
use crate::trial::Trial;

/// Share of the fitness that must remain at half the time step.
const KEPT: f64 = 0.7;
/// Energy that may appear from nowhere, as a share of the work that went into and came out of the muscles.
const TOLERANCE: f64 = 0.05;

/// What an audit found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Audit {
    /// Fitness at half the time step.
    pub fitness_at_half_step: f64,
    /// Work of the muscles, in mass units²/s².
    pub work: f64,
    /// Sum of the magnitudes of that work, step by step.
    pub throughput: f64,
    /// Energy gained, which dissipation makes less than the work. The greatest difference to the work counts.
    pub excess: f64,
    /// Whether the creature passes.
    pub passed: bool,
}

/// Audits a creature whose trial had this outcome: its fitness at half the time step, and its energy against the work of its
/// muscles, step by step.
///
/// # Errors
/// As for [`Simulation::with_options`].
pub fn audit(genome: &Genome, outcome: &Outcome, trial: &Trial) -> Result<Audit> {
    let mut finer = trial.clone();
    finer.dt = 0.5 * trial.dt;
    // The device and the CPU work at the same time.
    let (half, books) = rayon::join(|| finer.run(std::slice::from_ref(genome), &|| false), || keep_books(genome, trial));
    let half = half?.and_then(|found| found.first().copied());
    let fitness_at_half_step = half.filter(|half| half.verdict == Verdict::Valid).map_or(0.0, |half| half.fitness);
    let Books { work, throughput, excess } = books?;
    let passed = fitness_at_half_step >= KEPT * outcome.fitness && excess <= TOLERANCE * throughput;
    Ok(Audit { fitness_at_half_step, work, throughput, excess, passed })
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
}
