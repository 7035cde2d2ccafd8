// The end of a step, for one thread.

fn close_step() {
    if atomicLoad(&status.void) != 0u {
        return;
    }
    let collisions = atomicLoad(&status.collisions);
    let bad_body = atomicLoad(&status.bad_body);
    status.steps += 1u;
    status.last_contacts = atomicLoad(&status.contacts);
    status.last_max_overlap = atomicLoad(&status.max_overlap);
    status.last_collisions = collisions;
    let low = status.total_collisions_low + collisions;
    if low < collisions {
        status.total_collisions_high += 1u;
    }
    status.total_collisions_low = low;
    status.total_bad += atomicLoad(&status.bad_count);
    if bad_body != NO_BODY {
        if status.first_bad == NO_BODY {
            status.first_bad = bad_body;
            status.bad_step = status.steps;
        }
        // Asked together for the reason in objects.wgsl.
        if (bad_body != NO_BODY) & ((step.flags & FLAG_CONTINUE) == 0u) {
            atomicOr(&status.void, VOID_NON_FINITE);
        }
    }
    atomicStore(&status.contacts, 0u);
    atomicStore(&status.max_overlap, 0u);
    atomicStore(&status.collisions, 0u);
    atomicStore(&status.bad_count, 0u);
    atomicStore(&status.bad_body, NO_BODY);
    atomicStore(&status.collided, 0u);
}
