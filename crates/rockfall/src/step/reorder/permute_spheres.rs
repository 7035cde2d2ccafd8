//! Memory order, 4 of 5: everything that memory holds of a sphere, in its new place.
//!
//! Leaves the states in `Y3`; in `Y4` the orientations, then (tag, user, begin and end of the adjacency words), then by old slot
//! (the new one, what rods end in the sphere).

use bytemuck::{cast_slice, cast_slice_mut};

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::world::World;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::{Wgsl, part};

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
    cpu: permute_spheres,
};

fn permute_spheres(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states: [start, y2, y3, y4], orientations, .. } = world;
    let n = step.spheres as usize;
    let pairs: &[[u32; 2]] = cast_slice(y2);
    let memory: &mut [[u32; 4]] = cast_slice_mut(y4);
    let word = |at: u32, place: usize| topology[at as usize + place];
    for (slot, [_, old]) in pairs[..n].iter().enumerate() {
        let old = *old as usize;
        for region in 0..3 {
            y3[region * n + slot] = start[region * n + old];
        }
        let attached = match step.adjacency_at {
            0 => [0, 0],
            at => [word(at, 2 * old), word(at, 2 * old + 1)],
        };
        memory[slot] = orientations[old].to_array().map(f32::to_bits);
        memory[n + slot] = [word(step.tags_at, old), word(step.insertion_indices_at, old), attached[0], attached[1]];
        let end = if step.ends_at == 0 { 0 } else { word(step.ends_at, old) };
        memory[2 * n + old] = [slot as u32, end, 0, 0];
    }
}
