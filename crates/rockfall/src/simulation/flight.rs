//! Submits steps to the engine in portions and reads the status after each without idling the device.
//!
//! A device works on one portion while the status after the previous one is transferred to the host. If that status reports a
//! rejected step, the portions under way are rejected too. Their stages return at once, so only time is lost. If a body left its AABB,
//! the device itself builds new lists and repeats the step, and the portions that follow go on.

use std::collections::VecDeque;

use crate::error::Result;
use crate::model::status::{NO_BODY, REBUILD_REQUESTED, Status};
use crate::options::Optimization;
use crate::profile::Recorder;
use crate::simulation::Simulation;
use crate::simulation::drive::{COLLISIONS_FIRST, WITHOUT_COLLISIONS};
use crate::simulation::engine::PendingStatus;
use crate::step::schedule::{PLACE, Phase, Run};

/// Steps per portion in small scenes and on the CPU, where a rejected step costs little.
const LARGE_PORTION: u64 = 32;
/// Movers times steps of a portion that takes a large device several milliseconds, many times as long as the transfer of the
/// status.
const MOVED: u32 = 1 << 21;

/// How many steps a portion has at most, and how many portions are under way at a time. No result depends on it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portioning {
    /// Maximum number of steps per portion in scenes that are not small. After a rejected step that the host repeats, the rest of all
    /// portions under way is rejected too, which costs one dispatch per stage and step.
    steps: u64,
    /// Number of portions that are submitted to a device at a time.
    depth: usize,
}

impl Default for Portioning {
    /// A browser tells a page about three milliseconds late that a portion is done, so more must be under way.
    fn default() -> Self {
        if cfg!(target_arch = "wasm32") { Self { steps: 8, depth: 4 } } else { Self { steps: 4, depth: 2 } }
    }
}

/// A portion that was submitted.
struct Portion {
    look: PendingStatus,
    /// Greatest number of steps that it can complete.
    steps: u64,
    /// Version of the settings of lists with which it was submitted.
    version: u32,
}

/// What one call of [`Simulation::stretch`] keeps from portion to portion.
struct PhaseRun<'a> {
    phases: &'a [Phase],
    is_step: bool,
    interval: u32,
    /// Steps since the last step in which lists could be rebuilt.
    since: u32,
}

impl Simulation {
    /// Runs phases up to `most` times, until a step is rejected that only the host can repeat. Returns how many times they were done.
    pub(super) async fn stretch(&mut self, phases: &[Phase], most: u64, mut recorder: Option<&mut Recorder>) -> Result<u64> {
        let is_step = phases.starts_with(&COLLISIONS_FIRST) || phases.starts_with(&WITHOUT_COLLISIONS);
        let mut stretch = PhaseRun { phases, is_step, interval: 1, since: 0 };
        self.lists.begin(self.lists_may_wait(is_step));
        self.begin(&stretch)?;
        // Timing the stages of a portion requires waiting for it.
        let overlaps = self.engine.dispatches() && recorder.is_none() && self.options.uses(Optimization::Portions);
        let depth = if overlaps { self.portioning.depth } else { 1 };
        let mut in_flight: VecDeque<Portion> = VecDeque::with_capacity(depth);
        let mut done = 0;
        loop {
            while self.goes_on(&stretch) && in_flight.len() < depth {
                let submitted = done + in_flight.iter().map(|portion| portion.steps).sum::<u64>();
                if submitted >= most {
                    break;
                }
                // After a rejected step, an additional step comes first. It only builds lists. The step after it repeats the
                // rejected one.
                let builds_lists = self.status.rejected != 0 && in_flight.is_empty();
                // A recorder needs to know whether the times of a portion are those of completed or of rejected steps.
                let longest = if recorder.is_some() { 1 } else { self.portion() };
                let steps = longest.min(most - submitted);
                let ahead = submitted - done;
                let portion = self.submit(&mut stretch, [ahead, steps], builds_lists, recorder.as_deref_mut()).await?;
                in_flight.push_back(portion);
            }
            let Some(portion) = in_flight.pop_front() else {
                return Ok(done);
            };
            done += self.finish(&stretch, portion).await?;
            if !self.goes_on(&stretch) {
                // The portions that follow do nothing, so their status is not waited for.
                in_flight.clear();
            }
        }
    }

    /// Whether the portions that follow have work: no step was rejected, or only one that the device repeats once it has built lists.
    fn goes_on(&self, stretch: &PhaseRun<'_>) -> bool {
        self.status.rejected == 0 || (stretch.is_step && self.engine.dispatches() && self.status.may_repeat())
    }

