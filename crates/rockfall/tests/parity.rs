//! Stage parity: the CPU code and the kernel of every stage, run on the same random world.
//!
//! The CPU runs a step of a random scene. Each stage of the step is then run alone on both backends, from the world as it was
//! before the stage, and all buffers are compared. The stages that solve collisions are compared as one group, because the CPU
//! does not have the collision lists of the GPU.
//!
//! Counts, offsets, entries and flags must be equal. Floats must agree as closely as rounding of the input allows (see
//! `compare.rs`). A decision is a comparison that selects a branch, such as whether two spheres overlap. No decision of the
//! step lies within 1e-4 of the value at which it changes (see `decisions.rs`).

#![cfg(feature = "gpu")]

#[path = "parity/bodies.rs"]
mod bodies;
#[path = "parity/broken.rs"]
mod broken;
#[path = "parity/cells.rs"]
mod cells;
#[path = "parity/chains.rs"]
mod chains;
#[path = "parity/clusters.rs"]
mod clusters;
#[path = "parity/collide.rs"]
mod collide;
#[path = "parity/compare.rs"]
mod compare;
#[path = "parity/covered.rs"]
mod covered;
#[path = "parity/crossings.rs"]
mod crossings;
#[path = "parity/decisions.rs"]
mod decisions;
#[path = "parity/device.rs"]
mod device;
#[path = "parity/double.rs"]
mod double;
#[path = "parity/formulas.rs"]
mod formulas;
#[path = "parity/keys.rs"]
mod keys;
#[path = "parity/narrow.rs"]
mod narrow;
#[path = "parity/order.rs"]
mod order;
#[path = "parity/passages.rs"]
mod passages;
#[path = "parity/random.rs"]
mod random;
#[path = "parity/repeat.rs"]
mod repeat;
#[path = "parity/residues.rs"]
mod residues;
#[path = "parity/rigid.rs"]
mod rigid;
#[path = "parity/rod_walls.rs"]
mod rod_walls;
#[path = "parity/rules.rs"]
mod rules;
#[path = "parity/servos.rs"]
mod servos;
#[path = "parity/shear.rs"]
mod shear;
#[path = "parity/surfaces.rs"]
mod surfaces;
#[path = "parity/sweeps.rs"]
mod sweeps;
#[path = "parity/tiled.rs"]
mod tiled;
#[path = "parity/trace.rs"]
mod trace;
#[path = "common/verdicts.rs"]
mod verdicts;
#[path = "parity/walls.rs"]
mod walls;
#[path = "parity/whole.rs"]
mod whole;

use std::collections::BTreeMap;

use compare::{MEASURED, differences, listed};
use device::{GPU, on_gpu};
use rockfall::model::layout::{SLICE, WORKGROUP, words_of_rows};
use rockfall::model::status::{REJECTED_NON_FINITE, REJECTED_PAIRS};
use rockfall::{BroadPhase, ContactLaw, Integrator, Settings};
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
        materials: false,
    }
}

/// A plan whose contacts follow a law with history, without impulses.
fn with_law(plan: Plan, contact_law: ContactLaw) -> Plan {
    let settings = plan.settings.with(|settings| {
        settings.contact_law = contact_law;
        settings.collisions = false;
        settings.coulomb_friction = 0.3;
    });
    Plan { settings, materials: true, ..plan }
}

/// Asserts that both backends compute the same from the world of a scenario.
fn assert_scenario_matches(seed: u64, scenario: &Scenario) {
    let Scenario { runs, before } = scenario;
    let gpu = on_gpu(&GPU, before, runs);
    let wrong = differences(runs, before, &gpu, MEASURED);
    assert!(wrong.is_empty(), "seed {seed}, {}: {}", scenario.name(), listed(&wrong));
}

/// Traces a plan and asserts that both backends compute the same in every stage.
fn assert_parity(plan: &Plan) -> Trace {
    let trace = trace(plan);
    // The other stages do not depend on how collisions are solved, and software Vulkan takes long to compile each of them.
    let is_relevant = |scenario: &&Scenario| plan.only == Only::All || scenario.solves_collisions();
    for scenario in trace.scenarios.iter().filter(is_relevant) {
        assert_scenario_matches(plan.seed, scenario);
    }
    trace
}

