// requires model/objects.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/forces/free.wgsl physics/forces/rates.wgsl physics/forces/user.wgsl
// requires physics/rigid.wgsl physics/rigid_lever.wgsl physics/rigid_parts.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> topology: array<u32>;
@group(0) @binding(4) var<storage, read> status: Status;

// The acceleration of a sphere by everything but contacts and damping. That of a sphere of a rigid body follows from the loads of all its spheres
// (docs/physics section 3.1). There is one loop for both, because software drivers compile a copy of a function for each call.
fn accelerated(i: u32) -> vec3f {
    var record = NONE;
    var count = 1u;
    if RIGID_BODIES & FREE_TABLE {
        let body = body_of_sphere(i);
        if body != NO_RIGID {
            record = rigid_record(body);
            count = topology[record + 13u];
        }
    }
    var force = vec3f(0.0);
    var torque = vec3f(0.0);
    var rates = Rates(vec3f(0.0), vec3f(0.0));
    for (var member = 0u; member < count; member++) {
        var j = i;
        if record != NONE {
            j = id_of(topology[topology[record + 12u] + member]);
        }
        rates = Rates(free_acceleration(j), vec3f(0.0));
        add_user(j, &rates);
        if record != NONE {
            let pull = (rates.acceleration - step.gravity) / inverse_mass(j);
            force += pull;
            torque += rates.torque + cross(lever_on_body(record, j, 0.0), pull);
        }
    }
    if record == NONE {
        return rates.acceleration;
    }
    let turning = by_inverse_inertia(record, torque);
    return step.gravity + float_at(record + 3u) * force + cross(turning, lever_on_body(record, i, 0.0));
}

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
        acceleration = accelerated(i);
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
