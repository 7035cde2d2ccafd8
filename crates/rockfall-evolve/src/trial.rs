//! Lets creatures live side by side for some seconds, and judges what they did.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};

use rayon::prelude::*;
use rockfall::{Integrator, Options, Result, Scene, Worlds};

use crate::genome::{Bond, Genome};
use crate::goal::{Goal, Outcome};
use crate::ground::Ground;
use crate::watch::{Conditions, Watch};

/// Time between two looks at the states, in s.
const SAMPLE: f64 = 0.1;
/// The share of the time, and the longest time in s, in which a creature comes to stand before anything counts.
const SETTLING: (f64, f64) = (0.2, 2.0);

/// The conditions of a trial.
#[derive(Clone, Debug)]
pub struct Trial {
    /// What counts.
    pub goal: Goal,
    /// Time of the trial, in s.
    pub seconds: f64,
    /// Time step, in s.
    pub dt: f32,
    /// What creatures walk on.
    pub ground: Ground,
    /// Backend and integrator.
    pub options: Options,
    /// The worlds of the last run, and their options. Opening a GPU and compiling a kernel takes longer than a trial, so the next run of
    /// this trial, or of a clone, replaces these worlds.
    worlds: Arc<Mutex<Option<(Options, Worlds)>>>,
}

impl Trial {
    /// A trial with the integrator that `rockfall run` uses.
    pub fn new(goal: Goal, seconds: f64, dt: f32, ground: Ground) -> Self {
        Self { goal, seconds, dt, ground, options: Options::new().integrator(Integrator::Rk4), worlds: Arc::default() }
    }

    /// Number of steps of the trial.
    pub fn steps(&self) -> u64 {
        (self.seconds / f64::from(self.dt)).round().max(1.0) as u64
    }

    /// Number of steps in which creatures come to stand before anything counts.
    pub fn settling_steps(&self) -> u64 {
        let time = (SETTLING.0 * self.seconds).min(SETTLING.1);
        ((time / f64::from(self.dt)).round() as u64).min(self.steps() - 1)
    }

    fn conditions(&self) -> Conditions<'_> {
        let time = self.seconds - self.settling_steps() as f64 * f64::from(self.dt);
        Conditions { goal: self.goal, ground: &self.ground, time }
    }

    /// Runs creatures side by side. Returns an outcome for each, or `None` if `should_stop` returned `true`.
    ///
    /// # Errors
    /// As for [`Worlds::new`].
    pub fn run(&self, genomes: &[Genome], should_stop: &dyn Fn() -> bool) -> Result<Option<Vec<Outcome>>> {
        let scenes = genomes.par_iter().map(|genome| genome.scene(&self.ground)).collect::<Result<_>>()?;
        self.run_scenes(genomes, scenes, should_stop)
    }

    /// As [`Trial::run`], from the starts in these scenes: one for each creature.
    pub(crate) fn run_scenes(
        &self,
        genomes: &[Genome],
        scenes: Vec<Scene>,
        should_stop: &dyn Fn() -> bool,
    ) -> Result<Option<Vec<Outcome>>> {
        let mut worlds = self.open(scenes)?;
        let bonds: Vec<Vec<Bond>> = genomes.par_iter().map(Genome::bonds).collect();
        let mut watches = vec![Watch::default(); genomes.len()];
        let (settled, last) = (self.settling_steps(), self.steps());
        let sample = (SAMPLE / f64::from(self.dt)).round().max(1.0) as u64;
        let conditions = self.conditions();
        let mut has_stopped = false;
        // A sample falls on the end of the settling and on the last step.
        for (steps, after) in [(settled, 0), (last - settled, settled)] {
            worlds.run_sampled(steps, self.dt, sample, |seen| {
                let has_settled = after + seen.steps() >= settled;
                let each = watches.par_iter_mut().zip(&bonds).enumerate();
                each.for_each(|(world, (watch, bonds))| watch.look(&conditions, bonds, &seen.states(world), has_settled));
                has_stopped = should_stop();
                if has_stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })?;
            if has_stopped {
                self.keep(worlds);
                return Ok(None);
            }
        }
        let mut outcomes = Vec::with_capacity(genomes.len());
        for (world, (watch, genome)) in watches.iter().zip(genomes).enumerate() {
            let stopped = worlds.report(world, None)?.stopped.is_some();
            outcomes.push(watch.judge(&conditions, genome, stopped));
        }
        self.keep(worlds);
        Ok(Some(outcomes))
    }

    /// Worlds for these scenes: new ones, or those of the last run with other scenes.
    fn open(&self, scenes: Vec<Scene>) -> Result<Worlds> {
        let kept = self.worlds.lock().unwrap_or_else(PoisonError::into_inner).take();
        match kept.filter(|(options, _)| *options == self.options) {
            Some((_, mut worlds)) => {
                worlds.replace_all(scenes)?;
                Ok(worlds)
            }
            None => Worlds::new(scenes, self.options.clone()),
        }
    }

    fn keep(&self, worlds: Worlds) {
        *self.worlds.lock().unwrap_or_else(PoisonError::into_inner) = Some((self.options.clone(), worlds));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::genome::tests::cube_with;
    use crate::genome::{RADIUS, SPACING};
    use rockfall::Backend;

    fn cube(amplitude: f32) -> Genome {
        cube_with(amplitude)
    }

    fn trial(goal: Goal) -> Trial {
        let mut trial = Trial::new(goal, 3.0, 0.005, Ground::level(10.0).unwrap());
        trial.options = trial.options.backend(Backend::Cpu);
        trial
    }

    #[test]
    fn a_creature_without_muscles_goes_nowhere() {
        let outcome = trial(Goal::Distance).run(&[cube(0.0)], &|| false).unwrap().unwrap()[0];
        assert!(outcome.distance < 1e-3 && outcome.fitness < 1e-3 && outcome.bounce < 1e-3, "{outcome:?}");
        let height = trial(Goal::Height).run(&[cube(0.0)], &|| false).unwrap().unwrap()[0];
        let middle = f64::from(0.5 * SPACING + RADIUS);
        assert!((height.fitness - middle).abs() < 0.02, "{height:?}");
    }

    #[test]
    fn outcomes_do_not_depend_on_the_company() {
        let genomes = [cube(0.2), cube(0.05), cube(0.1)];
        let together = trial(Goal::Distance).run(&genomes, &|| false).unwrap().unwrap();
        for (genome, outcome) in genomes.into_iter().zip(&together) {
            assert_eq!(trial(Goal::Distance).run(&[genome], &|| false).unwrap().unwrap(), [*outcome]);
        }
        assert_eq!(trial(Goal::Distance).run(&[cube(0.1)], &|| true).unwrap(), None);
    }

    /// A trial keeps its worlds for the next run. What ran before makes no difference, also with other options.
    #[test]
    fn outcomes_do_not_depend_on_the_run_before() {
        let genomes = [cube(0.2), cube(0.05), cube(0.1)];
        let mut again = trial(Goal::Distance);
        let first = again.run(&genomes, &|| false).unwrap().unwrap();
        assert_eq!(again.run(&genomes[1..2], &|| false).unwrap().unwrap(), first[1..2]);
        assert_eq!(again.clone().run(&genomes, &|| false).unwrap().unwrap(), first);
        again.options = again.options.integrator(Integrator::SymplecticEuler);
        let mut other = trial(Goal::Distance);
        other.options = again.options.clone();
        let euler = again.run(&genomes, &|| false).unwrap().unwrap();
        assert_eq!(euler, other.run(&genomes, &|| false).unwrap().unwrap());
        assert_ne!(euler, first);
    }
}