/// Asserts that the state after the collisions is bitwise identical in every sweep mode (`Step::sweeps`).
fn assert_sweep_modes_agree(trace: &Trace) {
    let solving = trace.scenarios.iter().filter(|scenario| scenario.runs.len() > 1);
    let mut known: Vec<(usize, Vec<u32>)> = Vec::new();
    for Scenario { runs, before } in solving {
        let state = on_gpu(&GPU, before, runs).states[0].clone();
        let bits: Vec<u32> = bytemuck::cast_slice(&state).to_vec();
        match known.iter().find(|(stages, _)| *stages == runs.len()) {
            Some((_, first)) => assert!(*first == bits, "another result in sweep mode {}", before.step.constants.sweeps),
            None => known.push((runs.len(), bits)),
        }
    }
}

/// Asserts that each case in `wanted` occurs in the traces at least once. Parity proves nothing about cases that do not occur.
fn assert_seen(traces: &[Trace], wanted: &[&str]) {
    let mut seen = BTreeMap::new();
    for (what, count) in traces.iter().flat_map(|trace| &trace.findings.seen) {
        *seen.entry(what.as_str()).or_insert(0) += count;
    }
    let missing: Vec<_> = wanted.iter().filter(|what| !seen.contains_key(**what)).collect();
    assert!(missing.is_empty(), "these cases do not occur: {missing:?}; these do: {seen:#?}");
}

/// Cases that must occur in the traces of the RK4 test. The first four must also occur with symplectic Euler.
const CASES: [&str; 50] = [
    "sphere-sphere overlapping",
    "sphere-sphere colliding",
    "sphere-sphere pressing",
    "sphere-sphere not pulling",
    "sphere-sphere fresh",
    "sphere-rod overlapping",
    "sphere-rod colliding",
    "sphere-rod pressing",
    "sphere-rod fresh",
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
    "sphere-polygon face colliding",
    "sphere-polygon face pressing",
    "sphere-polygon edge colliding",
    "sphere-polygon edge pressing",
    "sphere-polygon face leaving",
    "sphere-polygon face fresh",
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
    "clamped at 0",
    "sphere-box face hidden",
    "sphere-box edge hidden",
    "sphere-box vertex hidden",
    "sphere-box inside hidden",
    "sphere-polygon edge hidden",
    "several surfaces",
    "equal distances",
];

#[test]
fn backends_agree_on_every_stage_of_an_rk4_step() {
    let traces: Vec<Trace> = (0..8).map(|seed| assert_parity(&plan(seed, Integrator::Rk4))).collect();
    assert_seen(&traces, &CASES);
    assert_seen(&traces, &["swept once", "swept often", "turned too far"]);
    for trace in &traces {
        let step = &trace.after.step;
        assert!(step.layout.spheres % WORKGROUP != 0 && step.layout.spheres % SLICE != 0, "{step:?}");
        assert!((step.layout.spheres + step.layout.rods) % WORKGROUP != 0, "{step:?}");
        assert!(step.layout.spheres > 3 * WORKGROUP && step.layout.rods > WORKGROUP && step.layout.batches > 2, "{step:?}");
    }
}

#[test]
fn backends_agree_on_every_stage_of_a_symplectic_euler_step() {
    let traces: Vec<Trace> = (10..13).map(|seed| assert_parity(&plan(seed, Integrator::SymplecticEuler))).collect();
    assert_seen(&traces, &CASES[..4]);
}

/// Scenarios include starting forces that are evaluated and those that are known.
#[test]
fn backends_agree_on_every_stage_of_a_velocity_verlet_step() {
    let traces: Vec<Trace> = (14..17).map(|seed| assert_parity(&plan(seed, Integrator::VelocityVerlet))).collect();
    assert_seen(&traces, &CASES[..4]);
}

/// In scenes without rods the integrators also turn the spheres.
#[test]
fn backends_agree_on_every_stage_without_rods() {
    for (seed, integrator) in [(30, Integrator::Rk4), (31, Integrator::SymplecticEuler), (32, Integrator::VelocityVerlet)] {
        let trace = assert_parity(&Plan { rods: false, ..plan(seed, integrator) });
        let changed = |name: &str| {
            // Not the early pass of scenes that several processes share.
            let concerned = |scenario: &&Scenario| scenario.is(name) && scenario.runs[0].applies(&scenario.before.step);
            trace.scenarios.iter().filter(concerned).any(|scenario| {
                let mut after = scenario.before.clone();
                scenario.runs[0].on_cpu(&mut after);
                after.orientations != scenario.before.orientations
            })
        };
        assert!(changed(match integrator {
            Integrator::Rk4 => "finish",
            Integrator::SymplecticEuler => "symplectic_euler",
            _ => "kick",
        }));
        assert!(!changed("turn"), "spheres are turned twice");
    }
}

