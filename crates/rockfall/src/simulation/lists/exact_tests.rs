//! Exact lists give the results of others, and end where they cannot be used.

use crate::generate::Benchmark;
use crate::simulation::Simulation;
use crate::simulation::drive::{COLLISIONS_FIRST, WITH_EXACT_LISTS, WITHOUT_COLLISIONS};
use crate::simulation::lists::{ListPolicy, MIN_MARGIN};
use crate::step::schedule::Phase;
use crate::{Backend, BroadPhase, Integrator, Options, Polygon, Scene, Settings, Sphere, SphereState};

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
    simulation.lists = ListPolicy::new(0.0, MIN_MARGIN);
}

/// The spheres after every few steps, and the greatest number of rows that the lists took. With `exact`, exact lists are chosen
/// again and again. In between, the trials also choose lists with a margin.
fn run(backend: Backend, steps: u64, exact: bool) -> (Vec<Vec<SphereState>>, u32) {
    let mut simulation = simulation(backend);
    let mut rows = 0;
    let mut states = Vec::new();
    for chunk in 0..steps / 20 {
        if exact && chunk % 4 != 3 {
            begin_exact(&mut simulation);
        } else if !exact {
            simulation.lists = ListPolicy::new(1.0, MIN_MARGIN);
        }
        simulation.run(20, 0.02).unwrap();
        if chunk == 4 {
            assert_eq!(simulation.lists.is_exact(), exact);
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
    assert!(!simulation.lists.is_exact() && simulation.lists_due);
    let usual = *simulation.settings();
    let friction = Settings { coulomb_friction: 0.3, ..usual };
    let soft = Settings { collisions: false, ..usual };
    for (settings, phases) in [(friction, &COLLISIONS_FIRST[..]), (soft, &WITHOUT_COLLISIONS)] {
        begin_exact(&mut simulation);
        simulation.set_settings(settings).unwrap();
        assert_eq!(simulation.phases_for_lists(phases), phases);
        assert!(!simulation.lists.is_exact());
        simulation.set_settings(usual).unwrap();
        simulation.run(2, 0.01).unwrap();
    }
}
