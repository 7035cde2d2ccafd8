// requires model/order.wgsl model/step.wgsl

// Passes that compute only the spheres of which other processes have copies (docs/cluster.md).

fn is_early() -> bool {
    return pass_.index >= EARLY;
}

// The sphere of a thread of such a pass, or NONE.
fn sent_sphere(thread: u32) -> u32 {
    if thread >= step.sent {
        return NONE;
    }
    return id_of(topology[step.sent_at + thread]);
}
