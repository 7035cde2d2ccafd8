// requires model/step.wgsl

// What the collision phase tells the host: that collisions share bodies, and that the step has to be run again with sweeps or with more
// room for collisions.

fn void_for_collisions() {
    if (atomicLoad(&status.void) & VOID_COLLISIONS) == 0u {
        atomicOr(&status.void, VOID_COLLISIONS);
    }
}

// A collision shares a body with another: only sweeps solve both.
fn note_cluster() {
    // To look takes less than to write.
    if atomicLoad(&status.clustered) == 0u {
        atomicStore(&status.clustered, 1u);
    }
    if (step.sweeps == SWEEPS_OFF) | (step.sweeps == SWEEPS_LISTED) {
        void_for_collisions();
    }
    if atomicLoad(&status.listed) > FEW_COLLISIONS {
        need_dispatches();
    }
}

// One workgroup cannot make all sweeps.
fn need_dispatches() {
    if step.sweeps == SWEEPS_FEW {
        atomicOr(&status.void, VOID_COLLISIONS | VOID_MANY);
    }
}
