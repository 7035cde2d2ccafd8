//! A reference implementation ("witness") of one step in f64, and comparisons of the engine with it.
//!
//! The witness follows `docs/physics` alone, not the code of either backend. It is small and slow: it finds pairs by
//! testing all of them, solves networks with a dense matrix, and does not depend on the order of bodies.

#[macro_use]
mod common;

#[path = "witness/advance.rs"]
mod advance;
#[path = "witness/chains.rs"]
mod chains;
#[path = "witness/closed.rs"]
mod closed;
#[path = "witness/closed_surfaces.rs"]
mod closed_surfaces;
#[path = "witness/collide.rs"]
mod collide;
#[path = "witness/compare.rs"]
mod compare;
#[path = "witness/disagree.rs"]
mod disagree;
#[path = "witness/draw.rs"]
mod draw;
#[path = "witness/forces.rs"]
mod forces;
#[path = "witness/friction_impulses.rs"]
mod friction_impulses;
#[path = "witness/geometry.rs"]
mod geometry;
#[path = "witness/known.rs"]
mod known;
#[path = "witness/lengths.rs"]
mod lengths;
#[path = "witness/mistakes.rs"]
mod mistakes;
#[path = "witness/mixtures.rs"]
mod mixtures;
#[path = "witness/perturb.rs"]
mod perturb;
#[path = "witness/rigid/mod.rs"]
mod rigid;
#[path = "witness/rims.rs"]
mod rims;
#[path = "witness/scenes.rs"]
mod scenes;
#[path = "witness/sides.rs"]
mod sides;
#[path = "witness/surfaces.rs"]
mod surfaces;
#[path = "witness/tiled.rs"]
mod tiled;
#[path = "witness/walls.rs"]
mod walls;
#[path = "witness/world.rs"]
mod world;

use compare::{Tally, Trial};
use mistakes::MISTAKES;
use rockfall::{Backend, Integrator};
use world::Mistake;

/// Compares the engine with the witness on one plan per seed, each with a number of clusters and steps.
fn compare(
    backend: Backend,
    seeds: impl IntoIterator<Item = u64>,
    clusters: usize,
    steps: usize,
    mistake: Option<Mistake>,
) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        // A single cluster keeps one regime for all steps, because there are thousands of such scenes. The few scenes
        // with many clusters get a new regime for every step.
        let plan = scenes::plan(seed, clusters, if clusters > 1 { steps } else { 1 });
        let name = format!("seed {seed} kind {}", seed as usize % scenes::KINDS);
        Trial { name, plan: &plan, backend, steps, mistake, phases: seed % 3 != 0 }.run(&mut tally);
    }
    tally
}

/// Asserts that the engine agrees with the witness, and that enough steps and collisions were compared.
#[track_caller]
fn assert_agreement(tally: &Tally, collisions: usize) {
    println!("{tally}");
    let shown: String = tally.failures.iter().take(3).cloned().collect();
    assert!(tally.failures.is_empty(), "{} differences\n{shown}", tally.failures.len());
    assert!(tally.close <= 1 + tally.compared / 5_000, "too many steps exceed the tolerance: {tally}");
    assert!(tally.undecided * 100 < tally.compared, "too many steps are undecided: {tally}");
    assert!(tally.collisions > collisions && 20 * tally.lone > collisions, "too few collisions: {tally}");
}

/// The first half of the scenes. The next test compares the second half, so that the two can run in parallel.
#[test]
fn the_cpu_agrees_with_the_witness_in_random_scenes() {
    assert_agreement(&compare(Backend::Cpu, 0..4_000, 1, 6, None), 6_000);
}

#[test]
fn the_cpu_agrees_with_the_witness_in_more_random_scenes() {
    assert_agreement(&compare(Backend::Cpu, 4_000..8_000, 1, 6, None), 6_000);
}

/// The same scenes with velocity Verlet, which the plans do not draw.
#[test]
fn the_cpu_agrees_with_the_witness_with_velocity_verlet() {
    let mut tally = Tally::default();
    for seed in 0..4_000 {
        let plan = scenes::Plan { integrator: Integrator::VelocityVerlet, ..scenes::plan(seed, 1, 1) };
        let name = format!("seed {seed} kind {}", seed as usize % scenes::KINDS);
        let phases = seed % 3 != 0;
        Trial { name, plan: &plan, backend: Backend::Cpu, steps: 4, mistake: None, phases }.run(&mut tally);
    }
    assert_agreement(&tally, 2_000);
}

/// Many clusters in one scene, and more steps.
#[test]
fn the_cpu_agrees_with_the_witness_in_large_scenes() {
    assert_agreement(&compare(Backend::Cpu, 5_020..5_040, 34, 12, None), 1_000);
}

/// Scenes that showed faults of an older model, and a scene with every kind of object, for 150 steps.
#[test]
fn the_cpu_agrees_with_the_witness_in_known_scenes() {
    let mut tally = Tally::default();
    for (name, scene) in known::scenes() {
        let regime = scenes::Regime { settings: scene.settings, dt: 0.02 };
        let plan = scenes::Plan { integrator: Integrator::Rk4, regimes: vec![regime], clusters: vec![scene] };
        Trial { name: name.to_owned(), plan: &plan, backend: Backend::Cpu, steps: 150, mistake: None, phases: false }
            .run(&mut tally);
        println!("{name}: {tally}");
    }
    assert_agreement(&tally, 100);
}

/// The same on the GPU, where opening a simulation is slow but further clusters are cheap: one scene with many clusters
/// and fewer steps. This seed has RK4 and whole steps.
#[cfg(feature = "gpu")]
#[test]
fn the_gpu_agrees_with_the_witness_in_whole_steps() {
    assert_agreement(&compare(Backend::Gpu, [6_003], 57, 4, None), 30);
}

/// This seed has symplectic Euler, and phases 3 and 4 are called separately.
#[cfg(feature = "gpu")]
#[test]
fn the_gpu_agrees_with_the_witness_by_phases() {
    assert_agreement(&compare(Backend::Gpu, [6_001], 57, 4, None), 30);
}

/// Checks the comparison itself: it must detect each deliberate mistake of the witness.
#[test]
fn every_deliberate_mistake_is_detected() {
    for mistake in MISTAKES {
        let differs = |seed: u64| !compare(Backend::Cpu, [seed], 1, 3, Some(mistake)).failures.is_empty();
        assert!((0..20 * scenes::KINDS as u64).any(differs), "{mistake:?} is not detected");
    }
}

/// A long run; 20,000 scenes take a minute. In one of some ten thousand scenes, rounding exceeds the tolerance by a
/// factor of up to three. Such scenes have a network, heavy bodies next to light ones, or rods that are almost
/// parallel.
#[test]
#[ignore = "takes minutes"]
fn the_cpu_agrees_with_the_witness_in_a_long_run() {
    for first in (10_000..90_000).step_by(5_000) {
        let tally = compare(Backend::Cpu, first..first + 5_000, 1, 6, None);
        println!("from {first}: {tally}");
        tally.failures.iter().filter_map(|text| text.lines().next()).for_each(|line| println!("  {line}"));
        assert!(tally.worst < 4.0, "{}", tally.failures.concat());
    }
}
