//! Whole steps of a small scene without rods in one dispatch, of one workgroup: collisions and positions, as often as the
//! pass tells, with barriers in the place of the ends of dispatches.
//!
//! What a dispatch costs on a device, some microseconds whatever it does, is most of a small scene's step. The kernel is
//! made of the parts of the stages that it stands for, so that it does what they do; see `exec/gpu/fuse.rs` for where it takes their place.
//! Status, void steps and replays are theirs.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
#[cfg(feature = "gpu")]
use crate::model::layout::POSITIONS_FIRST;
use crate::model::layout::{ORDER_MASK, PHASES_SHIFT, POSITIONS_ALONE, SYMPLECTIC_EULER};
use crate::model::step::Step;
use crate::model::world::World;
use crate::settings::{BroadPhase, Integrator};
use crate::step::schedule::Phase;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::{Wgsl, part};

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
    cpu: run_steps,
};

/// Up to so many spheres one workgroup is faster than many dispatches: a thread has one of them, where a workgroup has 1,024.
const FEW: u32 = 1024;

/// Whether a world of these counts has room for the stage's states.
pub(crate) fn is_small(step: &Step) -> bool {
    step.rods == 0 && (1..=FEW).contains(&step.spheres)
}

/// Whether the stage may take the place of others in such a world. Long lists want more than a thread each.
#[cfg(feature = "gpu")]
pub(crate) fn suits(step: &Step) -> bool {
    is_small(step) && step.long_at == 0
}

/// The pass of a dispatch of this phase alone: of collisions or of positions.
#[cfg(feature = "gpu")]
pub(crate) fn begun_with(phase: Phase, integrator: Integrator) -> u32 {
    let order = if phase == Phase::HandleCollisions { 0 } else { POSITIONS_FIRST };
    1 << PHASES_SHIFT | order | if integrator == Integrator::Rk4 { 0 } else { SYMPLECTIC_EULER }
}

/// The pass of a dispatch that does this phase after all of `pass`, if there is one.
#[cfg(feature = "gpu")]
pub(crate) fn followed_by(pass: u32, phase: Phase) -> Option<u32> {
    let orders = [pass, pass & !ORDER_MASK | POSITIONS_ALONE];
    let mut longer = orders.into_iter().map(|pass| pass + (1 << PHASES_SHIFT));
    longer.find(|longer| phases(*longer).eq(phases(pass).chain([phase])))
}

/// The phases of a dispatch. They take turns, or there are no collisions.
fn phases(pass: u32) -> impl Iterator<Item = Phase> {
    let order = pass & ORDER_MASK;
    (0..pass >> PHASES_SHIFT).map(move |k| {
        if order != POSITIONS_ALONE && (k + order).is_multiple_of(2) { Phase::HandleCollisions } else { Phase::UpdatePositions }
    })
}

/// The twins of the stages that it stands for.
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
    fn phases_join_where_they_take_turns_or_are_positions_alone() {
        let [collisions, positions] = [Phase::HandleCollisions, Phase::UpdatePositions];
        let joined = |phases: &[Phase], integrator: Integrator| {
            let (first, rest) = phases.split_first()?;
            rest.iter().try_fold(begun_with(*first, integrator), |pass, phase| followed_by(pass, *phase))
        };
        for all in [
            vec![collisions],
            vec![positions],
            vec![collisions, positions, collisions],
            vec![positions, collisions, positions, collisions],
            vec![positions; 5],
        ] {
            for (integrator, leaps) in [(Integrator::Rk4, 0), (Integrator::SymplecticEuler, SYMPLECTIC_EULER)] {
                let pass = joined(&all, integrator);
                assert_eq!(pass.map(|pass| (phases(pass).collect(), pass & SYMPLECTIC_EULER)), Some((all.clone(), leaps)));
            }
        }
        for none in [vec![collisions; 2], vec![positions, positions, collisions], vec![collisions, positions, positions]] {
            assert_eq!(joined(&none, Integrator::Rk4), None);
        }
    }
}
