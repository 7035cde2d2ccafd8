// requires model/one_state.wgsl model/step.wgsl physics/lengths.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> status: Status;

@compute @workgroup_size(64)
fn restore_lengths(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = linear_group(group, groups);
    if (index >= step.batches) | (status.rejected != 0u) | (status.lengths_due == 0u) {
        return;
    }
    let batch = batch_at(index);
    start_sweeps(local);
    for (var sweeps = 1u; ; sweeps++) {
        var error = 0.0;
        for (var colour = 0u; colour < batch.colours; colour++) {
            let end = topology[batch.at + colour + 1u];
            for (var k = topology[batch.at + colour] + local; k < end; k += WORKGROUP) {
                error = max(error, restore_length(topology[k]));
            }
            storageBarrier();
        }
        if !sweep_again(local, error, sweeps, batch.colours) {
            break;
        }
    }
}
