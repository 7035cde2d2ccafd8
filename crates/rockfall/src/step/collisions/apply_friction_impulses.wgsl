// requires model/lists.wgsl model/objects.wgsl model/one_state.wgsl model/step.wgsl physics/collision.wgsl physics/contact.wgsl
// requires physics/friction_impulses.wgsl physics/motion.wgsl step/collisions/rows.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read> collisions: array<vec4u>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// The sums of the friction impulses on a sphere or a capsule.
struct FrictionSums {
    // Sum of the impulses.
    velocity: vec3f,
    // Sum of the torques. For a capsule: about its centre of mass, the part across the axis.
    turning: vec3f,
    // For a capsule: the part of that sum along the axis.
    rolling: vec3f,
}

// The share of the impulses on a row that a sphere gets. `at` is the parameter of the contact on the row, if it is a rod.
fn share_of(sphere: u32, row: u32, at: f32) -> f32 {
    if !RODS | (row < step.spheres) {
        return 1.0;
    }
    return select(at, 1.0 - at, rod_ends(row - step.spheres).x == sphere);
}

fn add_to_sphere(rub: FrictionImpulse, sphere: u32, row: u32, rubbed: ptr<function, FrictionSums>) {
    let is_a = rub.a_id == row;
    let share = share_of(sphere, row, select(rub.at.y, rub.at.x, is_a));
    let arm = select(rub.arms.y, rub.arms.x, is_a);
    // The torques on both sides have the same sign: the impulses are opposite, and the arms are too.
    (*rubbed).velocity = fma(rub.impulse, vec3f(select(-share, share, is_a)), (*rubbed).velocity);
    (*rubbed).turning = fma(cross(rub.n, rub.impulse), vec3f(share * arm), (*rubbed).turning);
}

fn add_to_capsule(rub: FrictionImpulse, capsule: Capsule, rod: u32, row: u32, rubbed: ptr<function, FrictionSums>) {
    let is_a = rub.a_id == row;
    let at = at_on_capsule(rod, row, select(rub.at.y, rub.at.x, is_a));
    let torque = select(rub.arms.y, rub.arms.x, is_a) * cross(rub.n, rub.impulse);
    let grip = capsule_load(capsule, at, select(-rub.impulse, rub.impulse, is_a), torque);
    (*rubbed).velocity += grip.push;
    (*rubbed).turning += grip.turning;
    (*rubbed).rolling += grip.rolling;
}

// The sums for sphere i, or for its capsule if `rod` is not NONE. There is one loop for both, because software drivers compile
// a copy of `friction_impulse_of` for every call.
fn friction_sums(i: u32, rod: u32, capsule: Capsule) -> FrictionSums {
    var rubbed = FrictionSums(vec3f(0.0), vec3f(0.0), vec3f(0.0));
    var rods = vec2u(0u);
    if RODS {
        rods = rods_of(i);
    }
    for (var r = 0u; r < body_rows(rod, rods); r++) {
        let row = body_row(i, rod, rods, r);
        let count = count_of(row);
        let first = first_of(row);
        for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
            for (var rest = entries_with(ENTRY_OVERLAPS, first, begin, count); rest != 0u; rest &= rest - 1u) {
                let rub = friction_impulse_of(row, slot_at(first, begin + firstTrailingBit(rest)));
                if RODS & (rod != NONE) {
                    add_to_capsule(rub, capsule, rod, row, &rubbed);
                } else {
                    add_to_sphere(rub, i, row, &rubbed);
                }
            }
        }
    }
    return rubbed;
}

fn sphere_after_friction(i: u32, rubbed: FrictionSums) -> Motion {
    let velocity = state[velocity_at(i)];
    return Motion(
        state[position_at(i)].xyz,
        low_row(i),
        velocity.xyz + velocity.w * rubbed.velocity,
        state[momentum_at(i)].xyz + rubbed.turning,
    );
}

fn end_after_friction(i: u32, rod: u32, capsule: Capsule, rubbed: FrictionSums) -> Motion {
    let ends = rod_ends(rod);
    let offset = select(-capsule.centre, 1.0 - capsule.centre, ends.y == i) * capsule.d;
    let turning = capsule.inverse_inertia * rubbed.turning;
    let velocity = state[velocity_at(i)].xyz + capsule.inverse_mass * rubbed.velocity + cross(turning, offset);
    let momentum = state[momentum_at(i)];
    let angular_momentum = momentum.xyz + (turning + inverse_roll(ends) * rubbed.rolling) / momentum.w;
    return Motion(state[position_at(i)].xyz, low_row(i), velocity, angular_momentum);
}

// The new state of a sphere.
fn motion_after_friction(i: u32) -> Motion {
    if inverse_mass(i) <= 0.0 {
        return Motion(state[position_at(i)].xyz, low_row(i), state[velocity_at(i)].xyz, state[momentum_at(i)].xyz);
    }
    var rod = NONE;
    var capsule = Capsule(vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, 0.0, 0.0);
    if RODS {
        rod = capsule_with(i);
        if rod != NONE {
            capsule = capsule_of(rod_ends(rod), side_motion(contact_side(i, 0.0)));
        }
    }
    let rubbed = friction_sums(i, rod, capsule);
    if RODS & (rod != NONE) {
        return end_after_friction(i, rod, capsule, rubbed);
    }
    return sphere_after_friction(i, rubbed);
}

@compute @workgroup_size(64)
fn apply_friction_impulses(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) | (atomicLoad(&status.collided) != 2u) {
        return;
    }
    var after = motion_after_friction(i);
    if (inverse_mass(i) > 0.0) & !is_finite(after) {
        after = stopped(state[position_at(i)].xyz, low_row(i), 0u, i);
    }
    next[position_at(i)] = vec4f(after.position, state[position_at(i)].w);
    next[velocity_at(i)] = vec4f(after.velocity, inverse_mass(i));
    next[momentum_at(i)] = vec4f(after.momentum, state[momentum_at(i)].w);
    next[low_at(i)] = vec4f(after.low, 0.0);
}
