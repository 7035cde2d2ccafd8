//! An independent witness: a small, slow step of the specification in f64, and the engine beside it.
//!
//! Written from `docs/physics.md` alone, without a look at either backend. It finds pairs by trying all, solves networks
//! densely, and knows no order of bodies.

#[macro_use]
mod common;

#[path = "witness/advance.rs"]
mod advance;
#[path = "witness/closed.rs"]
mod closed;
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
#[path = "witness/geometry.rs"]
mod geometry;
#[path = "witness/known.rs"]
mod known;
#[path = "witness/lengths.rs"]
mod lengths;
#[path = "witness/mixtures.rs"]
mod mixtures;
#[path = "witness/rub.rs"]
mod rub;
#[path = "witness/scenes.rs"]
mod scenes;
#[path = "witness/sides.rs"]
mod sides;
#[path = "witness/world.rs"]
mod world;

use compare::{Tally, Trial};
use rockfall::{Backend, Integrator};
use world::{MISTAKES, Mistake};

/// Compares many plans of some clusters each, for some steps.
fn compare(
    backend: Backend,
    seeds: impl IntoIterator<Item = u64>,
    clusters: usize,
    steps: usize,
    mistake: Option<Mistake>,
) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        // One regime where there are thousands of scenes, another for every step where there are few.
        let plan = scenes::plan(seed, clusters, if clusters > 1 { steps } else { 1 });
        let name = format!("seed {seed} kind {}", seed as usize % scenes::KINDS);
        Trial { name, plan: &plan, backend, steps, mistake, phases: seed % 3 != 0 }.run(&mut tally);
    }
    tally
}

/// Fails where the engine and the witness differ, and where too little could be compared.
#[track_caller]
fn agree(tally: &Tally, collisions: usize) {
    println!("{tally}");
    let shown: String = tally.failures.iter().take(3).cloned().collect();
    assert!(tally.failures.is_empty(), "{} differences\n{shown}", tally.failures.len());
    assert!(tally.undecided * 100 < tally.compared, "too many steps are undecided: {tally}");
    assert!(tally.collisions > collisions && 20 * tally.lone > collisions, "too little happens: {tally}");
}

/// Half of the scenes here, half in the next test, so that they run side by side.
#[test]
fn cpu_agrees() {
    agree(&compare(Backend::Cpu, 0..2_000, 1, 6, None), 3_000);
}

#[test]
fn cpu_agrees_further() {
    agree(&compare(Backend::Cpu, 2_000..4_000, 1, 6, None), 3_000);
}

/// Many clusters in one scene, and more steps.
#[test]
fn cpu_agrees_in_large_scenes() {
    agree(&compare(Backend::Cpu, 5_000..5_020, 34, 12, None), 1_000);
}

/// Scenes that the faults of an older model were found in, and one of everything, from beginning to end.
#[test]
fn cpu_agrees_in_known_scenes() {
    let mut tally = Tally::default();
    for (name, scene) in known::scenes() {
        let regime = scenes::Regime { settings: scene.settings, dt: 0.02 };
        let plan = scenes::Plan { integrator: Integrator::Rk4, regimes: vec![regime], clusters: vec![scene] };
        Trial { name: name.to_owned(), plan: &plan, backend: Backend::Cpu, steps: 150, mistake: None, phases: false }
            .run(&mut tally);
        println!("{name}: {tally}");
    }
    agree(&tally, 100);
}

/// The same on the GPU, where to make kernels is dear, a step less, and a cluster little: RK4 in whole steps.
#[cfg(feature = "gpu")]
#[test]
fn gpu_agrees() {
    agree(&compare(Backend::Gpu, [6_003], 51, 4, None), 30);
}

/// Symplectic Euler by phases.
#[cfg(feature = "gpu")]
#[test]
fn gpu_agrees_by_phases() {
    agree(&compare(Backend::Gpu, [6_001], 51, 4, None), 30);
}

/// What the comparison is worth: a witness that makes a mistake does not agree.
#[test]
fn mistakes_are_told() {
    for mistake in MISTAKES {
        let tally = compare(Backend::Cpu, 0..340, 1, 3, Some(mistake));
        println!("{mistake:?}: {} differences in {tally}", tally.failures.len());
        assert!(!tally.failures.is_empty(), "{mistake:?} is not told");
    }
}

/// As many scenes as there is time for: 20,000 take a minute. In one of some ten thousands, of a network, of heavy beside light, or of rods that have only
/// begun to turn out of parallel, rounding comes to up to three times what is allowed elsewhere.
#[test]
#[ignore = "takes minutes"]
fn cpu_agrees_at_length() {
    for first in (10_000..90_000).step_by(5_000) {
        let tally = compare(Backend::Cpu, first..first + 5_000, 1, 6, None);
        println!("from {first}: {tally}");
        tally.failures.iter().filter_map(|text| text.lines().next()).for_each(|line| println!("  {line}"));
        assert!(tally.worst < 4.0, "{}", tally.failures.concat());
    }
}
