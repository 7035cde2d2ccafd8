//! The best creature of each kind.

use std::collections::BTreeMap;

use rand::RngExt as _;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::genome::{FREQUENCIES, Genome, NODES};
use crate::goal::{Outcome, Verdict};

/// Bounds between the kinds of bounce.
const BOUNCES: [f64; 4] = [0.01, 0.03, 0.07, 0.15];
/// Number of kinds of frequency.
const FREQUENCY_KINDS: f32 = 4.0;
/// Nodes per kind of size.
const NODES_PER_KIND: usize = 4;
/// Entrants of a tournament.
const ENTRANTS: usize = 3;

/// A kind of creature. Creatures of different niches do not compete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Niche {
    /// By number of nodes: 0 for 4 to 7, and so on.
    pub size: u8,
    /// By frequency, from 0 to 3.
    pub frequency: u8,
    /// By how much the centre goes up and down, from 0 (glides) to 4 (leaps).
    pub bounce: u8,
}

impl Niche {
    /// The niche of a creature with this outcome.
    pub fn of(genome: &Genome, outcome: &Outcome) -> Self {
        let size = (genome.nodes.len() - NODES.start()) / NODES_PER_KIND;
        let share = (genome.frequency - FREQUENCIES.start()) / (FREQUENCIES.end() - FREQUENCIES.start());
        let frequency = (share * FREQUENCY_KINDS).clamp(0.0, FREQUENCY_KINDS - 1.0);
        let bounce = BOUNCES.iter().filter(|bound| outcome.bounce >= **bound).count();
        Self { size: size as u8, frequency: frequency as u8, bounce: bounce as u8 }
    }
}

/// The best creature of a niche.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Elite {
    /// The creature.
    pub genome: Genome,
    /// What it did.
    pub outcome: Outcome,
    /// Whether it has passed an audit.
    pub audited: bool,
}

/// The best creature of each niche.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Archive {
    #[serde(with = "pairs")]
    elites: BTreeMap<Niche, Elite>,
}

impl Archive {
    /// Adds a creature if it is the best of its niche. Returns whether it is.
    pub fn add(&mut self, genome: &Genome, outcome: &Outcome) -> bool {
        if outcome.verdict != Verdict::Valid || outcome.fitness.is_nan() || outcome.fitness <= 0.0 {
            return false;
        }
        let niche = Niche::of(genome, outcome);
        let is_best = self.elites.get(&niche).is_none_or(|elite| outcome.fitness > elite.outcome.fitness);
        if is_best {
            self.elites.insert(niche, Elite { genome: genome.clone(), outcome: *outcome, audited: false });
        }
        is_best
    }

    /// Number of niches with a creature.
    pub fn len(&self) -> usize {
        self.elites.len()
    }

    /// Whether there is no creature.
    pub fn is_empty(&self) -> bool {
        self.elites.is_empty()
    }

    /// The creatures, the fittest first. Equally fit ones are in the order of their niches.
    pub fn ranked(&self) -> Vec<(Niche, &Elite)> {
        let mut ranked: Vec<_> = self.elites.iter().map(|(niche, elite)| (*niche, elite)).collect();
        ranked.sort_by(|(_, a), (_, b)| b.outcome.fitness.total_cmp(&a.outcome.fitness));
        ranked
    }

    /// The result of an audit: those that do not pass leave the archive.
    pub(crate) fn settle(&mut self, niche: Niche, passed: bool) {
        if passed {
            if let Some(elite) = self.elites.get_mut(&niche) {
                elite.audited = true;
            }
        } else {
            self.elites.remove(&niche);
        }
    }

    /// A parent: any with equal probability, or the fittest of a few. `None` for an empty archive.
    pub(crate) fn parent(&self, random: &mut Pcg64) -> Option<&Genome> {
        if self.elites.is_empty() {
            return None;
        }
        let entrants = if random.random_bool(0.5) { 1 } else { ENTRANTS };
        let mut best: Option<&Elite> = None;
        for _ in 0..entrants {
            let elite = self.elites.values().nth(random.random_range(0..self.elites.len()))?;
            if best.is_none_or(|known| elite.outcome.fitness > known.outcome.fitness) {
                best = Some(elite);
            }
        }
        best.map(|elite| &elite.genome)
    }
}

/// JSON has no maps with such keys.
mod pairs {
    use super::{BTreeMap, Elite, Niche};
    use serde::{Deserialize as _, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(elites: &BTreeMap<Niche, Elite>, to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(elites)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<Niche, Elite>, D::Error> {
        Ok(Vec::<(Niche, Elite)>::deserialize(from)?.into_iter().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::genome::Body;
    use rand::SeedableRng as _;

    fn outcome(fitness: f64, bounce: f64) -> Outcome {
        Outcome { verdict: Verdict::Valid, fitness, distance: fitness, bounce }
    }

    #[test]
    fn only_the_best_of_a_niche_stays() {
        let genome = Genome::random(&mut Pcg64::seed_from_u64(1), Body::Lattice);
        let mut archive = Archive::default();
        assert!(archive.add(&genome, &outcome(1.0, 0.0)));
        assert!(!archive.add(&genome, &outcome(1.0, 0.005)));
        assert!(archive.add(&genome, &outcome(2.0, 0.0)));
        assert!(archive.add(&genome, &outcome(0.5, 0.2)));
        assert!(!archive.add(&genome, &outcome(0.0, 0.1)));
        assert!(!archive.add(&genome, &Outcome { verdict: Verdict::Exploded, ..outcome(9.0, 0.1) }));
        let ranked: Vec<f64> = archive.ranked().iter().map(|(_, elite)| elite.outcome.fitness).collect();
        assert_eq!(ranked, [2.0, 0.5]);
        let best = archive.ranked()[0].0;
        archive.settle(best, false);
        assert_eq!(archive.len(), 1);
    }
}
