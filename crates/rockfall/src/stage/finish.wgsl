@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> y2: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> y3: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> start: array<vec4f>;
@group(0) @binding(6) var<storage, read> words: array<u32>;
@group(0) @binding(7) var<storage, read> lists: array<u32>;
@group(0) @binding(8) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

// The new value of three components at a place in the state, given the slope at Y4.
fn finished(at: u32, slope: vec3f) -> vec3f {
    let y = start[at].xyz;
    let sum = (y2[at].xyz - y) + 2.0 * (y3[at].xyz - y) + (state[at].xyz - y);
    return y + sum / 3.0 + (step.dt / 6.0) * slope;
}

@compute @workgroup_size(64)
fn finish(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.void) != 0u) {
        return;
    }
    let old_position = start[position_at(i)];
    let old_velocity = start[velocity_at(i)];
    let old_momentum = start[momentum_at(i)];
    var spin = old_momentum.xyz * old_momentum.w;
    if old_velocity.w > 0.0 {
        let net = net_force(i);
        var after = Motion(
            finished(position_at(i), state[velocity_at(i)].xyz),
            finished(velocity_at(i), step.gravity + old_velocity.w * net.force),
            finished(momentum_at(i), net.torque),
        );
        let at = momentum_at(i);
        spin = (old_momentum.xyz + 2.0 * y2[at].xyz + 2.0 * y3[at].xyz + state[at].xyz) * (old_momentum.w / 6.0);
        if !is_finite(after) {
            after = stopped(old_position.xyz, 4u, i);
            spin = vec3f(0.0);
        }
        start[position_at(i)] = vec4f(after.position, old_position.w);
        start[velocity_at(i)] = vec4f(after.velocity, old_velocity.w);
        start[momentum_at(i)] = vec4f(after.momentum, old_momentum.w);
    }
    y3[position_at(i)] = vec4f(old_position.xyz, 0.0);
    y3[momentum_at(i)] = vec4f(spin, 0.0);
}
