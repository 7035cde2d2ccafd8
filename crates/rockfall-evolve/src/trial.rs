//! Lets creatures live side by side for some seconds, and judges what they did.

use rayon::prelude::*;
use rockfall::glam::{DVec2, DVec3};
use rockfall::{Integrator, Options, Result, SphereState, Worlds};
use serde::{Deserialize, Serialize};

use crate::genome::{Bond, Genome, RADIUS};
use crate::ground::Ground;

/// Time between two looks at the states, in s.
const SAMPLE: f64 = 0.1;
/// The share of the time, and the longest time in s, in which a creature comes to stand before anything counts.
const SETTLING: (f64, f64) = (0.2, 2.0);
/// A sphere that is faster, in units/s, has been thrown by numerical energy: muscles reach a tenth of it.
const MOST_SPEED: f64 = 20.0;
/// Springs may be this much shorter or longer than at rest. Muscles reach 0.75 and 1.25.
const STRAINS: std::ops::RangeInclusive<f64> = 0.3..=2.0;
/// Least share of the distance that a walker covers in the second half of the time. One fall or leap covers nothing there.
const STEADY: f64 = 0.3;

/// What creatures are selected for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Goal {
    /// Distance from start to end along the ground, in units.
    Distance,
    /// Mean speed along the ground in the second half of the time, in units/s.
    Speed,
    /// Mean height of the centre, in units.
    Height,
    /// Greatest height of the lowest sphere above the ground, in units.
    Jump,
    /// Height that the centre has gained at the end, in units.
    Climb,
}

impl Goal {
    /// All goals with their names.
    pub const ALL: [(Self, &str); 5] = [
        (Self::Distance, "distance"),
        (Self::Speed, "speed"),
        (Self::Height, "height"),
        (Self::Jump, "jump"),
        (Self::Climb, "climb"),
    ];

    /// Unit of the fitness.
    pub fn unit(self) -> &'static str {
        if self == Self::Speed { "units/s" } else { "units" }
    }

    fn walks(self) -> bool {
        matches!(self, Self::Distance | Self::Speed)
    }
}

impl std::str::FromStr for Goal {
    type Err = String;

    fn from_str(name: &str) -> std::result::Result<Self, String> {
        let found = Self::ALL.into_iter().find(|(_, known)| *known == name);
        found.map(|(goal, _)| goal).ok_or_else(|| "expected distance, speed, height, jump or climb".to_owned())
    }
}

impl std::fmt::Display for Goal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(Self::ALL.into_iter().find(|(goal, _)| goal == self).map_or("", |(_, name)| name))
    }
}

/// Whether the deeds of a creature count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Verdict {
    /// They count.
    Valid,
    /// A state stopped being finite.
    NotFinite,
    /// A sphere was faster, or a spring shorter or longer, than muscles can make it.
    Exploded,
    /// It fell or leapt once and did not walk on.
    Unsteady,
    /// It went downhill by more than its own length.
    Downhill,
}

/// What a creature did in a trial.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Whether it counts.
    pub verdict: Verdict,
    /// Fitness in the unit of the goal; 0 unless the outcome is valid.
    pub fitness: f64,
    /// Horizontal distance of the centre from where it was when the creature had settled, at the end, in units.
    pub distance: f64,
    /// Standard deviation of the height of the centre, as a share of its mean.
    pub bounce: f64,
}

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
}

/// What was seen of a creature so far.
#[derive(Clone, Debug, Default)]
struct Watch {
    /// Centre at each sample from the settling on.
    centres: Vec<DVec3>,
    /// Height of the lowest sphere's lowest point at each of these samples.
    clearances: Vec<f64>,
    exploded: bool,
}

impl Trial {
    /// A trial with the integrator that `rockfall run` uses.
    pub fn new(goal: Goal, seconds: f64, dt: f32, ground: Ground) -> Self {
        Self { goal, seconds, dt, ground, options: Options::new().integrator(Integrator::Rk4) }
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

    /// Runs creatures side by side. Returns an outcome for each, or `None` if `should_stop` returned `true`.
    ///
    /// # Errors
    /// As for [`Worlds::new`].
    pub fn run(&self, genomes: &[Genome], should_stop: &dyn Fn() -> bool) -> Result<Option<Vec<Outcome>>> {
        let scenes: Vec<_> = genomes.par_iter().map(|genome| genome.scene(&self.ground)).collect::<Result<_>>()?;
        let mut worlds = Worlds::new(scenes, self.options.clone())?;
        let bonds: Vec<Vec<Bond>> = genomes.par_iter().map(Genome::bonds).collect();
        let mut watches = vec![Watch::default(); genomes.len()];
        let (settled, last) = (self.settling_steps(), self.steps());
        let sample = (SAMPLE / f64::from(self.dt)).round().max(1.0) as u64;
        let mut done = 0;
        while done < last {
            // A sample falls on the end of the settling and on the last step.
            let next = if done < settled { settled.min(done + sample) } else { last.min(done + sample) };
            worlds.run(next - done, self.dt)?;
            done = next;
            let states = worlds.all_states()?;
            let seen = watches.par_iter_mut().zip(&bonds).zip(&states);
            seen.for_each(|((watch, bonds), states)| watch.look(bonds, states, done >= settled));
            if should_stop() {
                return Ok(None);
            }
        }
        let mut outcomes = Vec::with_capacity(genomes.len());
        for (world, (watch, genome)) in watches.iter().zip(genomes).enumerate() {
            let stopped = worlds.report(world, None)?.stopped.is_some();
            outcomes.push(watch.judge(self, genome, stopped));
        }
        Ok(Some(outcomes))
    }
}

impl Watch {
    fn look(&mut self, bonds: &[Bond], states: &[SphereState], has_settled: bool) {
        let places: Vec<DVec3> = states.iter().map(|state| state.position.as_dvec3()).collect();
        let centre = places.iter().sum::<DVec3>() / places.len() as f64;
        let fast = states.iter().any(|state| state.velocity.as_dvec3().length() > MOST_SPEED);
        let strained = bonds.iter().any(|bond| {
            let [a, b] = bond.ends;
            !STRAINS.contains(&(places[a].distance(places[b]) / f64::from(bond.length)))
        });
        self.exploded |= fast || strained || !centre.is_finite();
        if has_settled {
            let lowest = places.iter().map(|place| place.y).fold(f64::INFINITY, f64::min);
            self.centres.push(centre);
            self.clearances.push(lowest - f64::from(RADIUS));
        }
    }

