// requires step/collisions/rows.wgsl step/take_next.wgsl

// What collisions made of a sphere becomes its state.

fn commit_change(i: u32) {
    // Nearly all are told by one word of the lists that they have nothing to do; the status takes several times as long to read.
    let takes_part = takes_part_in_any(i);
    if (i != 0u) & !takes_part {
        return;
    }
    // 1: done before this attempt at the step; 2, which the first thread writes meanwhile, is as good as 0 here.
    if (atomicLoad(&status.rejected) != 0u) | (atomicLoad(&status.collided) == 1u) {
        return;
    }
    if i == 0u {
        atomicStore(&status.collided, 2u);
    }
    if atomicLoad(&status.collides) == 0u {
        return;
    }
    if i == 0u {
        status.lengths_due = 1u;
    }
    if takes_part {
        take_next(i);
    }
}
