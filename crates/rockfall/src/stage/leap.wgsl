@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> y3: array<vec4f>;
@group(0) @binding(5) var<storage, read> words: array<u32>;
@group(0) @binding(6) var<storage, read> lists: array<u32>;
@group(0) @binding(7) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(8) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

fn write_next(i: u32, net: Net) {
    let old_position = state[position_at(i)];
    let old_velocity = state[velocity_at(i)];
    let old_momentum = state[momentum_at(i)];
    var after = Motion(old_position.xyz, old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        let ratio = escape_ratio(old_position.xyz, old_position.w, aabbs[i]);
        if ratio > 0.0 {
            tell_escape(ratio);
        }
        after.velocity += step.dt * (step.gravity + old_velocity.w * net.force);
        after.momentum += step.dt * net.torque;
        after.position += step.dt * after.velocity;
        if !is_finite(after) {
            after = stopped(old_position.xyz, 1u, i);
        }
    }
    next[position_at(i)] = vec4f(after.position, old_position.w);
    next[velocity_at(i)] = vec4f(after.velocity, old_velocity.w);
    next[momentum_at(i)] = vec4f(after.momentum, old_momentum.w);
    if RODS {
        y3[position_at(i)] = vec4f(old_position.xyz, 0.0);
        y3[momentum_at(i)] = vec4f(after.momentum * old_momentum.w, 0.0);
    }
}

@compute @workgroup_size(64)
fn leap(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    var net = no_force();
    if (i < step.spheres) & (atomicLoad(&status.void) == 0u) {
        net = net_force(i);
        write_next(i, net);
    }
    if (i == 0u) & (atomicLoad(&status.void) == 0u) {
        tell_builds();
    }
    tell_contacts(local, net.contacts, net.deepest);
}
