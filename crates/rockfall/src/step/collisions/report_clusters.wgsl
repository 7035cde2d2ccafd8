// requires model/step.wgsl

// Reports to the host that collisions share bodies. Rejects a step that must be repeated with sweeps or with more room for
// collisions.

fn reject_for_collisions() {
    if (atomicLoad(&status.rejected) & REJECTED_COLLISIONS) == 0u {
        atomicOr(&status.rejected, REJECTED_COLLISIONS);
    }
}

// Records that a collision shares a body with another one. Only sweeps solve such collisions.
fn note_cluster() {
    // Reading the word takes less time than writing it.
    if atomicLoad(&status.clustered) == 0u {
        atomicStore(&status.clustered, 1u);
    }
    if step.sweeps == SWEEPS_LISTED {
        reject_for_collisions();
    }
    if atomicLoad(&status.listed) > FEW_COLLISIONS {
        need_dispatches();
    }
}

// Rejects a step in which one workgroup was to make all sweeps but cannot. It needs a dispatch per sweep.
fn need_dispatches() {
    if step.sweeps == SWEEPS_FEW {
        atomicOr(&status.rejected, REJECTED_COLLISIONS | REJECTED_MANY);
    }
}
