//! Memory order, 3 of 5: sorts the pairs by one digit. Pairs with the same digit keep their order.
//!
//! After the last pass the pairs are back in `Y2`, in the order of their keys.

use bytemuck::cast_slice_mut;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{CELLS_AT, DIGIT_BLOCK};
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::reorder::count_digits::digit;
use crate::step::stage::{Access, Binding, Slot, Stage, read};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "scatter_digits",
    wgsl: Wgsl::File(part!("step/reorder/scatter_digits.wgsl")),
    bindings: &[
        Binding { name: "pairs", slot: Slot::Unsorted, access: Access::Read },
        Binding { name: "sorted", slot: Slot::Sorted, access: Access::Write },
        read("cells", Buffer::Cells),
        read("status", Buffer::Status),
    ],
    threads: Threads::DigitBlocks,
    // The stage is not part of a step, so its time is not measured.
    moves: |_| NONE,
    cpu: scatter_digits,
};

fn scatter_digits(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let [_, y2, y3, _] = &mut world.states;
    let (pairs, sorted) = if pass.is_multiple_of(2) { (y2, y3) } else { (y3, y2) };
    let (pairs, sorted): (&mut [[u32; 2]], &mut [[u32; 2]]) = (cast_slice_mut(pairs), cast_slice_mut(sorted));
    let spheres = world.step.layout.spheres as usize;
    let blocks = spheres.div_ceil(DIGIT_BLOCK as usize);
    let mut next: Vec<u32> = world.cells[CELLS_AT as usize..].to_vec();
    for (pair, place) in pairs[..spheres].iter().zip(0..) {
        let next = &mut next[digit(*pair, pass) * blocks + place / DIGIT_BLOCK as usize];
        sorted[*next as usize] = *pair;
        *next += 1;
    }
}
