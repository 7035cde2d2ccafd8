//! The evolution itself: generation after generation.

use rand::RngExt as _;
use rand_pcg::Pcg64;
use rockfall::{Backend, Error, Integrator, Options, Result, Scene};
use serde::{Deserialize, Serialize};

use crate::archive::{Archive, Elite, Niche};
use crate::audit::{Audit, audit};
use crate::genome::{Body, Genome};
use crate::goal::{Goal, Outcome, Verdict};
use crate::ground::Ground;
use crate::trial::Trial;

/// Share of a generation that is new at random.
const IMMIGRANTS: f64 = 0.05;
/// Share of the children with two parents.
const CROSSED: f64 = 0.3;
/// Audits per generation at most. The rest waits for the next generation.
const AUDITS: usize = 8;

/// What determines an evolution, besides the ground and the device.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Creatures per generation.
    pub population: usize,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Where nodes may be.
    pub body: Body,
    /// What counts.
    pub goal: Goal,
    /// Time of a trial, in s.
    pub seconds: f64,
    /// Time step, in s.
    pub dt: f32,
    /// Name of the integrator.
    pub integrator: String,
    /// The ground, as scene text.
    pub ground: String,
}

impl Plan {
    /// The conditions under which the creatures of this plan live.
    ///
    /// # Errors
    /// [`Error::Invalid`](rockfall::Error::Invalid) for an unknown integrator. Those of [`Scene::parse`] for the ground.
    pub fn trial(&self, backend: Backend) -> Result<Trial> {
        let integrator: Integrator = self.integrator.parse()?;
        let ground = Scene::parse(&self.ground, "the ground".as_ref())?;
        let mut trial = Trial::new(self.goal, self.seconds, self.dt, Ground::of(ground.scene));
        trial.options = Options::new().backend(backend).integrator(integrator);
        Ok(trial)
    }
}

/// The best creature that has passed an audit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Champion {
    /// The creature.
    pub genome: Genome,
    /// What it did in its trial.
    pub outcome: Outcome,
    /// What the audit found.
    pub audit: Audit,
    /// Number of the generation in which it became the champion.
    pub generation: u64,
}

/// The report on a generation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Generation {
    /// Its number, from 1.
    pub number: u64,
    /// Fitness of the champion so far; 0 if there is none.
    pub champion: f64,
    /// Greatest fitness in this generation.
    pub best: f64,
    /// Mean fitness of this generation; creatures that do not count have 0.
    pub mean: f64,
    /// Niches with a creature.
    pub niches: usize,
    /// Creatures whose states stopped being finite.
    pub not_finite: usize,
    /// Creatures that were faster, or strained more, than muscles can make them.
    pub exploded: usize,
    /// Creatures that fell or leapt once.
    pub unsteady: usize,
    /// Creatures that went downhill.
    pub downhill: usize,
    /// Creatures that failed an audit.
    pub failed_audits: usize,
}

/// An evolution. [`Evolution::generation`] advances it.
#[derive(Clone, Debug)]
pub struct Evolution {
    plan: Plan,
    trial: Trial,
    pub(crate) archive: Archive,
    pub(crate) champion: Option<Champion>,
    pub(crate) history: Vec<Generation>,
}

impl Evolution {
    /// Begins an evolution. The trial must be that of the plan.
    pub fn new(plan: Plan, trial: Trial) -> Self {
        Self { plan, trial, archive: Archive::default(), champion: None, history: Vec::new() }
    }

    /// What determines it.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The conditions under which creatures live.
    pub fn trial(&self) -> &Trial {
        &self.trial
    }

    /// The best creature of every niche.
    pub fn archive(&self) -> &Archive {
        &self.archive
    }

    /// The best creature that has passed an audit.
    pub fn champion(&self) -> Option<&Champion> {
        self.champion.as_ref()
    }

