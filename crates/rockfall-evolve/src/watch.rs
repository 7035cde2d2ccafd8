//! What is seen of a creature in its trial, and the judgement on it.

use rockfall::SphereState;
use rockfall::glam::{DVec2, DVec3};

use crate::genome::{Bond, Genome, RADIUS};
use crate::goal::{Goal, Outcome, Verdict};
use crate::ground::Ground;

/// A sphere that is faster, in units/s, has been thrown by numerical energy: muscles reach a tenth of it.
const MOST_SPEED: f64 = 20.0;
/// Springs may be this much shorter or longer than at rest. Muscles reach 0.75 and 1.25.
const STRAINS: std::ops::RangeInclusive<f64> = 0.3..=2.0;
/// Least share of the distance that a walker covers in the second half of the time. One fall or leap covers nothing there.
const STEADY: f64 = 0.3;

/// What creatures are judged by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Conditions<'a> {
    pub(crate) goal: Goal,
    pub(crate) ground: &'a Ground,
    /// Time after the settling, in s.
    pub(crate) time: f64,
}

/// What was seen of a creature so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch {
    /// Centre at each sample from the settling on.
    centres: Vec<DVec3>,
    /// How far the creature is above the ground at each of these samples, if the goal needs it.
    stands: Vec<Stand>,
    exploded: bool,
}

/// How far a creature is above the ground, in units.
#[derive(Clone, Copy, Debug)]
struct Stand {
    /// Height of the lowest point.
    bottom: f64,
    /// Distance that the creature can fall straight down as it is: 0 if a sphere touches something, infinity over no ground.
    clearance: f64,
    /// Height of the ground below the centre; minus infinity over no ground.
    under_centre: f64,
}

/// A creature that can fall less far than this stands on the ground, in units.
const STANDS: f64 = 0.01;

impl Stand {
    fn of(places: &[DVec3], centre: DVec3, ground: &Ground) -> Self {
        let radius = f64::from(RADIUS);
        let falls = places.iter().map(|place| ground.fall(*place, radius));
        Self {
            bottom: places.iter().map(|place| place.y).fold(f64::INFINITY, f64::min) - radius,
            clearance: falls.fold(f64::INFINITY, f64::min),
            under_centre: centre.y - ground.fall(centre, 0.0),
        }
    }

    /// Height at which the lowest point would be if the creature fell straight down as it is.
    fn footing(&self) -> f64 {
        self.bottom - self.clearance
    }
}

impl Watch {
    pub(crate) fn look(&mut self, conditions: &Conditions<'_>, bonds: &[Bond], states: &[SphereState], has_settled: bool) {
        let places: Vec<DVec3> = states.iter().map(|state| state.position.as_dvec3()).collect();
        let centre = places.iter().sum::<DVec3>() / places.len() as f64;
        let fast = states.iter().any(|state| state.velocity.as_dvec3().length() > MOST_SPEED);
        let strained = bonds.iter().any(|bond| {
            let [a, b] = bond.ends;
            !STRAINS.contains(&(places[a].distance(places[b]) / f64::from(bond.length)))
        });
        self.exploded |= fast || strained || !centre.is_finite();
        if has_settled {
            self.centres.push(centre);
            if conditions.goal.needs_ground() {
                self.stands.push(Stand::of(&places, centre, conditions.ground));
            }
        }
    }

    pub(crate) fn judge(&self, conditions: &Conditions<'_>, genome: &Genome, stopped: bool) -> Outcome {
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
        let (verdict, fitness) = match conditions.goal {
            goal if goal.walks() && late < STEADY * distance => (Verdict::Unsteady, 0.0),
            goal if goal.walks() && first.y - last.y > f64::from(genome.length()) => (Verdict::Downhill, 0.0),
            Goal::Distance => (Verdict::Valid, distance),
            Goal::Speed => (Verdict::Valid, late / (0.5 * conditions.time)),
            Goal::Height => (Verdict::Valid, self.height()),
            Goal::Jump => (Verdict::Valid, self.jump()),
            Goal::Climb => (Verdict::Valid, self.climb()),
        };
        Outcome { verdict, fitness, distance, bounce }
    }

