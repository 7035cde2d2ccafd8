@group(0) @binding(2) var<storage, read_write> status: Status;

@compute @workgroup_size(64)
fn end_collisions(@builtin(local_invocation_index) local: u32) {
    if local != 0u {
        return;
    }
    if (status.void != 0u) | (status.collided != 0u) {
        return;
    }
    status.collided = 1u;
    if status.collisions > 0u {
        status.lengths_due = 1u;
    }
}