    /// Takes from another evolution, under the same conditions, the creatures that are fitter than those of their niches. Returns
    /// their number. One of them that would become the champion is audited first.
    ///
    /// # Errors
    /// [`Error::Invalid`] if another field of the plan than the population and the seed differs.
    pub fn adopt(&mut self, other: &Self) -> Result<usize> {
        let same = Plan { population: self.plan.population, seed: self.plan.seed, ..other.plan.clone() };
        if same != self.plan {
            let expected = "an evolution with the same body, goal, time, time step, integrator and ground";
            let value = format!("{} of {} in {} s", other.plan.goal, other.plan.body, other.plan.seconds);
            return Err(Error::Invalid { field: "other", value, expected });
        }
        let ranked = other.archive.ranked();
        Ok(ranked.into_iter().filter(|(_, elite)| self.archive.add(&elite.genome, &elite.outcome)).count())
    }

    /// The fittest creatures of different niches that pass an audit, up to `most` of them.
    ///
    /// # Errors
    /// As for [`audit`].
    pub fn gallery(&self, most: usize) -> Result<Vec<(Niche, &Elite)>> {
        let mut gallery = Vec::new();
        for (niche, elite) in self.archive.ranked() {
            if gallery.len() == most {
                break;
            }
            if elite.audited || audit(&elite.genome, &elite.outcome, &self.trial)?.passed {
                gallery.push((niche, elite));
            }
        }
        Ok(gallery)
    }

    /// The generations so far.
    pub fn history(&self) -> &[Generation] {
        &self.history
    }

    /// Makes and tries a generation. Returns `None`, and leaves everything as it was, if `should_stop` returned `true` before it was
    /// complete.
    ///
    /// # Errors
    /// As for [`Trial::run`].
    pub fn generation(&mut self, should_stop: &dyn Fn() -> bool) -> Result<Option<&Generation>> {
        let number = self.history.len() as u64 + 1;
        // A stream of its own, so that a resumed evolution draws the same numbers.
        let mut random = Pcg64::new(self.plan.seed.into(), number.into());
        let children: Vec<Genome> = (0..self.plan.population).map(|_| self.child(&mut random)).collect();
        let Some(outcomes) = self.trial.run(&children, should_stop)? else { return Ok(None) };
        for (child, outcome) in children.iter().zip(&outcomes) {
            self.archive.add(child, outcome);
        }
        let failed_audits = self.crown(number)?;
        let count = |verdict| outcomes.iter().filter(|outcome| outcome.verdict == verdict).count();
        self.history.push(Generation {
            number,
            champion: self.champion.as_ref().map_or(0.0, |champion| champion.outcome.fitness),
            best: outcomes.iter().map(|outcome| outcome.fitness).fold(0.0, f64::max),
            mean: outcomes.iter().map(|outcome| outcome.fitness).sum::<f64>() / outcomes.len().max(1) as f64,
            niches: self.archive.len(),
            not_finite: count(Verdict::NotFinite),
            exploded: count(Verdict::Exploded),
            unsteady: count(Verdict::Unsteady),
            downhill: count(Verdict::Downhill),
            failed_audits,
        });
        Ok(self.history.last())
    }

    fn child(&self, random: &mut Pcg64) -> Genome {
        let is_new = random.random_bool(IMMIGRANTS);
        let Some(parent) = self.archive.parent(random).filter(|_| !is_new) else {
            return Genome::random(random, self.plan.body);
        };
        if random.random_bool(CROSSED)
            && let Some(other) = self.archive.parent(random)
        {
            return parent.crossed(other, random).mutated(random);
        }
        parent.mutated(random)
    }

    /// Audits creatures that are fitter than the champion, the fittest first, until one passes. Those that do not pass leave the
    /// archive. Returns their number.
    fn crown(&mut self, generation: u64) -> Result<usize> {
        let mut failed = 0;
        while failed < AUDITS {
            let least = self.champion.as_ref().map_or(0.0, |champion| champion.outcome.fitness);
            let ranked = self.archive.ranked();
            let Some((niche, elite)) = ranked.first().filter(|(_, elite)| elite.outcome.fitness > least && !elite.audited)
            else {
                break;
            };
            let (niche, Elite { genome, outcome, .. }) = (*niche, (*elite).clone());
            let found = audit(&genome, &outcome, &self.trial)?;
            self.archive.settle(niche, found.passed);
            if found.passed {
                self.champion = Some(Champion { genome, outcome, audit: found, generation });
                break;
            }
            failed += 1;
        }
        Ok(failed)
    }
}
