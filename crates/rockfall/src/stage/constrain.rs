//! Fixed lengths after the integration: SHAKE along the old directions, then RATTLE (physics.md section 5).
//!
//! A batch is one connected frame of fixed-length rods (or many small ones); its rods are coloured so that those of one
//! colour share no sphere. Swept colour by colour until every length is within 0.1 %, at most 80 times.

use crate::stage::{Buffer, Stage, Threads, part, read, write};
use crate::world::World;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "constrain",
    parts: &[
        part!("wgsl/step.wgsl"),
        part!("wgsl/objects.wgsl"),
        part!("wgsl/lengths.wgsl"),
        part!("stage/constrain.wgsl"),
    ],
    bindings: &[
        write("state", Buffer::Start),
        read("y3", Buffer::Y3),
        read("words", Buffer::Words),
        read("status", Buffer::Status),
    ],
    threads: Threads::Batches,
    cpu: constrain,
};

fn constrain(_world: &mut World, _pass: u32) {
    unimplemented!()
}
