//! Stage parity: the CPU twin and the kernel of every stage, from the same random world.
//!
//! A random step is run on the CPU; each of its stages is then run alone on both backends, from the world that it began
//! with, and all buffers are compared. Counts, offsets, entries and flags must be equal, floats as close as the rounding
//! of the input allows (see `compare.rs`). No decision of the step lies within 1e-4 of its switch (`decisions.rs`).

#![cfg(feature = "gpu")]

#[path = "parity/bodies.rs"]
mod bodies;
#[path = "parity/compare.rs"]
mod compare;
#[path = "parity/decisions.rs"]
mod decisions;
#[path = "parity/device.rs"]
mod device;
#[path = "parity/narrow.rs"]
mod narrow;
#[path = "parity/random.rs"]
mod random;
#[path = "parity/sweeps.rs"]
mod sweeps;
#[path = "parity/trace.rs"]
mod trace;

use std::collections::BTreeMap;

use compare::differences;
use device::{GPU, on_gpu};
use rockfall::{Integrator, Settings};
use trace::{Plan, Trace, trace};

/// A trace whose every stage is the same on both backends.
fn compared(plan: &Plan) -> Trace {
    let trace = trace(plan);
    for scenario in &trace.scenarios {
        let run = scenario.run;
        let gpu = on_gpu(&GPU, &scenario.before, run);
        let wrong = differences(&run, &scenario.before, &gpu);
        let shown: Vec<_> = wrong.iter().take(12).collect();
        assert!(
            wrong.is_empty(),
            "seed {}, {} pass {}: {} differences: {shown:#?}",
            plan.seed,
            run.stage.name,
            run.pass,
            wrong.len()
        );
    }
    trace
}

fn plan(seed: u64, integrator: Integrator) -> Plan {
    Plan {
        seed,
        clusters: 50 + seed as usize,
        integrator,
        settings: Settings::default(),
    }
}

/// What a set of traces decided; each of `wanted` at least once.
fn assert_seen(traces: &[Trace], wanted: &[&str]) {
    let mut seen = BTreeMap::new();
    for (what, count) in traces.iter().flat_map(|trace| &trace.findings.seen) {
        *seen.entry(what.as_str()).or_insert(0) += count;
    }
    println!("{seen:#?}");
    let missing: Vec<_> = wanted.iter().filter(|what| !seen.contains_key(**what)).collect();
    assert!(missing.is_empty(), "never seen: {missing:?} in {seen:#?}");
}

#[test]
fn every_stage_of_a_step_with_rk4() {
    let traces: Vec<Trace> = (0..6).map(|seed| compared(&plan(seed, Integrator::Rk4))).collect();
    assert_seen(&traces, &["alone", "pressed"]);
}
