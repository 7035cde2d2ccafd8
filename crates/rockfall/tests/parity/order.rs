//! Brings worlds into a canonical form, so that they can be compared. Results whose order is arbitrary, as in the grid broad
//! phase, are sorted. Scratch memory that only one backend uses is cleared.

use rockfall::model::layout::{CELLS_AT, LIST_COUNT_MASK, SLICE, words_of_rows};
use rockfall::model::world::World;

/// Returns the canonical form of a world after `stage`, or after a group of stages that begins with it.
pub(crate) fn canonical(world: &World, stage: &str) -> World {
    let mut world = world.clone();
    match stage {
        "count_cells" => order_long_movers(&mut world),
        "sort_cells" => order_cells(&mut world),
        "find_neighbours" => {
            order_slices(&mut world);
            clear_long_lists(&mut world);
        }
        // On the GPU, Y2 and the wrenches of rods are scratch memory here, and the status counts the listed collisions.
        "find_collisions" => {
            world.states[1].fill(glam::Vec4::ZERO);
            world.wrenches.fill(glam::Vec4::ZERO);
            (world.status.listed, world.status.clustered) = (0, 0);
        }
        _ => {}
    }
    world
}

/// Sorts the long movers, whose order is arbitrary.
fn order_long_movers(world: &mut World) {
    if world.step.layout.long_at != 0 {
        let count = world.cells[3] as usize;
        world.cells[world.step.layout.long_at as usize..][..count].sort_unstable();
    }
}

/// Clears the lists of long movers. At this point their room is reserved, but the entries are not written yet.
fn clear_long_lists(world: &mut World) {
    if world.step.layout.long_at == 0 {
        return;
    }
    let step = world.step;
    for mover in world.cells[step.layout.long_at as usize..][..world.cells[3] as usize].iter().copied() {
        let row = world.lists[(step.layout.slices_at + mover / SLICE) as usize];
        let first = step.layout.entries_at + row * SLICE + mover % SLICE;
        for place in 0..world.lists[mover as usize] {
            world.lists[(first + place * SLICE) as usize] = 0;
        }
    }
}

/// Sorts the objects of each cell, whose order is arbitrary, together with their extents.
fn order_cells(world: &mut World) {
    let (cells, sorted) = world.cells.split_at_mut(world.step.layout.sorted_at as usize);
    let ends = &cells[CELLS_AT as usize..][..world.step.layout.cells as usize];
    let mut start = 0;
    for end in ends.iter().map(|end| *end as usize) {
        let extents = &mut world.extents[start..end];
        let mut both: Vec<_> = sorted[start..end].iter().copied().zip(extents.iter().copied()).collect();
        both.sort_unstable_by_key(|(object, _)| *object);
        for ((object, extent), (id, place)) in both.into_iter().zip(sorted[start..end].iter_mut().zip(extents)) {
            (*id, *place) = (object, extent);
        }
        start = end;
    }
}

/// Moves the slices of the pair lists into the order of the movers, without gaps. Their order is arbitrary, but they must not
/// overlap.
fn order_slices(world: &mut World) {
    let step = world.step;
    let (index, entries) = world.lists.split_at_mut(step.layout.entries_at as usize);
    let (counts, offsets) = index.split_at_mut(step.layout.slices_at as usize);
    let offsets = &mut offsets[..counts.len() / SLICE as usize];
    let widths = counts.chunks(SLICE as usize).map(|slice| slice.iter().map(|count| count & LIST_COUNT_MASK).max().unwrap());
    let mut slices: Vec<(u32, u32)> = offsets.iter().copied().zip(widths.clone()).collect();
    slices.sort_unstable();
    let ends = slices.iter().map(|(offset, width)| offset + width);
    let next = slices.iter().skip(1).map(|(offset, _)| *offset).chain([world.status.pair_rows_needed]);
    assert!(ends.zip(next).all(|(end, next)| end <= next), "slices overlap: {slices:?}");
    let before = entries.to_vec();
    let mut end = 0;
    for (offset, width) in offsets.iter_mut().zip(widths) {
        let [from, to, words] = [*offset, end, width].map(|rows| words_of_rows(rows) as usize);
        entries[to..to + words].copy_from_slice(&before[from..from + words]);
        *offset = end;
        end += width;
    }
}
