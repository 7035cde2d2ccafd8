// requires model/objects.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/forces/free.wgsl physics/forces/rates.wgsl physics/forces/user.wgsl

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
    var acceleration = vec3f(0.0);
    if velocity.w > 0.0 {
        var rates = Rates(free_acceleration(i), vec3f(0.0));
        add_user(i, &rates);
        acceleration = rates.acceleration;
        // A body whose forces are not finite is stopped by the integration.
        if !finite(acceleration) {
            acceleration = vec3f(0.0);
        }
    }
    if FREE_TABLE {
        topology[step.free_at + i] = bitcast<u32>(length(acceleration));
    }
    if HALF_STEP {
        state[4u * step.spheres + i] = vec4f(velocity.xyz + 0.5 * step.dt * acceleration, velocity.w);
    }
}
