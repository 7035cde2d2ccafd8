//! Stage parity: the CPU twin and the kernel of every stage, from the same random world.
//!
//! A random step is run on the CPU; each of its stages is then run alone on both backends, from the world that it began
//! with, and all buffers are compared. Counts, offsets, entries and flags must be equal, floats as close as the rounding
//! of the input allows (see `compare.rs`). No decision of the step lies within 1e-4 of its switch (`decisions.rs`).

#![cfg(feature = "gpu")]

#[path = "parity/bodies.rs"]
mod bodies;
#[path = "parity/broken.rs"]
mod broken;
#[path = "parity/cells.rs"]
mod cells;
#[path = "parity/clusters.rs"]
mod clusters;
#[path = "parity/compare.rs"]
mod compare;
#[path = "parity/decisions.rs"]
mod decisions;
#[path = "parity/device.rs"]
mod device;
#[path = "parity/formulas.rs"]
mod formulas;
#[path = "parity/narrow.rs"]
mod narrow;
#[path = "parity/order.rs"]
mod order;
#[path = "parity/random.rs"]
mod random;
#[path = "parity/rules.rs"]
mod rules;
#[path = "parity/sweeps.rs"]
mod sweeps;
#[path = "parity/trace.rs"]
mod trace;
#[path = "parity/whole.rs"]
mod whole;

use std::collections::BTreeMap;

use compare::{MEASURED, differences, listed};
use device::{GPU, on_gpu};
use rockfall::layout::{SLICE, VOID_NON_FINITE, VOID_PAIRS, WORKGROUP, words_of};
use rockfall::{BroadPhase, Integrator, Settings};
use trace::{Plan, Scenario, Trace, trace};

fn plan(seed: u64, integrator: Integrator) -> Plan {
    Plan {
        seed,
        clusters: 56 + seed as usize,
        integrator,
        broad_phase: [BroadPhase::BruteForce, BroadPhase::Grid, BroadPhase::SortAndSkip][seed as usize % 3],
        settings: Settings::default(),
        rods: true,
    }
}

/// Fails where the backends make different things of a stage.
fn compare(seed: u64, Scenario { run, before }: &Scenario) {
    let gpu = on_gpu(&GPU, before, *run);
    let wrong = differences(run, before, &gpu, MEASURED);
    let (stage, pass) = (run.stage.name, run.pass);
    assert!(wrong.is_empty(), "seed {seed}, {stage} pass {pass}: {}", listed(&wrong));
}

/// A trace whose every stage is the same on both backends.
fn compared(plan: &Plan) -> Trace {
    let trace = trace(plan);
    for scenario in &trace.scenarios {
        compare(plan.seed, scenario);
    }
    trace
}

/// Fails unless the traces decided each of `wanted` at least once: parity over nothing proves nothing.
fn assert_seen(traces: &[Trace], wanted: &[&str]) {
    let mut seen = BTreeMap::new();
    for (what, count) in traces.iter().flat_map(|trace| &trace.findings.seen) {
        *seen.entry(what.as_str()).or_insert(0) += count;
    }
    let missing: Vec<_> = wanted.iter().filter(|what| !seen.contains_key(**what)).collect();
    assert!(missing.is_empty(), "never seen: {missing:?} in {seen:#?}");
}

const CONTACTS: [&str; 34] = [
    "sphere-sphere overlapping",
    "sphere-sphere colliding",
    "sphere-sphere pressing",
    "sphere-sphere not pulling",
    "sphere-sphere unseen",
    "sphere-rod overlapping",
    "sphere-rod colliding",
    "sphere-rod pressing",
    "sphere-rod not pulling",
    "sphere-rod unseen",
    "rod-rod overlapping",
    "rod-rod colliding",
    "rod-rod pressing",
    "rod-box edge not pulling",
    "rod-rod parallel pressing",
    "sphere-box face colliding",
    "sphere-box face pressing",
    "sphere-box edge colliding",
    "sphere-box edge pressing",
    "sphere-box vertex colliding",
    "sphere-box vertex pressing",
    "sphere-box inside colliding",
    "sphere-box inside pressing",
    "sphere-polygon colliding",
    "sphere-polygon pressing",
    "sphere-polygon leaving",
    "sphere-polygon unseen",
    "rod-box edge colliding",
    "rod-box edge pressing",
    "rod-box edge inside colliding",
    "rod-box edge inside pressing",
    "rod-box vertex colliding",
    "rod-box vertex pressing",
    "alone",
];