    /// Gives the engine the initial status and the phases of the muscles.
    fn begin(&mut self, stretch: &PhaseRun<'_>) -> Result<()> {
        let makes_lists = stretch.phases.iter().any(|phase| phase.makes_lists());
        if (makes_lists && !stretch.is_step) || self.status.rejected != 0 || self.lists_due || self.aabbs_due {
            self.status.rebuild = REBUILD_REQUESTED;
        }
        self.muscle_clock.set_time_step(self.time_step);
        if self.world.set_muscles(&self.scene, &self.muscle_clock) {
            self.engine.upload_topology(&self.world)?;
        }
        self.status = resumed(self.status);
        self.world.status = self.status;
        self.engine.begin(&self.world)
    }

    /// Submits `steps` steps, while `submitted` others are under way. If `builds_lists` is set, an additional step precedes them, which builds lists and is not counted.
    async fn submit(
        &mut self,
        stretch: &mut PhaseRun<'_>,
        [submitted, steps]: [u64; 2],
        builds_lists: bool,
        mut recorder: Option<&mut Recorder>,
    ) -> Result<Portion> {
        if self.status.rejected != 0 {
            // After a rejected step, the next step has the stages that build lists.
            stretch.since = 0;
        }
        let (interval, version) = self.put_list_settings(stretch.is_step);
        if interval != stretch.interval {
            (stretch.interval, stretch.since) = (interval, 0);
        }
        let (integrator, broad_phase) = (self.integrator(), self.broad_phase_method());
        let runs = |phase: Phase| {
            let every = if phase.makes_lists() { interval } else { 1 };
            phase.stages(integrator, broad_phase).iter().map(move |run| (phase, Run { every, ..*run }))
        };
        let placing = stretch.phases.iter().take(1).flat_map(|phase| PLACE.iter().map(|run| (*phase, *run)));
        let (owners, stages): (Vec<Phase>, Vec<Run>) = placing.chain(stretch.phases.iter().copied().flat_map(runs)).unzip();
        self.world.set_time_step(self.time_step);
        self.synced = false;
        let range = stretch.since..stretch.since + steps as u32 + u32::from(builds_lists);
        stretch.since = range.end % interval;
        // The device may be at any step from the last known one on.
        self.world.set_poses(&self.scene, &self.muscle_clock, self.status.steps, (submitted + steps) as u32 + 1);
        self.engine.upload_poses(&self.world)?;
        self.world.set_shear(&self.scene, self.status.steps);
        if let Some(recorder) = &mut recorder {
            recorder.expect(owners);
        }
        let look = self.engine.submit(&mut self.world, &stages, range, recorder).await?;
        Ok(Portion { look, steps, version })
    }

    /// Waits for the status after a portion and takes it over. Returns how many times the phases were done.
    async fn finish(&mut self, stretch: &PhaseRun<'_>, portion: Portion) -> Result<u64> {
        let status = portion.look.status().await?;
        let before = std::mem::replace(&mut self.status, status);
        if !stretch.phases.contains(&Phase::UpdatePositions) {
            return Ok(if status.rejected == 0 { portion.steps } else { 0 });
        }
        let done = u64::from(status.steps.wrapping_sub(before.steps));
        self.book(done, &before);
        let facts = self.list_facts();
        self.lists.observe(&facts, portion.version, &before, &status);
        Ok(done)
    }

    /// Sets how many steps a portion has at most in scenes that are not small, and how many portions are under way at a time.
    /// For measurements.
    #[doc(hidden)]
    pub fn set_portions(&mut self, steps: u64, depth: usize) {
        self.portioning = Portioning { steps: steps.max(1), depth: depth.max(1) };
    }

    /// Number of steps of the next portion.
    fn portion(&self) -> u64 {
        let step = &self.world.step;
        if !self.engine.dispatches() {
            return LARGE_PORTION;
        }
        u64::from(MOVED / (step.layout.spheres + step.layout.rods).max(1)).clamp(1, self.portioning.steps)
    }
}

/// The status with which steps begin or are repeated. Counts since the status was last reset begin at zero.
fn resumed(status: Status) -> Status {
    Status {
        clustered_steps: 0,
        many_steps: 0,
        steps: 0,
        builds: 0,
        total_collisions_low: 0,
        total_collisions_high: 0,
        total_bad: 0,
        total_passages: 0,
        first_passing: NO_BODY,
        passage_step: 0,
        history_blocks: 0,
        history_needed: 0,
        repeats: 0,
        // `repeated` tells that the device repeats the present step. It is cleared where the host repeats the step instead.
        repeated: if status.rejected == 0 { status.repeated } else { 0 },
        ..status.repeating()
    }
}

