// requires model/step.wgsl physics/travel.wgsl

// How far a sphere may move before its list is no longer enough.

// How far a ball reaches out of the ball that its AABB encloses; not positive where it is inside. For rounding far from the
// origin there is a little room besides, which the lists allow for.
fn reach_out(position: vec3f, radius: f32, aabb: Aabb) -> f32 {
    let half = 0.5 * aabb.max - 0.5 * aabb.min;
    let room = min(min(half.x, half.y), half.z);
    // An AABB without bounds has no middle.
    if room > 1e37 {
        return -1.0;
    }
    let middle = 0.5 * aabb.min + 0.5 * aabb.max;
    let far = abs(middle);
    return length(position - middle) + radius - room - 2.5e-7 * max(max(far.x, far.y), far.z);
}

// How far a sphere is outside of where its list holds, in 0.02 r; 0 where it is inside.
fn escape_ratio(position: vec3f, radius: f32, aabb: Aabb) -> f32 {
    let out = reach_out(position, radius, aabb);
    if out <= 0.0 {
        return 0.0;
    }
    return clamp(out / (0.02 * radius), 1e-3, 1e30);
}

// A sphere that may be outside before the lists made at the next chance hold, at the velocity at hand, asks for new ones.
fn ask_for_lists(sphere: u32, centre: vec4f, velocity: vec4f) {
    let reach = centre.w + may_travel(velocity, centre.w, step.list_interval);
    if velocity.w > 0.0 {
        if reach_out(place_ahead(centre.xyz, velocity), reach, aabbs[sphere]) > 0.0 {
            // Among millions most find that somebody has asked before, and to look takes less than to ask.
            if (atomicLoad(&status.rebuild) & REBUILD_REQUESTED) == 0u {
                atomicOr(&status.rebuild, REBUILD_REQUESTED);
            }
        }
    }
}

// The lists that were made in this step are counted; those that were asked for where none are made are still due.
fn count_rebuild() {
    if (atomicLoad(&status.rebuild) & REBUILD_DONE) != 0u {
        atomicAnd(&status.rebuild, ~REBUILD_DONE);
        status.builds += 1u;
    }
}
