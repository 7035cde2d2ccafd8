//! Memory order, 5 of 5: copies the data of the spheres from the scratch buffers to their new places, and updates everything
//! that refers to spheres by memory slot: rods, springs, tethers, and the maps between memory slots and insertion indices.

use bytemuck::cast_slice;
use glam::Vec4;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{ROD_WORDS, SPRING_WORDS, TETHER_WORDS};
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "settle_spheres",
    wgsl: Wgsl::File(part!("step/reorder/settle_spheres.wgsl")),
    bindings: &[
        write("start", Buffer::Start),
        read("y3", Buffer::Y3),
        read("y4", Buffer::Y4),
        write("orientations", Buffer::Orientations),
        write("topology", Buffer::Topology),
        read("status", Buffer::Status),
    ],
    threads: Threads::Spheres,
    // The stage is not part of a step, so its time is not measured.
    moves: |_| NONE,
    cpu: settle_spheres,
};

fn settle_spheres(world: &mut World, _pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let World { step, topology, states: [start, _, y3, y4], orientations, .. } = world;
    let n = step.layout.spheres as usize;
    let memory: &[[u32; 4]] = cast_slice(y4);
    // What follows is computed anew in the next phase of collisions.
    start[..y3.len()].copy_from_slice(y3);
    let records = memory[..n].iter().zip(&memory[n..2 * n]);
    for (slot, (orientation, [tag, insertion_index, begin, end])) in records.enumerate() {
        orientations[slot] = Vec4::from_array(orientation.map(f32::from_bits));
        let mut set = |at: u32, place: usize, word: u32| topology[at as usize + place] = word;
        set(step.layout.tags_at, slot, *tag);
        set(step.layout.insertion_indices_at, slot, *insertion_index);
        set(step.layout.slots_at, *insertion_index as usize, slot as u32);
        if step.layout.adjacency_at != 0 {
            set(step.layout.adjacency_at, 2 * slot, *begin);
            set(step.layout.adjacency_at, 2 * slot + 1, *end);
        }
    }
    if step.layout.ends_at != 0 {
        for [slot, end, ..] in &memory[2 * n..3 * n] {
            topology[(step.layout.ends_at + slot) as usize] = *end;
        }
    }
    // For each kind of record: its first word, its end, the words of a record, and how many of these, at its start, are
    // spheres.
    let referring = [
        (step.layout.rods_at, step.layout.rods_at + step.layout.rods * ROD_WORDS, ROD_WORDS, 2),
        (step.layout.springs_at, step.layout.tethers_at, SPRING_WORDS, 2),
        (step.layout.tethers_at, step.layout.forces_at, TETHER_WORDS, 1),
    ];
    for (first, end, size, spheres) in referring {
        for record in topology[first as usize..end as usize].chunks_exact_mut(size as usize) {
            record[..spheres].iter_mut().for_each(|sphere| *sphere = memory[2 * n + *sphere as usize][0]);
        }
    }
}