#[cfg(all(test, feature = "gpu", not(target_family = "wasm")))]
pub(super) mod tests {
    use super::*;
    use crate::generate::Benchmark;
    use crate::settings::{BroadPhase, Integrator};
    use crate::simulation::lists::{ListPolicy, MIN_MARGIN};
    use crate::{Backend, ContactLaw, Cuboid, Material, Options, Pair, Scene, Sphere};

    /// A simulation with the portions of a browser. Steps of small scenes are joined in one dispatch.
    fn simulation(scene: &Scene, integrator: Integrator, broad_phase: BroadPhase) -> Simulation {
        let options = Options::new().backend(Backend::Gpu).integrator(integrator).broad_phase(broad_phase);
        let mut simulation = Simulation::with_options(scene.clone(), options).unwrap();
        simulation.set_portions(8, 4);
        simulation
    }

    /// Results are those of a run with AABBs so large that no body leaves them.
    fn assert_same_without_escapes(scene: &Scene, integrator: Integrator, broad_phase: BroadPhase, runs: usize) {
        let mut small = simulation(scene, integrator, broad_phase);
        let mut large = simulation(scene, integrator, broad_phase);
        let mut repeats = 0;
        for _ in 0..runs {
            // Lists for more steps than they last.
            small.lists = ListPolicy::new(4.0, MIN_MARGIN);
            large.lists = ListPolicy::new(1.0, 100.0);
            for simulation in [&mut small, &mut large] {
                simulation.run(8, 0.02).unwrap();
            }
            assert_eq!(large.status.repeats, 0, "{:?}", large.report);
            repeats += small.status.repeats;
        }
        assert!(repeats > 0, "{integrator:?}: {:?}", small.report);
        assert!(u64::from(repeats) <= small.report.replays, "{:?}", small.report);
        let contacts = |simulation: &Simulation| {
            let report = simulation.report;
            (report.steps, report.contacts, report.collisions, report.total_collisions, report.max_overlap)
        };
        assert_eq!(contacts(&small), contacts(&large));
        assert_eq!(small.report.steps, 8 * runs as u64);
        assert!(small.report.contacts > 10, "{:?}", small.report);
        assert!(small.spheres().unwrap() == large.spheres().unwrap(), "{integrator:?}");
    }

    #[test]
    fn steps_of_a_pile_are_repeated_on_the_gpu() {
        let pile = Benchmark::Pile.generate(1100, 4).unwrap();
        assert_same_without_escapes(&pile, Integrator::Rk4, BroadPhase::Grid, 12);
        assert_same_without_escapes(&pile, Integrator::SymplecticEuler, BroadPhase::SortAndSkip, 10);
        let mut continuous = pile;
        continuous.settings.continuous_collisions = true;
        assert_same_without_escapes(&continuous, Integrator::Rk4, BroadPhase::Grid, 8);
    }

    #[test]
    fn steps_are_repeated_in_one_dispatch_on_the_gpu() {
        let pile = Benchmark::Pile.generate(200, 4).unwrap();
        assert_same_without_escapes(&pile, Integrator::Rk4, BroadPhase::BruteForce, 12);
    }

    /// Grains that fly into each other, with the springs of contacts.
    pub(in crate::simulation) fn soft_pile() -> Scene {
        let mut scene = Scene::new();
        scene.settings.contact_law = ContactLaw::Linear;
        scene.settings.gravity = 60.0;
        scene.settings.collisions = false;
        let soft = scene.add_material(Material::new("soft").density(1.0).young(1e5).poisson(0.25)).unwrap();
        scene.set_pair(soft, soft, Pair::default().restitution(0.5).friction(0.5).stiffness(900.0)).unwrap();
        for k in 0..600_u16 {
            let [x, y, z] = [k % 10, k / 100, k / 10 % 10].map(f32::from);
            let velocity = [y - 2.5, -f32::from(k % 7), 0.7 * (x - z)];
            scene.add_sphere(Sphere::new([x, 0.6 + 1.05 * y, z], 0.5).material(soft).velocity(velocity)).unwrap();
        }
        scene.add_box(Cuboid::between([-9.0, -9.0, -9.0], [20.0, 0.0, 20.0]).material(soft)).unwrap();
        scene
    }

    #[test]
    fn steps_are_repeated_with_springs_of_contacts_on_the_gpu() {
        let scene = soft_pile();
        assert_same_without_escapes(&scene, Integrator::VelocityVerlet, BroadPhase::BruteForce, 12);
        assert_same_without_escapes(&scene, Integrator::SymplecticEuler, BroadPhase::Grid, 12);
    }

    #[test]
    fn steps_of_rods_are_repeated_on_the_gpu() {
        let scene = Benchmark::Mixed.generate(300, 4).unwrap();
        assert_same_without_escapes(&scene, Integrator::Rk4, BroadPhase::Grid, 25);
    }
}
