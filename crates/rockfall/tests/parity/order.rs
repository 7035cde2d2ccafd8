//! The grid broad phase leaves some things in any order. Here they are put into one, so that they can be compared.

use rockfall::layout::{CELLS_AT, SLICE};
use rockfall::world::World;

/// The world after a stage, with what that stage leaves in any order put in order.
pub(crate) fn canonical(world: &World, stage: &str) -> World {
    let mut world = world.clone();
    match stage {
        "sort_cells" => order_cells(&mut world),
        "count_neighbours" => check_offsets(&mut world),
        "fill_neighbours" => order_lists(&mut world),
        _ => {}
    }
    world
}

/// The objects of one cell come in any order.
fn order_cells(world: &mut World) {
    let (cells, sorted) = world.cells.split_at_mut(world.step.sorted_at as usize);
    let ends = &cells[CELLS_AT as usize..][..world.step.cells as usize];
    let mut start = 0;
    for end in ends.iter().map(|end| *end as usize) {
        sorted[start..end].sort_unstable();
        start = end;
    }
}

/// Slices lie in any order, but one beside the other, without gaps: then their offsets are made those of ascending order.
fn check_offsets(world: &mut World) {
    let step = world.step;
    let (counts, rest) = world.lists.split_at_mut(step.slices_at as usize);
    let offsets = &mut rest[..counts.len() / SLICE as usize];
    let widths = counts.chunks(SLICE as usize).map(|slice| slice.iter().max().unwrap() * SLICE);
    let mut slices: Vec<(u32, u32)> = offsets.iter().copied().zip(widths.clone()).collect();
    slices.sort_unstable();
    let mut end = 0;
    for (offset, width) in slices {
        assert_eq!(offset, end, "slices overlap, or there is a gap between them");
        end += width;
    }
    assert_eq!(end, world.status.pairs_needed);
    end = 0;
    for (offset, width) in offsets.iter_mut().zip(widths) {
        *offset = end;
        end += width;
    }
}

/// The entries of a list come in any order.
fn order_lists(world: &mut World) {
    let step = world.step;
    for mover in 0..world.movers() {
        let first = step.entries_at + world.lists[(step.slices_at + mover / SLICE) as usize] + mover % SLICE;
        let places = (0..world.lists[mover as usize]).map(|place| (first + place * SLICE) as usize);
        let mut entries: Vec<u32> = places.clone().map(|at| world.lists[at]).collect();
        entries.sort_unstable();
        for (at, entry) in places.zip(entries) {
            world.lists[at] = entry;
        }
    }
}
