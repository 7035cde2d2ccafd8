// requires model/collision_state.wgsl model/order.wgsl model/step.wgsl physics/collision/body_impulses.wgsl physics/escape.wgsl
// requires physics/free_rotation.wgsl physics/quaternion.wgsl physics/rigid_parts.wgsl step/bodies/body_rows.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> bodies: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read> collisions: array<vec4u>;
@group(0) @binding(8) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

// Gives a member sphere the velocity and the spin that follow from those of its body.
fn set_member(i: u32, velocity: vec3f, spin: vec3f) {
    let own_at = step.spheres + i;
    let before = state[own_at];
    state[own_at] = vec4f(velocity, before.w);
    let inverse_inertia = state[momentum_at(i)].w;
    state[momentum_at(i)] = vec4f(spin / inverse_inertia, inverse_inertia);
    var present = vec4f(velocity, before.w);
    if HALF_STEP {
        present = state[velocity_at(i)] + vec4f(velocity - before.xyz, 0.0);
        state[velocity_at(i)] = present;
    }
    request_rebuild(i, state[position_at(i)], present);
}

@compute @workgroup_size(64)
fn push_bodies(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) | (atomicLoad(&status.collided) != 2u) {
        return;
    }
    let body = body_of_sphere(i);
    if (body == NO_RIGID) | (atomicLoad(&status.collides) == 0u) {
        return;
    }
    let form = form_of(body);
    if id_of(topology[form.members]) != i {
        return;
    }
    let kick = body_kick(body, SWEEPS);
    if !kick.is_hit {
        return;
    }
    var velocity = pose_row(body, 2u).xyz + form.inverse_mass * kick.impulse;
    var momentum = pose_row(body, 3u).xyz + kick.torque;
    if !(finite(velocity) & finite(momentum)) {
        atomicAdd(&status.bad_count, 1u);
        atomicMin(&status.bad_body, topology[form.members]);
        velocity = vec3f(0.0);
        momentum = vec3f(0.0);
    }
    put_pose_row(body, 2u, vec4f(velocity, 0.0));
    put_pose_row(body, 3u, vec4f(momentum, 0.0));
    let orientation = pose_row(body, 4u);
    let spin = spin_of_body(orientation, form.moments, momentum);
    for (var member = 0u; member < form.count; member++) {
        let lever = turned_vector(orientation, place_of_member(form, member));
        set_member(id_of(topology[form.members + member]), velocity + cross(spin, lever), spin);
    }
}
