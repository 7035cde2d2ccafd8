//! Compiles kernels before the first frame, several at a time.

#[cfg(not(target_family = "wasm"))]
use rayon::prelude::*;

use crate::rigid::gpu::RigidGpu;
use crate::rigid::gpu::kernels::{
    ARRANGE, BEFORE_IMPACTS, BUCKET, CALM, CARRY, CARRY_ROUND, CLOSE_JOINTS, COUNT_COLOURS, DRIFT, ENLIST, FIND_ALL_ROUND,
    FIND_ROUND, GATHER, KEEP, KICK, Kinds, LAY, LOAD, OPEN_JOINTS, PULL, PUSH_GROUPS, PUSH_JOINTS, PUSH_JOINTS_AGAIN, RANK,
    RECALL, REFRESH, REFRESH_ROUND, RELAX_GROUPS, RELAX_JOINTS, RELAX_JOINTS_AGAIN, RELIST, SEEK, SEEK_ROUND, SETTLE, SOLVE,
    SPARE_ROUND, STORE, STRIKE, STRIKE_ROUND, SUM_UP, TAKE, WAIT_ROUND, WARM_GROUPS, WARM_JOINTS, WIDEN,
};
use crate::rigid::gpu::search::Content;
use crate::rigid::world::RigidWorld;

/// The stages of every frame, in which the slow ones to compile come first.
const ALWAYS: &[usize] = &[
    SOLVE,
    RECALL,
    GATHER,
    KEEP,
    LAY,
    RANK,
    BUCKET,
    ENLIST,
    TAKE,
    COUNT_COLOURS,
    ARRANGE,
    RELIST,
    DRIFT,
    KICK,
    LOAD,
    SETTLE,
    BEFORE_IMPACTS,
    SUM_UP,
    STORE,
    CALM,
    WIDEN,
];
/// Those of blocks without round pairs.
const SHARP: &[usize] = &[STRIKE, CARRY, SEEK, REFRESH];
/// Those of blocks that may have round pairs.
const ROUND: &[usize] =
    &[FIND_ROUND, FIND_ALL_ROUND, SPARE_ROUND, REFRESH_ROUND, CARRY_ROUND, STRIKE_ROUND, WAIT_ROUND, SEEK_ROUND];
/// Those of joints whose mechanisms fit into workgroups, and of others.
const GROUPED: &[usize] = &[PUSH_GROUPS, RELAX_GROUPS, WARM_GROUPS, OPEN_JOINTS, CLOSE_JOINTS];
const JOINTED: &[usize] =
    &[PUSH_JOINTS, PUSH_JOINTS_AGAIN, RELAX_JOINTS, RELAX_JOINTS_AGAIN, WARM_JOINTS, OPEN_JOINTS, CLOSE_JOINTS];

impl RigidGpu {
    /// Compiles the kernels that frames of a world use. Those of left-over blocks, which few scenes have, are compiled at their first use.
    pub(super) fn prepare(&self, world: &RigidWorld, kinds: Kinds, [is_round, is_grouped]: [bool; 2]) {
        // Software compiles on the processor that the frames need, and tests of mistakes need few kernels.
        if !self.merges || self.mistake.is_some() {
            return;
        }
        let content = Content::of(world);
        let of = |uses: bool, stages: &'static [usize]| if uses { stages } else { &[] };
        let stages = [
            of(is_round, ROUND),
            of(!world.joints.is_empty(), if is_grouped { GROUPED } else { JOINTED }),
            of(!is_round, SHARP),
            ALWAYS,
            of(!world.springs.list.is_empty(), &[PULL]),
        ]
        .concat();
        // A device of a browser belongs to one thread, and compiles at the first use.
        #[cfg(not(target_family = "wasm"))]
        rayon::join(
            || {
                stages.par_iter().with_max_len(1).for_each(|stage| {
                    self.kernel(*stage, kinds);
                });
            },
            || content.stages().into_par_iter().with_max_len(1).for_each(|number| drop(self.search_kernel(number, content))),
        );
        #[cfg(target_family = "wasm")]
        drop((content, stages));
    }
}
