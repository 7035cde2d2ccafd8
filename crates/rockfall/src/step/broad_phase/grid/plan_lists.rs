//! Decides, in large scenes, how many workgroups the stages that build lists have in this step: 0 if the lists still hold.
//!
//! Launching hundreds of thousands of workgroups that exit at once can cost more than the stage itself. The device reads
//! these numbers itself (indirect dispatch), so that the host need not know them.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::SIZE_WORDS;
use crate::model::part::part;
use crate::model::status::REBUILD_REQUESTED;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "plan_lists",
    wgsl: Wgsl::File(part!("step/broad_phase/grid/plan_lists.wgsl")),
    bindings: &[write("dispatch_sizes", Buffer::DispatchSizes), read("status", Buffer::Status)],
    threads: Threads::One,
    moves: |_| NONE,
    cpu: plan_lists,
};

fn plan_lists(world: &mut World, _pass: u32) {
    let is_due = world.status.builds_lists(REBUILD_REQUESTED);
    let (present, all) = world.dispatch_sizes.split_at_mut(SIZE_WORDS as usize);
    if is_due {
        present.copy_from_slice(all);
    } else {
        present.fill(0);
    }
}
