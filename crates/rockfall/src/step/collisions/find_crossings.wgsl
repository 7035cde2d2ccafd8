// requires model/counters.wgsl model/entries.wgsl model/lists.wgsl model/objects.wgsl model/collision_state.wgsl model/order.wgsl
// requires model/step.wgsl physics/collision/crossings.wgsl physics/collision/lone.wgsl physics/contact.wgsl
// requires physics/escape.wgsl physics/collision/hidden_crossing.wgsl physics/round_pair.wgsl step/collisions/crossing_rows.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(6) var<storage, read_write> crossings: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// Whether a step has led to the present state.
fn has_moved() -> bool {
    return status.lengths_due == 0u;
}

// Rejects the step when a sphere, or the place where it was before the last step, is outside its AABB.
fn check_path(i: u32, centre: vec4f, velocity: vec4f) {
    if velocity.w <= 0.0 {
        return;
    }
    var ratio = escape_ratio(centre.xyz, centre.w, aabbs[i]);
    if has_moved() {
        ratio = max(ratio, escape_ratio(centre.xyz - step.dt * velocity.xyz, centre.w, aabbs[i]));
    }
    if ratio > 0.0 {
        report_escape(ratio, ESCAPED_ON_PATHS);
    }
}

// The crossing that counts for a sphere.
struct Earliest {
    other: u32,
    time: f32,
}

fn earliest_of(i: u32, radius: f32) -> Earliest {
    var earliest = Earliest(NONE, NO_CROSSING);
    let count = count_of(i);
    let first = first_of(i);
    for (var e = 0u; e < count; e++) {
        let other = entry_id(entry_at(slot_at(first, e)));
        var least = radius;
        if other < step.spheres {
            least = min(radius, state[position_at(other)].w);
        }
        let pair = ordered(i, other);
        let time = time_of_colliding_crossing(pair.x, pair.y, least, collision_velocity(least, i, other));
        // Entries are in insertion order, so that of equal times the first one stays.
        if (time >= 0.0) && (time > earliest.time) && !is_hidden_crossing(i, other, time) {
            earliest = Earliest(other, time);
        }
    }
    return earliest;
}

@compute @workgroup_size(64)
fn find_crossings(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if i >= step.spheres {
        return;
    }
    if was_rejected_before(ESCAPED_ON_PATHS, 0u) | (atomicLoad(&status.collided) != 0u) {
        return;
    }
    let centre = state[position_at(i)];
    let velocity = state[velocity_at(i)];
    check_path(i, centre, velocity);
    var moved = vec4f(0.0, 0.0, 0.0, -1.0);
    var pushed = vec4f(0.0);
    if (velocity.w > 0.0) & is_free_sphere(i) & has_moved() {
        let earliest = earliest_of(i, centre.w);
        if earliest.other != NONE {
            let pair = ordered(i, earliest.other);
            let now = contact_before(pair.x, pair.y, 0.0);
            let found = Touch(now.n, now.overlap, 0.0, 0.0);
            let solved = solve_from(pair.x, pair.y, 0u, found, earliest.time, true);
            let change = select(1.0, -1.0, pair.x == i) * solved.impulse * velocity.w * solved.n;
            moved = vec4f(solved.tau * change, f32(earliest.other & 0xffffu));
            var is_alone = earliest.other >= step.spheres;
            if !is_alone {
                is_alone = inverse_mass(earliest.other) <= 0.0;
            }
            pushed = vec4f(change, f32((earliest.other >> 16u) + select(0u, ALONE, is_alone)));
        }
    }
    crossings[i] = moved;
    crossings[2u * step.spheres + i] = pushed;
}