/// Values other than the defaults, collisions switched off, and contact forces that may pull.
#[test]
fn backends_agree_on_every_stage_under_other_settings() {
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
        // Strong enough that gravity sets the threshold velocity of some contacts (docs/physics section 3.1).
        settings.gravity = 9.81;
    });
    for (seed, settings) in [(20, off), (21, odd)] {
        for integrator in [Integrator::Rk4, Integrator::SymplecticEuler] {
            assert_parity(&Plan { settings, ..plan(seed, integrator) });
        }
    }
}

/// Both kinds of friction impulses, each kind alone, and Coulomb friction with collisions switched off.
#[test]
fn backends_agree_on_every_stage_with_friction_impulses() {
    let both = Settings::default().with(|settings| {
        settings.coulomb_friction = 0.3;
        settings.collision_friction = 0.2;
    });
    let coulomb = both.with(|settings| settings.collision_friction = 0.0);
    let of_collisions = both.with(|settings| settings.coulomb_friction = 0.0);
    let only = coulomb.with(|settings| settings.collisions = false);
    let plans = [(22, both), (23, coulomb), (24, of_collisions), (25, only)];
    let traces = plans.map(|(seed, settings)| assert_parity(&Plan { settings, ..plan(seed, Integrator::SymplecticEuler) }));
    let wanted = [
        "sphere-sphere friction impulse",
        "sphere-rod friction impulse",
        "rod-rod friction impulse",
        "sphere-polygon face friction impulse",
        "rod-box edge friction impulse",
    ];
    assert_seen(&traces, &wanted);
}

/// Restitution and friction of pairs of materials.
#[test]
fn backends_agree_on_every_stage_with_materials() {
    let rough = Settings::default().with(|settings| settings.coulomb_friction = 0.2);
    let plans = [
        Plan { settings: rough, ..plan(60, Integrator::SymplecticEuler) },
        Plan { rods: false, only: Only::Few, ..plan(61, Integrator::SymplecticEuler) },
        plan(62, Integrator::Rk4),
    ];
    let traces = plans.map(|plan| assert_parity(&Plan { materials: true, ..plan }));
    assert_seen(&traces, &["clustered", "lone", "sphere-sphere friction impulse", "rod-rod friction impulse"]);
    assert_sweep_modes_agree(&traces[1]);
}

/// The forces and springs of the contact laws with history. The other stages do not depend on the law.
#[test]
fn backends_agree_on_every_stage_of_laws_with_history() {
    let plans = [
        (70, ContactLaw::Linear, false),
        (71, ContactLaw::HertzMindlin, true),
        (72, ContactLaw::HertzMindlin, false),
        (75, ContactLaw::User, true),
        (76, ContactLaw::User, false),
    ];
    for (seed, contact_law, rods) in plans {
        let trace = trace(&Plan { rods, ..with_law(plan(seed, Integrator::SymplecticEuler), contact_law) });
        for stage in ["loads", "symplectic_euler"] {
            // Not the early pass of scenes that several processes share.
            let concerned = |scenario: &&Scenario| scenario.is(stage) && scenario.runs[0].applies(&scenario.before.step);
            let scenario = trace.scenarios.iter().find(concerned).expect("the stage");
            assert_scenario_matches(seed, scenario);
            let mut after = scenario.before.clone();
            scenario.runs[0].on_cpu(&mut after);
            let changes_springs = after.histories != scenario.before.histories;
            assert_eq!(changes_springs, stage != "symplectic_euler", "{stage}");
        }
    }
}

