// requires model/step.wgsl physics/period.wgsl physics/travel.wgsl

// Tests whether a sphere is still inside the ball for which its pair list is valid.

// How far a ball extends beyond the ball that an AABB encloses; not positive when it is inside. The ball must be
// inside by more than the rounding errors far from the origin. In periodic scenes, the nearest image of the ball counts. In sheared ones the
// images of other bodies may have come nearer by what they slide in a step.
fn distance_outside(position: vec3f, radius: f32, aabb: Aabb) -> f32 {
    if !ESCAPES {
        return -1.0;
    }
    let half = 0.5 * aabb.max - 0.5 * aabb.min;
    let room = min(min(half.x, half.y), half.z);
    // An unbounded AABB has no centre.
    if room > 1e37 {
        return -1.0;
    }
    let middle = 0.5 * aabb.min + 0.5 * aabb.max;
    var far = max(abs(aabb.min), abs(aabb.max));
    if PERIODIC {
        far = max(far, abs(position));
    }
    return length(nearest_image(position - middle)) + slide_in_step() + radius - room + ROUNDING_SLACK * max(max(far.x, far.y), far.z);
}

// How far a sphere at a place is outside the ball that its AABB encloses, in units of 0.02 times its radius; 0 when it is
// inside.
fn escape_ratio(position: vec3f, radius: f32, aabb: Aabb) -> f32 {
    let out = distance_outside(position, radius + step.neck * radius, aabb);
    if out <= 0.0 {
        return 0.0;
    }
    return clamp(out / (0.02 * radius), 1e-3, 1e30);
}

// Requests new lists when a moving sphere, at its present velocity, may leave the ball that its AABB encloses within the
// `list_interval` steps for which the lists must last.
fn request_rebuild(sphere: u32, centre: vec4f, velocity: vec4f) {
    if SHEARED {
        // Images pass each other however slowly bodies move.
        atomicOr(&status.rebuild, REBUILD_REQUESTED);
        return;
    }
    let reach = centre.w + step.neck * centre.w + travel_bound(velocity, centre.w, step.list_interval);
    if velocity.w > 0.0 {
        if distance_outside(position_ahead(centre.xyz, velocity), reach, aabbs[sphere]) > 0.0 {
            // Among millions of spheres, most find the flag already set. A load is cheaper than an atomic write.
            if (atomicLoad(&status.rebuild) & REBUILD_REQUESTED) == 0u {
                atomicOr(&status.rebuild, REBUILD_REQUESTED);
            }
        }
    }
}

// Counts the rebuild of the lists, if there was one in this step. A request for a rebuild that was not made stays pending.
fn count_rebuild() {
    if (atomicLoad(&status.rebuild) & REBUILD_DONE) != 0u {
        atomicAnd(&status.rebuild, ~REBUILD_DONE);
        status.builds += 1u;
    }
}
