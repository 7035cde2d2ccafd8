//! Memory order, 4 of 5: copies all data of the spheres into scratch buffers, in the new order.
//!
//! `Y3` receives the states. `Y4` receives three regions of one vec4 per sphere:
//!
//! 1. by new slot, the orientation;
//! 2. by new slot, the tag, the insertion index, and the begin and end of the adjacency words;
//! 3. by old slot, the new slot and the word that encodes which rods end in the sphere.

use bytemuck::{cast_slice, cast_slice_mut};

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "permute_spheres",
    wgsl: Wgsl::File(part!("step/reorder/permute_spheres.wgsl")),
    bindings: &[
        read("start", Buffer::Start),
        read("pairs", Buffer::Y2),
        read("orientations", Buffer::Orientations),
        read("topology", Buffer::Topology),
        write("y3", Buffer::Y3),
        write("y4", Buffer::Y4),
        read("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    // The stage is not part of a step, so its time is not measured.
    moves: |_| NONE,
    cpu: permute_spheres,
};

fn permute_spheres(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states: [start, y2, y3, y4], orientations, .. } = world;
    let n = step.layout.spheres as usize;
    let pairs: &[[u32; 2]] = cast_slice(y2);
    let memory: &mut [[u32; 4]] = cast_slice_mut(y4);
    let word = |at: u32, place: usize| topology[at as usize + place];
    for (slot, [_, old]) in pairs[..n].iter().enumerate() {
        let old = *old as usize;
        for region in 0..step.state_regions(2) as usize {
            y3[region * n + slot] = start[region * n + old];
        }
        let attached = match step.layout.adjacency_at {
            0 => [0, 0],
            at => [word(at, 2 * old), word(at, 2 * old + 1)],
        };
        memory[slot] = orientations[old].to_array().map(f32::to_bits);
        memory[n + slot] =
            [word(step.layout.tags_at, old), word(step.layout.insertion_indices_at, old), attached[0], attached[1]];
        let end = if step.layout.ends_at == 0 { 0 } else { word(step.layout.ends_at, old) };
        memory[2 * n + old] = [slot as u32, end, 0, 0];
    }
}