/// The same with velocity Verlet. The forces at the start of the step leave the springs alone, those at its end advance them.
#[test]
fn backends_agree_on_laws_with_history_and_velocity_verlet() {
    for (seed, contact_law, rods) in [(73, ContactLaw::Linear, false), (75, ContactLaw::HertzMindlin, true)] {
        let trace = trace(&Plan { rods, ..with_law(plan(seed, Integrator::VelocityVerlet), contact_law) });
        let stages = ["rod_loads", "loads", "drift", "kick"];
        let concerned = |scenario: &&Scenario| stages.iter().any(|stage| scenario.is(stage));
        for scenario in trace.scenarios.iter().filter(concerned) {
            let [run] = &scenario.runs[..] else { panic!("one stage") };
            if !run.applies(&scenario.before.step) {
                continue;
            }
            assert_scenario_matches(seed, scenario);
            let mut after = scenario.before.clone();
            run.on_cpu(&mut after);
            let advances = (run.stage.name, run.pass) == ("loads", 3);
            if (run.stage.name, run.pass) == ("rod_loads", 3) {
                continue;
            }
            assert_eq!(after.histories != scenario.before.histories, advances, "{} pass {}", run.stage.name, run.pass);
        }
    }
}

/// Few collisions can be swept by one workgroup or by one dispatch per sweep.
#[test]
fn both_sweep_modes_solve_few_collisions_identically() {
    let traces = [(50, true), (51, false)]
        .map(|(seed, rods)| assert_parity(&Plan { rods, only: Only::Few, ..plan(seed, Integrator::SymplecticEuler) }));
    assert_seen(&traces, &["clustered", "lone", "sphere-rod colliding"]);
    traces.iter().for_each(assert_sweep_modes_agree);
}

/// Collisions that share no bodies can be solved with sweeps, from a list without sweeps, or by each sphere without a list.
#[test]
fn all_sweep_modes_solve_lone_collisions_identically() {
    let both = Settings::default().with(|settings| {
        settings.coulomb_friction = 0.3;
        settings.collision_friction = 0.2;
    });
    let coulomb = both.with(|settings| settings.collision_friction = 0.0);
    let plans = [(40, true, Settings::default()), (41, false, Settings::default()), (42, true, both), (43, false, coulomb)];
    let traces = plans.map(|(seed, rods, settings)| {
        assert_parity(&Plan { rods, only: Only::Lone, settings, ..plan(seed, Integrator::SymplecticEuler) })
    });
    assert_seen(&traces, &["lone", "capsule hit", "at a right angle", "sphere-rod colliding", "sphere-polygon face colliding"]);
    assert!(traces.iter().all(|trace| !trace.findings.seen.contains_key("clustered")));
    traces.iter().for_each(assert_sweep_modes_agree);
}

/// In a rejected step the stages after the broad phase change nothing. When a previous attempt has already done the collisions,
/// the collision stages change nothing.
#[test]
fn backends_agree_on_every_stage_of_a_rejected_step() {
    for integrator in Integrator::ALL {
        for Scenario { runs, mut before } in trace(&plan(4, integrator)).scenarios {
            before.status.rejected = REJECTED_NON_FINITE;
            assert_scenario_matches(4, &Scenario { runs: runs.clone(), before: before.clone() });
            if runs[0].stage.name.ends_with("_collisions") {
                before.status.rejected = 0;
                before.status.collided = 1;
                assert_scenario_matches(4, &Scenario { runs, before });
            }
        }
    }
}

/// Both backends reject the step when the pair lists do not fit, and report the same number of rows that they need.
#[test]
fn both_backends_reject_pair_lists_that_do_not_fit() {
    let scenarios = trace(&plan(3, Integrator::Rk4)).scenarios;
    let scan = scenarios.into_iter().find(|scenario| scenario.is("scan_pairs"));
    let mut scenario = scan.unwrap();
    let needed = {
        let mut world = scenario.before.clone();
        scenario.runs[0].on_cpu(&mut world);
        world.status.pair_rows_needed
    };
    for (rows, rejected) in [(needed - 1, REJECTED_PAIRS), (needed, 0)] {
        let before = &mut scenario.before;
        before.step.layout.pair_rows = rows;
        before.lists.resize(before.step.layout.entries_at as usize + words_of_rows(rows) as usize, 0);
        let gpu = on_gpu(&GPU, &scenario.before, &scenario.runs);
        assert_eq!((gpu.status.rejected, gpu.status.pair_rows_needed), (rejected, needed));
        assert_scenario_matches(4, &scenario);
    }
}
