@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> start: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(5) var<storage, read> words: array<u32>;
@group(0) @binding(6) var<storage, read> lists: array<u32>;
@group(0) @binding(7) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(8) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

fn write_next(i: u32, net: Net) {
    let old_position = start[position_at(i)];
    let old_velocity = start[velocity_at(i)];
    let old_momentum = start[momentum_at(i)];
    var after = Motion(old_position.xyz, old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        let c = select(0.5, 1.0, pass_.index == 2u) * step.dt;
        after.position += c * state[velocity_at(i)].xyz;
        after.velocity += c * (step.gravity + old_velocity.w * net.force);
        after.momentum += c * net.torque;
        if !is_finite(after) {
            after = stopped(old_position.xyz, pass_.index + 1u, i);
        }
        var ratio = escape_ratio(after.position, old_position.w, aabbs[i]);
        if pass_.index == 0u {
            ratio = max(ratio, escape_ratio(old_position.xyz, old_position.w, aabbs[i]));
        }
        if ratio > 0.0 {
            tell_escape(ratio);
        }
        // Stage state 4 is about where the step will end, which is good enough: whoever leaves unannounced voids a step.
        if pass_.index == 2u {
            ask_for_lists(i, vec4f(after.position, old_position.w), vec4f(after.velocity, old_velocity.w));
        }
    }
    next[position_at(i)] = vec4f(after.position, old_position.w);
    next[velocity_at(i)] = vec4f(after.velocity, old_velocity.w);
    next[momentum_at(i)] = vec4f(after.momentum, old_momentum.w);
}

@compute @workgroup_size(64)
fn advance(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    var net = no_force();
    if (i < step.spheres) & (atomicLoad(&status.void) == 0u) {
        // A fixed sphere's contacts are only counted.
        if (pass_.index == 0u) | (inverse_mass(i) > 0.0) {
            net = net_force(i);
        }
        write_next(i, net);
    }
    if pass_.index == 0u {
        if (i == 0u) & (atomicLoad(&status.void) == 0u) {
            tell_builds();
        }
        tell_contacts(local, net.contacts, net.deepest);
    }
}
