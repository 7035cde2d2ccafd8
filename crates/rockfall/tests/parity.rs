//! Stage parity: the CPU twin and the kernel of every stage, from the same random world.
//!
//! A random step is run on the CPU; each of its stages is then run alone on both backends, from the world that it began
//! with, and all buffers are compared. The stages that solve collisions are compared together, for what the GPU lists the CPU
//! does not have. Counts, offsets, entries and flags must be equal, floats as close as the rounding
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
#[path = "parity/collide.rs"]
mod collide;
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
use rockfall::model::layout::{SLICE, WORKGROUP, words_of_rows};
use rockfall::model::status::{REJECTED_NON_FINITE, REJECTED_PAIRS};
use rockfall::{BroadPhase, Integrator, Settings};
use trace::{Only, Plan, Scenario, Trace, trace};

fn plan(seed: u64, integrator: Integrator) -> Plan {
    Plan {
        seed,
        clusters: 56 + seed as usize,
        integrator,
        broad_phase: [BroadPhase::BruteForce, BroadPhase::Grid, BroadPhase::SortAndSkip][seed as usize % 3],
        settings: Settings::default(),
        rods: true,
        only: Only::All,
    }
}

/// Fails where the backends make different things of a stage.
fn compare(seed: u64, scenario: &Scenario) {
    let Scenario { runs, before } = scenario;
    let gpu = on_gpu(&GPU, before, runs);
    let wrong = differences(runs, before, &gpu, MEASURED);
    assert!(wrong.is_empty(), "seed {seed}, {}: {}", scenario.name(), listed(&wrong));
}

/// A trace whose every stage is the same on both backends.
fn compared(plan: &Plan) -> Trace {
    let trace = trace(plan);
    // The other stages know nothing of how collisions are solved, and software Vulkan takes long to compile each.
    let is_meant = |scenario: &&Scenario| plan.only == Only::All || scenario.is_of_collisions();
    for scenario in trace.scenarios.iter().filter(is_meant) {
        compare(plan.seed, scenario);
    }
    trace
}

/// Fails where a way to solve collisions gives other bits than another one.
fn same_in_every_way(trace: &Trace) {
    let solving = trace.scenarios.iter().filter(|scenario| scenario.runs[0].stage.name == "list_collisions");
    let mut known: Vec<(usize, Vec<u32>)> = Vec::new();
    for Scenario { runs, before } in solving {
        let state = on_gpu(&GPU, before, runs).states[0].clone();
        let bits: Vec<u32> = bytemuck::cast_slice(&state).to_vec();
        match known.iter().find(|(stages, _)| *stages == runs.len()) {
            Some((_, first)) => assert!(*first == bits, "sweeps {}", before.step.sweeps),
            None => known.push((runs.len(), bits)),
        }
    }
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

const CONTACTS: [&str; 41] = [
    "sphere-sphere overlapping",
    "sphere-sphere colliding",
    "sphere-sphere pressing",
    "sphere-sphere not pulling",
    "sphere-sphere unseen",
    "sphere-rod overlapping",
    "sphere-rod colliding",
    "sphere-rod pressing",
    "sphere-rod unseen",
    "rod-rod overlapping",
    "rod-rod colliding",
    "rod-rod pressing",
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
    "sphere-sphere leaving",
    "lone",
    "pressed",
    "clustered",
    "on a network",
    "capsule hit",
    "at a right angle",
    "at its time",
    "longer than the step",
    "held at 0",
];

#[test]
fn every_stage_of_a_step_with_rk4() {
    let traces: Vec<Trace> = (0..8).map(|seed| compared(&plan(seed, Integrator::Rk4))).collect();
    assert_seen(&traces, &CONTACTS);
    assert_seen(&traces, &["swept once", "swept often", "turned too far"]);
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
            let scenario = trace.scenarios.iter().find(|scenario| scenario.is(name)).expect(name);
            let mut after = scenario.before.clone();
            scenario.runs[0].on_cpu(&mut after);
            after.orientations != scenario.before.orientations
        };
        assert!(changed(if integrator == Integrator::Rk4 { "finish_and_turn" } else { "commit_and_turn" }));
        assert!(!changed("turn"), "spheres turned twice");
    }
}