    /// Mean height of the centre above the ground: that below the centre, or that below the feet where it is higher. Samples over no
    /// ground count 0.
    fn height(&self) -> f64 {
        let heights = self.centres.iter().zip(&self.stands).map(|(centre, stand)| {
            let ground = stand.under_centre.max(stand.footing());
            if ground.is_finite() { centre.y - ground } else { 0.0 }
        });
        heights.sum::<f64>() / self.stands.len().max(1) as f64
    }

    /// Greatest height above the ground below the creature, and above where it stood last: neither a step that it stands on nor the
    /// depth of a step that it falls from counts.
    fn jump(&self) -> f64 {
        let (mut stood, mut greatest) = (f64::INFINITY, 0.0_f64);
        for stand in &self.stands {
            if stand.clearance < STANDS || stood.is_infinite() {
                stood = if stand.clearance.is_finite() { stand.footing() } else { stand.bottom };
            }
            greatest = greatest.max(stand.clearance.min(stand.bottom - stood));
        }
        greatest
    }

    /// Height that the ground below the lowest point has gained: neither standing up, nor a leap at the end, nor reaching over a step
    /// counts. 0 over no ground.
    fn climb(&self) -> f64 {
        let (Some(first), Some(last)) = (self.stands.first(), self.stands.last()) else { return 0.0 };
        let gained = last.footing() - first.footing();
        if gained.is_finite() { gained.max(0.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::genome::SPACING;
    use crate::genome::tests::cube_with as cube;
    use rockfall::Cuboid;
    use rockfall::glam::Vec3;

    fn watch(centres: impl IntoIterator<Item = [f64; 3]>) -> Watch {
        let centres: Vec<_> = centres.into_iter().map(DVec3::from_array).collect();
        Watch { stands: Vec::new(), centres, exploded: false }
    }

    #[test]
    fn one_fall_is_no_walk_and_going_downhill_neither() {
        let judge = |watch: &Watch, goal| watch.judge(&on(goal, &level()), &cube(0.1), false);
        let walks = watch((0..30).map(|k| [0.1 * f64::from(k), 0.4, 0.0]));
        assert_eq!(judge(&walks, Goal::Distance).verdict, Verdict::Valid);
        assert!((judge(&walks, Goal::Distance).fitness - 2.9).abs() < 1e-9);
        let falls = watch((0..30).map(|k| [f64::from(k).min(3.0), 0.4, 0.0]));
        assert_eq!(judge(&falls, Goal::Speed).verdict, Verdict::Unsteady);
        let slides = watch((0..30).map(|k| [f64::from(k), -f64::from(k), 0.0]));
        assert_eq!(judge(&slides, Goal::Distance).verdict, Verdict::Downhill);
        let exploded = Watch { exploded: true, ..walks.clone() };
        assert_eq!(judge(&exploded, Goal::Height).verdict, Verdict::Exploded);
        assert_eq!(walks.judge(&on(Goal::Distance, &level()), &cube(0.1), true).verdict, Verdict::NotFinite);
    }

    fn level() -> Ground {
        Ground::level(10.0).unwrap()
    }

    fn on(goal: Goal, ground: &Ground) -> Conditions<'_> {
        Conditions { goal, ground, time: 2.4 }
    }

    /// Level ground, and a step 0.5 high from x = 2 on.
    fn with_step() -> Ground {
        let mut scene = level().scene();
        scene.add_box(Cuboid::between([2.0, 0.0, -5.0], [9.0, 0.5, 5.0])).unwrap();
        Ground::of(scene)
    }

    /// The fitness of a cube without muscles whose first node is at these places, one after the other.
    fn fitness(trial: &Conditions<'_>, places: &[[f32; 3]]) -> f64 {
        let genome = cube(0.0);
        let scene = genome.scene(trial.ground).unwrap();
        let mut watch = Watch::default();
        for place in places {
            let first = scene.spheres()[0].position;
            let mut states: Vec<SphereState> = scene.spheres().iter().map(SphereState::from).collect();
            states.iter_mut().for_each(|state| state.position += Vec3::from_array(*place) - first);
            watch.look(trial, &genome.bonds(), &states, true);
        }
        let outcome = watch.judge(trial, &genome, false);
        assert_eq!(outcome.verdict, Verdict::Valid);
        outcome.fitness
    }

    #[test]
    fn a_step_of_the_ground_is_no_jump() {
        let step_ground = with_step();
        let trial = on(Goal::Jump, &step_ground);
        let near = |places: &[[f32; 3]], expected: f64| {
            let found = fitness(&trial, places);
            assert!((found - expected).abs() < 1e-6, "{found} for {expected}: {places:?}");
        };
        let (floor, step) = (RADIUS, 0.5 + RADIUS);
        // It stands on the step, or leans over its edge with half of its spheres.
        near(&[[0.0, floor, 0.0], [3.0, step, 0.0]], 0.0);
        near(&[[0.0, floor, 0.0], [1.7, step, 0.0]], 0.0);
        // Jumps on the floor and on the step.
        near(&[[0.0, floor, 0.0], [0.0, floor + 0.3, 0.0], [0.0, floor, 0.0]], 0.3);
        near(&[[3.0, step, 0.0], [3.0, step + 0.2, 0.0], [4.0, step + 0.1, 0.0]], 0.2);
        // Onto the step: 0.1 above it. Down from it: 0.1 above where it stood. Off all ground: nothing.
        near(&[[0.0, floor, 0.0], [3.0, step + 0.1, 0.0], [3.0, step, 0.0]], 0.1);
        near(&[[3.0, step, 0.0], [0.0, step + 0.1, 0.0], [0.0, floor, 0.0]], 0.1);
        near(&[[3.0, step, 0.0], [3e4, -5.0, 0.0], [3e4, -9.0, 0.0]], 0.0);
        // A higher step below changes nothing.
        let ground = level();
        let level = on(Goal::Jump, &ground);
        let leap = [[0.0, floor - 0.002, 0.0], [0.0, 0.9, 0.0]];
        assert_eq!(fitness(&level, &leap), f64::from(0.9_f32) - f64::from(RADIUS));
    }

    #[test]
    fn height_counts_above_the_ground_below() {
        let step_ground = with_step();
        let (trial, middle) = (on(Goal::Height, &step_ground), f64::from(0.5 * SPACING + RADIUS));
        let (floor, step) = (RADIUS, 0.5 + RADIUS);
        for places in [[[0.0, floor, 0.0]; 2], [[3.0, step, 0.0]; 2], [[0.0, floor, 0.0], [3.0, step, 0.0]]] {
            assert!((fitness(&trial, &places) - middle).abs() < 1e-6, "{places:?}");
        }
        // The centre is beside the step, the feet are on it.
        assert!((fitness(&trial, &[[1.6, step, 0.0]]) - middle).abs() < 1e-6);
        assert_eq!(fitness(&trial, &[[3e4, -5.0, 0.0]]), 0.0);
    }

    #[test]
    fn only_higher_ground_is_a_climb() {
        let step_ground = with_step();
        let trial = on(Goal::Climb, &step_ground);
        let (floor, step) = (RADIUS, 0.5 + RADIUS);
        let climb = |end: [f32; 3]| fitness(&trial, &[[0.0, floor, 0.0], end]);
        assert!((climb([3.0, step, 0.0]) - 0.5).abs() < 1e-6);
        assert!((climb([3.0, step + 0.4, 0.0]) - 0.5).abs() < 1e-6);
        assert!(climb([0.0, floor + 0.4, 0.0]) < 1e-6 && climb([0.0, floor, 0.0]) < 1e-6);
        assert!(climb([3e4, -5.0, 0.0]) == 0.0);
        assert!(fitness(&trial, &[[3.0, step, 0.0], [0.0, floor, 0.0]]) == 0.0);
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
            watch.look(&on(Goal::Distance, &level()), &genome.bonds(), &changed, true);
            watch.exploded
        };
        assert!(!look(&|_| {}));
        assert!(look(&|state| state.velocity.x = 21.0));
        assert!(look(&|state| state.position.x += 2.0));
        assert!(look(&|state| state.position.x = f32::NAN));
    }
}
