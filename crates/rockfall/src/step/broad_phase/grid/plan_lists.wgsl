// requires model/step.wgsl step/broad_phase/due.wgsl

@group(0) @binding(2) var<storage, read_write> dispatch_sizes: array<u32>;
@group(0) @binding(3) var<storage, read> status: Status;

@compute @workgroup_size(64)
fn plan_lists(@builtin(local_invocation_index) local: u32) {
    let is_due = builds_lists(REBUILD_REQUESTED);
    if local < SIZE_WORDS {
        dispatch_sizes[local] = select(0u, dispatch_sizes[SIZE_WORDS + local], is_due);
    }
}
