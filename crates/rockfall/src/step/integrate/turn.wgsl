// requires model/objects.wgsl model/one_state.wgsl model/step.wgsl physics/fine.wgsl physics/quaternion.wgsl physics/rotation.wgsl
// requires physics/scale.wgsl

@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> y3: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> orientations: array<vec4f>;
@group(0) @binding(5) var<storage, read> topology: array<u32>;
@group(0) @binding(6) var<storage, read> status: Status;

// The shortest rotation from one unit vector to another. For opposite vectors, the axis is any perpendicular one.
fn shortest_rotation(old: vec3f, new_: vec3f) -> vec4f {
    let w = 1.0 + dot(old, new_);
    if w > 1e-6 {
        return normalize(vec4f(cross(old, new_), w));
    }
    let across = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(old.x) > 0.7);
    return vec4f(normalize(cross(old, across)), 0.0);
}

// The axis before a step of symplectic Euler, from that after the step and the displacement across it of end 2 relative to
// end 1, over the length.
fn axis_before(axis: vec3f, across: vec3f) -> vec3f {
    return sqrt(max(1.0 - dot(across, across), 0.0)) * axis - across;
}

// The rod of a fixed length that is the only rod of both its ends, of which the sphere is one, or NONE. Neither end is fixed. It is a
// rigid capsule if the ends do not coincide.
fn free_rod(sphere: u32) -> u32 {
    let rod = capsule_rod(sphere);
    if rod == NONE {
        return NONE;
    }
    let ends = rod_ends(rod);
    if capsule_rod(other_end(rod, sphere)) != rod {
        return NONE;
    }
    if (inverse_mass(ends.x) <= 0.0) | (inverse_mass(ends.y) <= 0.0) {
        return NONE;
    }
    return rod;
}

fn turn_sphere(i: u32) {
    turn_by(i, rotation(y3[momentum_at(i)].xyz));
}

// Gives both ends of a capsule a common spin (docs/physics section 5.5, E18). Across the axis it is the angular velocity
// of the rigid body. The rest of the ends' angular momentum across the axis becomes momentum of the ends. This happens
// gradually during the step, so the axis moves by half the time step times the change of velocity. With symplectic Euler it
// moves by the whole time step times the part of that change that is due to forces and torques. The spin refers to the moved
// axis.
fn turn_capsule(ends: vec2u) {
    let x1 = state[position_at(ends.x)];
    let x2 = state[position_at(ends.y)];
    let v1 = state[velocity_at(ends.x)];
    let v2 = state[velocity_at(ends.y)];
    let l1 = state[momentum_at(ends.x)];
    let l2 = state[momentum_at(ends.y)];
    let d = between(ends.x, ends.y);
    let dd = dot(d, d);
    let v = v2.xyz - v1.xyz;
    let inertia = vec2f(1.0 / l1.w, 1.0 / l2.w);
    let along = inertia.x + inertia.y;
    let mass = 1.0 / (v1.w + v2.w);
    let across = along + mass * dd;

    let spins = l1.xyz + l2.xyz;
    let orbit = mass * cross(d, v);
    // v is the velocity of end 2 relative to end 1. Its part along the axis, `opening` times d, stays. `change` leads from
    // v to the velocity that the rigid body requires.
    let opening = dot(v, d) / dd;
    let change = cross((spins + orbit) / across, d) + opening * d - v;
    var there = d + 0.5 * step.dt * (change - (dot(change, d) / dd) * d);
    if HALF_STEP {
        // Forces and torques change the spins at the start of the step, across the axis of that time.
        let axis = d / sqrt(dd);
        let first_axis = axis_before(axis, step.dt / sqrt(dd) * (v - opening * d));
        let excess = spins - along / across * (spins + orbit);
        let first_excess = excess - dot(excess, first_axis) * first_axis;
        there += 0.5 * step.dt / (mass * sqrt(dd)) * cross(first_excess, axis);
    }
    let new_d = there * sqrt(dd / dot(there, there));
    // Scaled, because angular momentum times a length may overflow.
    let size = scale_of(d);
    let scaled = size * new_d;
    let square = dot(scaled, scaled);

    // The orbital angular momentum is perpendicular to d, so only the difference between the new direction and d counts for
    // it. Division by the square keeps rounding errors of a unit vector's length out of the spin.
    let roll = (dot(spins, scaled) + dot(orbit, scaled - size * d)) / along / square;
    let spin_across = (spins + orbit - (dot(spins + orbit, scaled) / square) * scaled) / across;
    let spin = roll * scaled + spin_across;
    let new_v = cross(spin_across, new_d) + opening * new_d;
    let new_x1 = fine_moved(fine_position(ends.x), -(v1.w * mass) * (new_d - d));
    let new_x2 = fine_moved(fine_position(ends.y), (v2.w * mass) * (new_d - d));
    let new_v1 = v1.xyz - (v1.w * mass) * (new_v - v);
    let new_v2 = v2.xyz + (v2.w * mass) * (new_v - v);
    // If a result is not finite, each end keeps its own spin.
    let places = finite(new_x1.high) & finite(new_x2.high) & finite(new_v1) & finite(new_v2);
    if places & finite(inertia.x * spin) & finite(inertia.y * spin) {
        state[position_at(ends.x)] = vec4f(new_x1.high, x1.w);
        state[position_at(ends.y)] = vec4f(new_x2.high, x2.w);
        state[low_at(ends.x)] = vec4f(new_x1.low, 0.0);
        state[low_at(ends.y)] = vec4f(new_x2.low, 0.0);
        state[velocity_at(ends.x)] = vec4f(new_v1, v1.w);
        state[velocity_at(ends.y)] = vec4f(new_v2, v2.w);
        state[momentum_at(ends.x)] = vec4f(inertia.x * spin, l1.w);
        state[momentum_at(ends.y)] = vec4f(inertia.y * spin, l2.w);
    }

    let old = y3[position_at(ends.y)].xyz - y3[position_at(ends.x)].xyz;
    var old_axis = d / sqrt(dd);
    if dot(old, old) > TINY {
        old_axis = normalize(old);
    }
    let by = multiply(shortest_rotation(old_axis, scaled / sqrt(square)), rotation(roll * sqrt(square) * old_axis));
    turn_by(ends.x, by);
    turn_by(ends.y, by);
}

@compute @workgroup_size(64)
fn turn(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (status.rejected != 0u) {
        return;
    }
    let rod = free_rod(i);
    if rod == NONE {
        turn_sphere(i);
        return;
    }
    // The thread of the first end handles both, because it moves them.
    let ends = rod_ends(rod);
    if ends.x != i {
        return;
    }
    let d = between(ends.x, ends.y);
    if dot(d, d) > TINY {
        turn_capsule(ends);
    } else {
        turn_sphere(ends.x);
        turn_sphere(ends.y);
    }
}
