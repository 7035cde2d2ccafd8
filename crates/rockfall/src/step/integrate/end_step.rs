//! Closes the step. Moves the counters to the `last_*` fields, adds them to the totals, clears `collided` and `lengths_due`,
//! and exchanges the two tables of springs, so that the next step begins with the springs that this step ended with. If the
//! state of a body stopped being finite, the steps after this one are rejected unless `FLAG_CONTINUE` is set.
//!
//! In a rejected step, it only returns the blocks of springs to the pool. If the step was rejected because a body left its AABB and
//! lists were built after that, the next step repeats it.

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::FLAG_CONTINUE;
use crate::model::part::part;
use crate::model::status::{Counters, NO_BODY, REBUILD_DONE, REJECTED_BEFORE, REJECTED_NON_FINITE, Status};
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "end_step",
    wgsl: Wgsl::File(part!("step/integrate/end_step.wgsl")),
    bindings: &[write("status", Buffer::Status)],
    threads: Threads::One,
    moves: |_| NONE,
    cpu: end_step,
};

pub(crate) fn end_step(world: &mut World, _pass: u32) {
    let status = &mut world.status;
    let blocks = std::mem::take(&mut status.history_blocks);
    if blocks > world.step.layout.history_pool {
        status.history_needed = blocks;
    }
    if status.may_repeat() && status.rebuild == REBUILD_DONE {
        *status = Status {
            rebuild: 0,
            builds: status.builds + 1,
            repeats: status.repeats + 1,
            repeated: 1,
            repeat_escape: status.escape_ratio,
            ..status.repeating()
        };
        return;
    }
    if status.rejected != 0 {
        status.rejected |= REJECTED_BEFORE;
        return;
    }
    status.steps += 1;
    status.repeated = 0;
    let counters = status.total_counters();
    status.counters.fill(Counters::default());
    status.collides = 0;
    status.listed = 0;
    status.clustered_steps += std::mem::take(&mut status.clustered);
    (status.last_contacts, status.last_max_overlap, status.last_collisions) =
        (counters.contacts, counters.max_overlap, counters.collisions);
    let (low, carry) = status.total_collisions_low.overflowing_add(status.last_collisions);
    status.total_collisions_low = low;
    status.total_collisions_high += u32::from(carry);
    status.total_bad += std::mem::take(&mut status.bad_count);
    status.total_passages += counters.passages;
    if counters.passages > 0 && status.first_passing == NO_BODY {
        status.first_passing = !counters.passing;
        status.passage_step = status.steps;
    }
    let bad = std::mem::replace(&mut status.bad_body, NO_BODY);
    if bad != NO_BODY {
        if status.first_bad == NO_BODY {
            status.first_bad = bad;
            status.bad_step = status.steps;
        }
        if world.step.constants.flags & FLAG_CONTINUE == 0 {
            status.rejected |= REJECTED_NON_FINITE;
        }
    }
    status.collided = 0;
    status.lengths_due = 0;
    status.history_table ^= 1;
}
