//! Exact lists: pair lists without room for motion.
//!
//! Where bodies fly about, lists are rebuilt in nearly every step anyway, and the margin for one step of motion makes them several
//! times as long. Symplectic Euler evaluates contacts at two sets of positions in a step: collisions at those with which the step
//! begins, forces at those that the impulses leave. So exact lists hold the pairs that may touch at the present positions. They
//! are rebuilt as soon as a sphere has moved by more than a small margin: before the collisions, and again before the forces if
//! an impulse has moved a sphere. RK4 also evaluates contacts at positions within the step, which are not known in advance.
//!
//! Lookahead 0 stands for exact lists. `simulation/lookahead.rs` chooses them by a trial, like any other number of steps. Results
//! do not depend on it.

use crate::model::layout::{FLAG_CONTINUOUS, LAW_THESIS};
use crate::options::Optimization;
use crate::settings::{BroadPhase, Integrator};
use crate::simulation::Simulation;
use crate::simulation::drive::{COLLISIONS_FIRST, WITH_EXACT_LISTS};
use crate::simulation::lookahead::Lookahead;
use crate::step::schedule::Phase;

impl Simulation {
    /// Whether lists may be exact in this scene. Contacts that begin and end within a step need lists of the whole path. Other contact
    /// laws keep springs for the pairs of their lists, friction impulses follow the collisions and use their lists, and rods move
    /// between two evaluations. Without collisions bodies press each other gently, and lists with a margin last longer than a step.
    pub(super) fn may_have_exact_lists(&self) -> bool {
        let step = &self.world.step;
        self.options.integrator == Integrator::SymplecticEuler
            && self.broad_phase_method() == BroadPhase::Grid
            && self.scene.settings.collisions
            && step.flags & FLAG_CONTINUOUS == 0
            && step.rods == 0
            && step.long_at == 0
            && step.law == LAW_THESIS
            && !step.has_friction_impulses()
            && self.options.uses(Optimization::ExactLists)
    }

    /// The phases that compute the same as `phases` with the present kind of lists. Ends exact lists where they cannot be used.
    pub(super) fn phases_for_lists<'a>(&mut self, phases: &'a [Phase]) -> &'a [Phase] {
        if !self.world.step.has_exact_lists() {
            return phases;
        }
        if phases != COLLISIONS_FIRST || !self.may_have_exact_lists() {
            self.lookahead = Lookahead::default();
            self.world.step.lookahead = 1.0;
            self.note_end_of_exact_lists(true);
            return phases;
        }
        &WITH_EXACT_LISTS
    }

    /// Requests lists if exact lists were used until now and are no longer. Exact lists do not hold for the collisions of the next
    /// step.
    pub(super) fn note_end_of_exact_lists(&mut self, was_exact: bool) {
        let ends = was_exact && !self.world.step.has_exact_lists();
        self.aabbs_due |= ends;
        self.lists_due |= ends;
    }
}

#[cfg(all(test, not(target_family = "wasm")))]
mod tests {
    use super::*;
    use crate::generate::Benchmark;
    use crate::simulation::drive::WITHOUT_COLLISIONS;
    use crate::{Backend, Options, Polygon, Scene, Settings, Sphere, SphereState};

    /// Spheres of several radii that fall on a box and a slanted polygon and come to rest, one fixed sphere among them.
    fn pile() -> Scene {
        let mut scene = Benchmark::Pile.generate(1100, 4).unwrap();
        scene.add_polygon(Polygon::new([-3.0, 0.5, -3.0], [0.0, 0.2, 6.0], [6.0, 0.3, 0.0])).unwrap();
        let mut fixed = Sphere::new([0.1, 1.0, 0.2], 0.3);
        fixed.fixed = true;
        scene.add_sphere(fixed).unwrap();
        scene
    }

    fn simulation(backend: Backend) -> Simulation {
        let options = Options::new().backend(backend).integrator(Integrator::SymplecticEuler).broad_phase(BroadPhase::Grid);
        Simulation::with_options(pile(), options).unwrap()
    }