    fn judge(&self, trial: &Trial, genome: &Genome, stopped: bool) -> Outcome {
        let none = |verdict| Outcome { verdict, fitness: 0.0, distance: 0.0, bounce: 0.0 };
        if stopped {
            return none(Verdict::NotFinite);
        }
        let (Some(first), Some(last)) = (self.centres.first(), self.centres.last()) else { return none(Verdict::NotFinite) };
        if self.exploded {
            return none(Verdict::Exploded);
        }
        let flat = |from: &DVec3, to: &DVec3| DVec2::new(to.x - from.x, to.z - from.z);
        let way = flat(first, last);
        let (distance, middle) = (way.length(), &self.centres[self.centres.len() / 2]);
        let late = flat(middle, last).dot(way.normalize_or_zero());
        let heights = || self.centres.iter().map(|centre| centre.y);
        let mean = heights().sum::<f64>() / self.centres.len() as f64;
        let variance = heights().map(|height| (height - mean).powi(2)).sum::<f64>() / self.centres.len() as f64;
        let bounce = variance.sqrt() / mean.abs().max(1e-9);
        let time = trial.seconds - trial.settling_steps() as f64 * f64::from(trial.dt);
        let (verdict, fitness) = match trial.goal {
            goal if goal.walks() && late < STEADY * distance => (Verdict::Unsteady, 0.0),
            goal if goal.walks() && first.y - last.y > f64::from(genome.length()) => (Verdict::Downhill, 0.0),
            Goal::Distance => (Verdict::Valid, distance),
            Goal::Speed => (Verdict::Valid, late / (0.5 * time)),
            Goal::Height => (Verdict::Valid, mean),
            Goal::Jump => (Verdict::Valid, self.clearances.iter().copied().fold(0.0, f64::max)),
            Goal::Climb => (Verdict::Valid, (last.y - first.y).max(0.0)),
        };
        Outcome { verdict, fitness, distance, bounce }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::genome::{Body, Node, SPACING};
    use rockfall::Backend;

    fn cube(amplitude: f32) -> Genome {
        let node = |k: u8| Node {
            position: [k & 1, k >> 1 & 1, k >> 2].map(|side| f32::from(side) * SPACING),
            amplitude,
            phase: 0.125 * f32::from(k),
        };
        Genome { body: Body::Lattice, nodes: (0..8).map(node).collect(), frequency: 2.0, stiffness: 1500.0 }
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

    fn watch(centres: impl IntoIterator<Item = [f64; 3]>) -> Watch {
        let centres: Vec<_> = centres.into_iter().map(DVec3::from_array).collect();
        Watch { clearances: vec![0.0; centres.len()], centres, exploded: false }
    }

    #[test]
    fn one_fall_is_no_walk_and_going_downhill_neither() {
        let judge = |watch: &Watch, goal| watch.judge(&trial(goal), &cube(0.1), false);
        let walks = watch((0..30).map(|k| [0.1 * f64::from(k), 0.4, 0.0]));
        assert_eq!(judge(&walks, Goal::Distance).verdict, Verdict::Valid);
        assert!((judge(&walks, Goal::Distance).fitness - 2.9).abs() < 1e-9);
        let falls = watch((0..30).map(|k| [f64::from(k).min(3.0), 0.4, 0.0]));
        assert_eq!(judge(&falls, Goal::Speed).verdict, Verdict::Unsteady);
        let slides = watch((0..30).map(|k| [f64::from(k), -f64::from(k), 0.0]));
        assert_eq!(judge(&slides, Goal::Distance).verdict, Verdict::Downhill);
        let exploded = Watch { exploded: true, ..walks.clone() };
        assert_eq!(judge(&exploded, Goal::Height).verdict, Verdict::Exploded);
        assert_eq!(walks.judge(&trial(Goal::Distance), &cube(0.1), true).verdict, Verdict::NotFinite);
        let climbs = watch((0..30).map(|k| [0.0, 0.1 * f64::from(k), 0.0]));
        assert!((judge(&climbs, Goal::Climb).fitness - 2.9).abs() < 1e-9);
    }

    #[test]
    fn a_torn_or_fast_creature_has_exploded() {
        let genome = cube(0.1);
        let scene = genome.scene(&Ground::level(10.0).unwrap()).unwrap();
        let states: Vec<SphereState> = scene.spheres().iter().map(SphereState::from).collect();
        let look = |change: &dyn Fn(&mut SphereState)| {
            let mut changed = states.clone();
            change(&mut changed[3]);
            let mut watch = Watch::default();
            watch.look(&genome.bonds(), &changed, true);
            watch.exploded
        };
        assert!(!look(&|_| {}));
        assert!(look(&|state| state.velocity.x = 21.0));
        assert!(look(&|state| state.position.x += 2.0));
        assert!(look(&|state| state.position.x = f32::NAN));
    }
}
