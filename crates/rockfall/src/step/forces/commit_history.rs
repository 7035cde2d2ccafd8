//! Takes over the springs of contacts that `law_forces` wrote, unless the step is rejected.

use rayon::prelude::*;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::GRAIN;
use crate::model::part::part;
use crate::model::world::World;
use crate::physics::laws::history::row_words;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "commit_history",
    wgsl: Wgsl::File(part!("step/forces/commit_history.wgsl")),
    bindings: &[write("histories", Buffer::Histories), write("status", Buffer::Status)],
    threads: Threads::Movers,
    // How many springs there are depends on the contacts.
    moves: |_| NONE,
    cpu: commit_history,
};

fn commit_history(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let words = row_words(&world.step);
    let (before, after) = world.histories.split_at_mut(words * world.step.movers() as usize);
    let rows = before.par_chunks_mut(words).zip(after.par_chunks(words)).with_min_len(GRAIN);
    rows.for_each(|(before, after)| before.copy_from_slice(after));
}