    fn begin_exact(simulation: &mut Simulation) {
        simulation.lookahead = Lookahead::from_steps(0.0);
        simulation.world.step.lookahead = 0.0;
    }

    /// The spheres after every few steps, and the greatest number of rows that the lists took. With `exact`, exact lists are chosen
    /// again and again. On the way, the trials also choose others.
    fn run(backend: Backend, steps: u64, exact: bool) -> (Vec<Vec<SphereState>>, u32) {
        let mut simulation = simulation(backend);
        let mut rows = 0;
        let mut states = Vec::new();
        for chunk in 0..steps / 20 {
            if exact && chunk % 4 != 3 {
                begin_exact(&mut simulation);
            } else if !exact {
                (simulation.lookahead, simulation.world.step.lookahead) = (Lookahead::default(), 1.0);
            }
            simulation.run(20, 0.02).unwrap();
            if chunk == 4 {
                assert_eq!(simulation.world.step.has_exact_lists(), exact);
                rows = simulation.status.pair_rows_needed;
            }
            states.push(simulation.spheres().unwrap());
        }
        assert!(simulation.report.total_collisions > 500, "{:?}", simulation.report);
        assert!(simulation.report.contacts > 500, "{:?}", simulation.report);
        (states, rows)
    }

    fn assert_same(backend: Backend, steps: u64) {
        let (exact, exact_rows) = run(backend, steps, true);
        let (usual, usual_rows) = run(backend, steps, false);
        assert!(exact_rows < usual_rows, "{exact_rows} and {usual_rows} rows");
        for (chunk, (one, other)) in exact.iter().zip(&usual).enumerate() {
            assert!(one == other, "the states differ after {} steps", 20 * (chunk + 1));
        }
    }

    #[test]
    fn exact_lists_do_not_change_results_on_the_cpu() {
        assert_same(Backend::Cpu, 400);
    }

    #[test]
    #[cfg(feature = "gpu")]
    fn exact_lists_do_not_change_results_on_the_gpu() {
        assert_same(Backend::Gpu, 240);
    }

    /// Without the second rebuild, the step would be rejected for every sphere that an impulse moves.
    #[test]
    fn impulses_do_not_reject_steps_with_exact_lists() {
        let mut simulation = simulation(Backend::Cpu);
        simulation.run(60, 0.02).unwrap();
        begin_exact(&mut simulation);
        let before = simulation.report;
        simulation.run(20, 0.02).unwrap();
        assert!(simulation.report.total_collisions > before.total_collisions + 20);
        assert_eq!(simulation.report.replays, before.replays);
        assert!(simulation.report.list_builds > before.list_builds + 25, "lists are rebuilt twice in most steps");
    }

    #[test]
    fn phases_one_by_one_and_other_scenes_end_exact_lists() {
        let mut simulation = simulation(Backend::Cpu);
        begin_exact(&mut simulation);
        assert_eq!(simulation.phases_for_lists(&COLLISIONS_FIRST), WITH_EXACT_LISTS);
        assert_eq!(simulation.phases_for_lists(&[Phase::UpdatePositions]), [Phase::UpdatePositions]);
        assert!(!simulation.world.step.has_exact_lists() && simulation.lists_due);
        let usual = *simulation.settings();
        let friction = Settings { coulomb_friction: 0.3, ..usual };
        let soft = Settings { collisions: false, ..usual };
        for (settings, phases) in [(friction, &COLLISIONS_FIRST[..]), (soft, &WITHOUT_COLLISIONS)] {
            begin_exact(&mut simulation);
            simulation.set_settings(settings).unwrap();
            assert_eq!(simulation.phases_for_lists(phases), phases);
            assert!(!simulation.world.step.has_exact_lists());
            simulation.set_settings(usual).unwrap();
            simulation.run(2, 0.01).unwrap();
        }
    }
}