/// Constants off their defaults, collisions off, pulling damping.
#[test]
fn every_stage_under_other_settings() {
    let off = Settings::default().with(|settings| {
        settings.collisions = false;
        settings.contact_pull = true;
        settings.gravity = 9.81;
        settings.gravity_direction = glam::Vec3::new(0.6, 0.0, 0.8);
        settings.linear_damping = 2.0;
        settings.angular_damping = 3.0;
    });
    let odd = Settings::default().with(|settings| {
        settings.activation_threshold = 0.3;
        settings.restitution = 0.2;
        settings.contact_damping = 30.0;
        settings.contact_force = 400.0;
        settings.friction = 20.0;
        // So that it decides of some what collides.
        settings.gravity = 9.81;
    });
    for (seed, settings) in [(20, off), (21, odd)] {
        for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
            compared(&Plan { settings, ..plan(seed, integrator) });
        }
    }
}

/// Friction impulses, of collisions and of contacts that press, of either alone, and without collisions.
#[test]
fn every_stage_with_friction_impulses() {
    let both = Settings::default().with(|settings| {
        settings.coulomb_friction = 0.3;
        settings.collision_friction = 0.2;
    });
    let coulomb = both.with(|settings| settings.collision_friction = 0.0);
    let of_collisions = both.with(|settings| settings.coulomb_friction = 0.0);
    let only = coulomb.with(|settings| settings.collisions = false);
    let plans = [(22, both), (23, coulomb), (24, of_collisions), (25, only)];
    let traces = plans.map(|(seed, settings)| compared(&Plan { settings, ..plan(seed, Integrator::SymplecticEuler) }));
    let seen =
        ["sphere-sphere rubbing", "sphere-rod rubbing", "rod-rod rubbing", "sphere-polygon rubbing", "rod-box edge rubbing"];
    assert_seen(&traces, &seen);
}

/// Collisions that one workgroup can sweep over, by one and by many.
#[test]
fn few_collisions_in_both_ways() {
    let traces = [(50, true), (51, false)]
        .map(|(seed, rods)| compared(&Plan { rods, only: Only::Few, ..plan(seed, Integrator::SymplecticEuler) }));
    assert_seen(&traces, &["clustered", "lone", "sphere-rod colliding"]);
    traces.iter().for_each(same_in_every_way);
}

/// Collisions that share no bodies: with sweeps that have nothing to do, listed, and by every sphere itself.
#[test]
fn lone_collisions_in_every_way() {
    let both = Settings::default().with(|settings| {
        settings.coulomb_friction = 0.3;
        settings.collision_friction = 0.2;
    });
    let coulomb = both.with(|settings| settings.collision_friction = 0.0);
    let plans = [(40, true, Settings::default()), (41, false, Settings::default()), (42, true, both), (43, false, coulomb)];
    let traces = plans.map(|(seed, rods, settings)| {
        compared(&Plan { rods, only: Only::Lone, settings, ..plan(seed, Integrator::SymplecticEuler) })
    });
    assert_seen(&traces, &["lone", "capsule hit", "at a right angle", "sphere-rod colliding", "sphere-polygon colliding"]);
    assert!(traces.iter().all(|trace| !trace.findings.seen.contains_key("clustered")));
    traces.iter().for_each(same_in_every_way);
}

/// In a void step the stages after the broad phase leave everything as it is; so they do after collisions that are done.
#[test]
fn every_stage_of_a_void_step() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
        for Scenario { runs, mut before } in trace(&plan(4, integrator)).scenarios {
            before.status.rejected = REJECTED_NON_FINITE;
            compare(4, &Scenario { runs: runs.clone(), before: before.clone() });
            if runs[0].stage.name.ends_with("_collisions") {
                before.status.rejected = 0;
                before.status.collided = 1;
                compare(4, &Scenario { runs, before });
            }
        }
    }
}

/// Lists that do not fit void the step on both, and tell the same need.
#[test]
fn lists_that_do_not_fit() {
    let scenarios = trace(&plan(3, Integrator::Rk4)).scenarios;
    let scan = scenarios.into_iter().find(|scenario| scenario.is("scan_pairs"));
    let mut scenario = scan.unwrap();
    let needed = {
        let mut world = scenario.before.clone();
        scenario.runs[0].on_cpu(&mut world);
        world.status.pair_rows_needed
    };
    for (rows, void) in [(needed - 1, REJECTED_PAIRS), (needed, 0)] {
        let before = &mut scenario.before;
        before.step.pair_rows = rows;
        before.lists.resize(before.step.entries_at as usize + words_of_rows(rows) as usize, 0);
        let gpu = on_gpu(&GPU, &scenario.before, &scenario.runs);
        assert_eq!((gpu.status.rejected, gpu.status.pair_rows_needed), (void, needed));
        compare(4, &scenario);
    }
}
