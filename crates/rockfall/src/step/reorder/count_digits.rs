//! Memory order, 2 of 5: counts how often each value of a digit occurs in each block of pairs.
//!
//! The keys are sorted by a radix sort. This stage and the next are run for every digit of the keys, from the lowest to the
//! highest. Between the two `sum_blocks` and `place_cells` turn the counts into the places of the pairs.

use bytemuck::cast_slice;

use crate::model::buffer::Buffer;
use crate::model::dispatch::Threads;
use crate::model::layout::{CELLS_AT, DIGIT_BITS, DIGIT_BLOCK, DIGITS};
use crate::model::part::part;
use crate::model::world::World;
use crate::step::moves::NONE;
use crate::step::stage::{Access, Binding, Slot, Stage, read, write};
use crate::step::wgsl::Wgsl;

/// The stage.
pub(crate) const STAGE: Stage = Stage {
    name: "count_digits",
    wgsl: Wgsl::File(part!("step/reorder/count_digits.wgsl")),
    bindings: &[
        Binding { name: "pairs", slot: Slot::Unsorted, access: Access::Read },
        write("cells", Buffer::Cells),
        read("status", Buffer::Status),
    ],
    threads: Threads::DigitBlocks,
    // The stage is not part of a step, so its time is not measured.
    moves: |_| NONE,
    cpu: count_digits,
};

fn count_digits(world: &mut World, pass: u32) {
    if world.status.rejected != 0 {
        return;
    }
    let pairs: &[[u32; 2]] = cast_slice(&world.states[1 + pass as usize % 2]);
    let spheres = world.step.layout.spheres as usize;
    let blocks = spheres.div_ceil(DIGIT_BLOCK as usize);
    let cells = &mut world.cells[CELLS_AT as usize..];
    cells[..DIGITS as usize * blocks].fill(0);
    for (pair, place) in pairs[..spheres].iter().zip(0..) {
        cells[digit(*pair, pass) * blocks + place / DIGIT_BLOCK as usize] += 1;
    }
}

/// Returns the digit of a pair's key that a pass sorts by.
pub(super) fn digit(pair: [u32; 2], pass: u32) -> usize {
    (pair[0] >> (DIGIT_BITS * pass) & (DIGITS - 1)) as usize
}