#[test]
fn every_stage_of_a_step_with_rk4() {
    let traces: Vec<Trace> = (0..8).map(|seed| compared(&plan(seed, Integrator::Rk4))).collect();
    assert_seen(&traces, &CONTACTS);
    assert_seen(&traces, &["pressed", "swept once", "swept often", "turned too far"]);
    for trace in &traces {
        let step = &trace.after.step;
        assert!(step.spheres % WORKGROUP != 0 && step.spheres % SLICE != 0, "{step:?}");
        assert!((step.spheres + step.rods) % WORKGROUP != 0, "{step:?}");
        assert!(step.spheres > 3 * WORKGROUP && step.rods > WORKGROUP && step.batches > 2, "{step:?}");
    }
}

#[test]
fn every_stage_of_a_step_with_symplectic_euler() {
    let traces: Vec<Trace> = (10..13).map(|seed| compared(&plan(seed, Integrator::SymplecticEuler))).collect();
    assert_seen(&traces, &CONTACTS[..4]);
}

/// The stages that do what two others do in scenes with rods.
#[test]
fn every_stage_without_rods() {
    for (seed, integrator) in [(30, Integrator::Rk4), (31, Integrator::SymplecticEuler)] {
        let trace = compared(&Plan { rods: false, ..plan(seed, integrator) });
        let changed = |name: &str| {
            let scenario = trace.scenarios.iter().find(|scenario| scenario.run.stage.name == name).expect(name);
            let mut after = scenario.before.clone();
            scenario.run.on_cpu(&mut after);
            after.orientations != scenario.before.orientations
        };
        assert!(changed(if integrator == Integrator::Rk4 { "finish_and_turn" } else { "commit_and_turn" }));
        assert!(!changed("turn"), "spheres turned twice");
    }
}

/// Constants off their defaults, collisions off, pulling damping.
#[test]
fn every_stage_under_other_settings() {
    let off = Settings {
        collisions: false,
        contact_pull: true,
        gravity: 9.81,
        gravity_direction: glam::Vec3::new(0.6, 0.0, 0.8),
        ..Settings::default()
    };
    let odd = Settings {
        activation_threshold: 0.3,
        restitution: 0.2,
        contact_damping: 30.0,
        contact_force: 400.0,
        friction: 20.0,
        // Reached at a sliding velocity of 1: some rub by the one law, some by the other.
        coulomb_friction: 0.05,
        ..Settings::default()
    };
    for (seed, settings) in [(20, off), (21, odd)] {
        for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
            compared(&Plan { settings, ..plan(seed, integrator) });
        }
    }
}

/// In a void step the stages after the broad phase leave everything as it is; so they do after collisions that are done.
#[test]
fn every_stage_of_a_void_step() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        for Scenario { run, before } in trace(&plan(4, integrator)).scenarios {
            let mut before = before;
            before.status.void = VOID_NON_FINITE;
            compare(4, &Scenario { run, before: before.clone() });
            if run.stage.name.ends_with("_collisions") {
                before.status.void = 0;
                before.status.collided = 1;
                compare(4, &Scenario { run, before });
            }
        }
    }
}

/// Lists that do not fit void the step on both, and tell the same need.
#[test]
fn lists_that_do_not_fit() {
    let scenarios = trace(&plan(3, Integrator::Rk4)).scenarios;
    let scan = scenarios.into_iter().find(|scenario| scenario.run.stage.name == "scan_pairs");
    let mut scenario = scan.unwrap();
    let needed = {
        let mut world = scenario.before.clone();
        scenario.run.on_cpu(&mut world);
        world.status.pair_rows_needed
    };
    for (rows, void) in [(needed - 1, VOID_PAIRS), (needed, 0)] {
        let before = &mut scenario.before;
        before.step.pair_rows = rows;
        before.lists.resize(before.step.entries_at as usize + words_of(rows) as usize, 0);
        let gpu = on_gpu(&GPU, &scenario.before, scenario.run);
        assert_eq!((gpu.status.void, gpu.status.pair_rows_needed), (void, needed));
        compare(4, &scenario);
    }
}
