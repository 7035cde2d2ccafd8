// requires model/step.wgsl step/integrate/close_step.wgsl

@group(0) @binding(2) var<storage, read_write> status: StatusAtomic;

@compute @workgroup_size(64)
fn end_step(@builtin(local_invocation_index) local: u32) {
    close_step(local);
}
