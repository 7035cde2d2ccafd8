// requires model/step.wgsl step/collisions/rows.wgsl step/commit_next_state.wgsl

// Commits the next state of a sphere, if a collision may have changed it.

fn commit_change(i: u32) {
    // This test comes first because it excludes nearly all spheres by one word of the lists. Reading the status takes several
    // times as long.
    let takes_part = takes_part_in_any(i);
    if (i != 0u) & !takes_part {
        return;
    }
    // 1: an earlier attempt at this step has applied the collisions. The first thread writes 2 below, possibly before other
    // threads read the word. For them 2 means the same as 0.
    if (atomicLoad(&status.rejected) != 0u) | (atomicLoad(&status.collided) == 1u) {
        return;
    }
    if i == 0u {
        atomicStore(&status.collided, 2u);
        status.forces_due = 1u;
    }
    if atomicLoad(&status.collides) == 0u {
        return;
    }
    if takes_part {
        commit_next_state(i, COLLISION_REGIONS);
    }
}
