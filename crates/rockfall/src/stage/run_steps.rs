//! Whole steps of a small scene without rods in one dispatch, of one workgroup: collisions and positions (RK4), as often as the
//! pass tells, with barriers in the place of the ends of dispatches.
//!
//! What a dispatch costs on a device, some microseconds whatever it does, is most of a small scene's step. The kernel is
//! made of the parts of the stages that it stands for, so that it does what they do; see `gpu/fuse.rs` for where it takes their place.
//! Status, void steps and replays are theirs.

use crate::layout::{PHASES_SHIFT, POSITIONS_ALONE, POSITIONS_FIRST, Step};
use crate::settings::{BroadPhase, Integrator};
use crate::stage::{Buffer, Phase, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "run_steps",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/order.wgsl"),
        part!("wgsl/four_states.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/geometry.wgsl"),
        part!("wgsl/contact.wgsl"),
        part!("wgsl/rows.wgsl"),
        part!("wgsl/collision.wgsl"),
        part!("wgsl/plain.wgsl"),
        part!("wgsl/weights.wgsl"),
        part!("wgsl/travel.wgsl"),
        part!("wgsl/margin.wgsl"),
        part!("wgsl/tell.wgsl"),
        part!("wgsl/judge.wgsl"),
        part!("wgsl/changes.wgsl"),
        part!("wgsl/collided.wgsl"),
        part!("wgsl/forces.wgsl"),
        part!("wgsl/next_state.wgsl"),
        part!("wgsl/finished.wgsl"),
        part!("wgsl/rotation.wgsl"),
        part!("wgsl/close_step.wgsl"),
        part!("stage/run_steps.wgsl"),
    ],
    bindings: &[
        write("start", Buffer::Start),
        write("state", Buffer::States),
        read("words", Buffer::Words),
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

/// Whether the stage may take the place of others in a world of these counts.
pub(crate) fn suits(step: &Step) -> bool {
    step.rods == 0 && (1..=FEW).contains(&step.spheres)
}

/// The pass of a dispatch of this phase alone: of collisions or of positions.
pub(crate) fn begun_with(phase: Phase) -> u32 {
    1 << PHASES_SHIFT | if phase == Phase::HandleCollisions { 0 } else { POSITIONS_FIRST }
}

/// The pass of a dispatch that does this phase after all of `pass`, if there is one.
pub(crate) fn followed_by(pass: u32, phase: Phase) -> Option<u32> {
    let count = pass >> PHASES_SHIFT;
    let orders = [pass & ((1 << PHASES_SHIFT) - 1), POSITIONS_ALONE];
    let longer = orders.map(|order| (count + 1) << PHASES_SHIFT | order);
    longer.into_iter().find(|longer| phases(*longer).eq(phases(pass).chain([phase])))
}

/// The phases of a dispatch. They take turns, or there are no collisions.
fn phases(pass: u32) -> impl Iterator<Item = Phase> {
    let order = pass & ((1 << PHASES_SHIFT) - 1);
    (0..pass >> PHASES_SHIFT).map(move |k| {
        if order != POSITIONS_ALONE && (k + order).is_multiple_of(2) { Phase::HandleCollisions } else { Phase::UpdatePositions }
    })
}

/// The twins of the stages that it stands for.
fn run_steps(world: &mut World, pass: u32) {
    for run in phases(pass).flat_map(|phase| phase.stages(Integrator::Rk4, BroadPhase::BruteForce)) {
        run.on_cpu(world);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_join_where_they_take_turns_or_are_positions_alone() {
        let [collisions, positions] = [Phase::HandleCollisions, Phase::UpdatePositions];
        let joined = |phases: &[Phase]| {
            let (first, rest) = phases.split_first()?;
            rest.iter().try_fold(begun_with(*first), |pass, phase| followed_by(pass, *phase))
        };
        for all in [
            vec![collisions],
            vec![positions],
            vec![collisions, positions, collisions],
            vec![positions, collisions, positions, collisions],
            vec![positions; 5],
        ] {
            assert_eq!(joined(&all).map(|pass| phases(pass).collect()), Some(all));
        }
        for none in [vec![collisions; 2], vec![positions, positions, collisions], vec![collisions, positions, positions]] {
            assert_eq!(joined(&none), None);
        }
    }
}
