//! Runs whole steps of a small scene without rods in one dispatch of one workgroup.
//!
//! The dispatch runs phases of collisions and of positions, as many as the pass says. Barriers replace the ends of the
//! dispatches of single stages.
//!
//! A dispatch costs some microseconds whatever it does, which is most of the time of a step in a small scene. The kernel is
//! made of the same files as the stages that it replaces, so that it computes the same. `exec/gpu/fuse.rs` decides where it
//! replaces them. The status, rejected steps and repeated steps work as in those stages.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
#[cfg(feature = "gpu")]
use crate::model::layout::POSITIONS_FIRST;
#[cfg(feature = "gpu")]
use crate::model::layout::{FLAG_CONTINUOUS, LAW_THESIS};
use crate::model::layout::{ORDER_MASK, PHASES_SHIFT, POSITIONS_ALONE, SYMPLECTIC_EULER};
use crate::model::part::part;
use crate::model::step::Step;
use crate::model::world::World;
use crate::settings::{BroadPhase, Integrator};
use crate::step::moves::NONE;
use crate::step::schedule::Phase;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "run_steps",
    wgsl: Wgsl::File(part!("step/fused/run_steps.wgsl")),
    bindings: &[
        write("start", Buffer::Start),
        write("state", Buffer::States),
        read("topology", Buffer::Topology),
        write("lists", Buffer::Lists),
        read("aabbs", Buffer::Aabbs),
        write("orientations", Buffer::Orientations),
        write("status", Buffer::Status),
    ],
    threads: Threads::One,
    // The stage replaces others, and its time is not measured.
    moves: |_| NONE,
    cpu: run_steps,
};

/// The most spheres of a small scene. With that many, a workgroup of 1,024 threads has one sphere per thread.
const MAX_SPHERES: u32 = 1024;
/// The most spheres for which one workgroup is at least as fast as many dispatches. With 1,000 spheres it takes a quarter longer
/// (docs/performance.md, small scenes in one dispatch).
#[cfg(feature = "gpu")]
const MAX_FUSED_SPHERES: u32 = 512;

/// Returns whether a scene with these counts is small: it has the buffer of stage states that the stage needs, and its steps are
/// submitted in long portions.
pub(crate) fn is_small(step: &Step) -> bool {
    step.rods == 0 && (1..=MAX_SPHERES).contains(&step.spheres)
}

/// Returns whether the stage may replace other stages in a scene with these counts. It cannot where there may be long movers,
/// because each of them needs more than one thread, and not with a contact law that has
/// stages of its own, or where contacts within a step are handled, which has stages of its own too.
#[cfg(feature = "gpu")]
pub(crate) fn can_fuse(step: &Step) -> bool {
    is_small(step)
        && step.spheres <= MAX_FUSED_SPHERES
        && step.long_at == 0
        && step.law == LAW_THESIS
        && step.flags & FLAG_CONTINUOUS == 0
}

/// Returns the pass of a dispatch that runs only this phase, either that of collisions or that of positions.
#[cfg(feature = "gpu")]
pub(crate) fn pass_of_phase(phase: Phase, integrator: Integrator) -> u32 {
    let order = if phase == Phase::HandleCollisions { 0 } else { POSITIONS_FIRST };
    1 << PHASES_SHIFT | order | if integrator == Integrator::Rk4 { 0 } else { SYMPLECTIC_EULER }
}

/// Returns the pass of a dispatch that runs all phases of `pass` and then this phase, or `None` if there is no such pass.
#[cfg(feature = "gpu")]
pub(crate) fn extended_by(pass: u32, phase: Phase) -> Option<u32> {
    let orders = [pass, pass & !ORDER_MASK | POSITIONS_ALONE];
    let mut longer = orders.into_iter().map(|pass| pass + (1 << PHASES_SHIFT));
    longer.find(|longer| phases(*longer).eq(phases(pass).chain([phase])))
}

/// Returns the phases of a dispatch. Collisions and positions alternate, or all phases are positions.
fn phases(pass: u32) -> impl Iterator<Item = Phase> {
    let order = pass & ORDER_MASK;
    (0..pass >> PHASES_SHIFT).map(move |k| {
        if order != POSITIONS_ALONE && (k + order).is_multiple_of(2) { Phase::HandleCollisions } else { Phase::UpdatePositions }
    })
}

/// Runs the CPU twins of the stages that the kernel replaces.
fn run_steps(world: &mut World, pass: u32) {
    let integrator = if pass & SYMPLECTIC_EULER == 0 { Integrator::Rk4 } else { Integrator::SymplecticEuler };
    for run in phases(pass).flat_map(|phase| phase.stages(integrator, BroadPhase::BruteForce)) {
        run.on_cpu(world);
    }
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use super::*;

    #[test]
    fn phases_join_if_they_alternate_or_are_all_positions() {
        let [collisions, positions] = [Phase::HandleCollisions, Phase::UpdatePositions];
        let joined = |phases: &[Phase], integrator: Integrator| {
            let (first, rest) = phases.split_first()?;
            rest.iter().try_fold(pass_of_phase(*first, integrator), |pass, phase| extended_by(pass, *phase))
        };
        for all in [
            vec![collisions],
            vec![positions],
            vec![collisions, positions, collisions],
            vec![positions, collisions, positions, collisions],
            vec![positions; 5],
        ] {
            for (integrator, bit) in [(Integrator::Rk4, 0), (Integrator::SymplecticEuler, SYMPLECTIC_EULER)] {
                let pass = joined(&all, integrator);
                assert_eq!(pass.map(|pass| (phases(pass).collect(), pass & SYMPLECTIC_EULER)), Some((all.clone(), bit)));
            }
        }
        for none in [vec![collisions; 2], vec![positions, positions, collisions], vec![collisions, positions, positions]] {
            assert_eq!(joined(&none, Integrator::Rk4), None);
        }
    }
}
