@group(0) @binding(2) var<storage, read_write> status: Status;

@compute @workgroup_size(64)
fn end_step(@builtin(local_invocation_index) local: u32) {
    if local != 0u {
        return;
    }
    if status.void != 0u {
        return;
    }
    status.steps += 1u;
    status.last_contacts = status.contacts;
    status.last_max_overlap = status.max_overlap;
    status.last_collisions = status.collisions;
    let low = status.total_collisions_low + status.collisions;
    if low < status.collisions {
        status.total_collisions_high += 1u;
    }
    status.total_collisions_low = low;
    status.total_bad += status.bad_count;
    if status.bad_body != NO_BODY {
        if status.first_bad == NO_BODY {
            status.first_bad = status.bad_body;
            status.bad_step = status.steps;
        }
        if (step.flags & FLAG_CONTINUE) == 0u {
            status.void |= VOID_NON_FINITE;
        }
    }
    status.contacts = 0u;
    status.max_overlap = 0u;
    status.collisions = 0u;
    status.bad_count = 0u;
    status.bad_body = NO_BODY;
    status.collided = 0u;
}
