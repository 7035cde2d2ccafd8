// requires model/one_state.wgsl model/step.wgsl physics/forces/free.wgsl physics/forces/rates.wgsl physics/forces/user.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> topology: array<u32>;
@group(0) @binding(4) var<storage, read> status: Status;

@compute @workgroup_size(256)
fn synchronise(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if (i >= step.spheres) | (status.rejected != 0u) | (status.collided != 0u) {
        return;
    }
    let velocity = state[velocity_at(i)];
    var rates = Rates(vec3f(0.0), vec3f(0.0));
    if velocity.w > 0.0 {
        rates.acceleration = free_acceleration(i);
        add_user(i, &rates);
        // A body whose forces are not finite is stopped by the integration.
        if !finite(rates.acceleration) {
            rates.acceleration = vec3f(0.0);
        }
    }
    if FREE_TABLE {
        topology[step.free_at + i] = bitcast<u32>(length(rates.acceleration));
    }
    if HALF_STEP {
        state[4u * step.spheres + i] = vec4f(velocity.xyz + 0.5 * step.dt * rates.acceleration, velocity.w);
    }
}
