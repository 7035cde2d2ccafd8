//! Joins the dispatches of a batch of steps of a small scene into fewer dispatches.

use std::ops::Range;

use crate::model::step::Step;
use crate::settings::{BroadPhase, Integrator};
use crate::step::fused::run_steps::{STAGE as RUN_STEPS, extended_by, pass_of_phase};
use crate::step::integrate::symplectic_euler;
use crate::step::schedule::{Phase, Run, When};

/// Returns the dispatches for `steps`, in order. `run_steps` replaces all phases except those that build lists.
pub(crate) fn fused(runs: &[Run], step: &Step, steps: Range<u32>) -> Vec<Run> {
    let live = |run: &&Run| run.workgroups(step) > 0;
    let all: Vec<Run> = steps.flat_map(|at| runs.iter().filter(move |run| run.is_in(at)).filter(live)).copied().collect();
    let is_symplectic = all.iter().any(|run| run.stage.is(&symplectic_euler::STAGE));
    let integrator = if is_symplectic { Integrator::SymplecticEuler } else { Integrator::Rk4 };
    let phases = [Phase::HandleCollisions, Phase::UpdatePositions].map(|phase| {
        let stages = phase.stages(integrator, BroadPhase::BruteForce);
        (phase, stages.iter().filter(live).map(name).collect::<Vec<_>>())
    });
    let mut dispatches: Vec<Run> = Vec::new();
    let mut rest = &all[..];
    while let Some((first, others)) = rest.split_first() {
        let begun = phases.iter().find(|(_, stages)| rest.iter().map(name).take(stages.len()).eq(stages.iter().copied()));
        let Some((phase, stages)) = begun else {
            dispatches.push(*first);
            rest = others;
            continue;
        };
        let last = dispatches.last_mut().filter(|run| run.stage.is(&RUN_STEPS));
        if let Some((run, pass)) = last.and_then(|run| extended_by(run.pass, *phase).map(|pass| (run, pass))) {
            run.pass = pass;
        } else {
            let pass = pass_of_phase(*phase, integrator);
            dispatches.push(Run { stage: &RUN_STEPS, pass, when: When::NoRods, every: 1, planned: false });
        }
        rest = &rest[stages.len()..];
    }
    dispatches
}

fn name(run: &Run) -> (&'static str, u32) {
    (run.stage.name, run.pass)
}
