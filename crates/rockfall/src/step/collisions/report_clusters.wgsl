// requires model/step.wgsl

// What the collision phase tells the host: that collisions share bodies, and that the step has to be run again with sweeps or with more
// room for collisions.

fn reject_for_collisions() {
    if (atomicLoad(&status.rejected) & REJECTED_COLLISIONS) == 0u {
        atomicOr(&status.rejected, REJECTED_COLLISIONS);
    }
}

// A collision shares a body with another: only sweeps solve both.
fn note_cluster() {
    // To look takes less than to write.
    if atomicLoad(&status.clustered) == 0u {
        atomicStore(&status.clustered, 1u);
    }
    if (step.sweeps == SWEEPS_OFF) | (step.sweeps == SWEEPS_LISTED) {
        reject_for_collisions();
    }
    if atomicLoad(&status.listed) > FEW_COLLISIONS {
        need_dispatches();
    }
}

// One workgroup cannot make all sweeps.
fn need_dispatches() {
    if step.sweeps == SWEEPS_FEW {
        atomicOr(&status.rejected, REJECTED_COLLISIONS | REJECTED_MANY);
    }
}
