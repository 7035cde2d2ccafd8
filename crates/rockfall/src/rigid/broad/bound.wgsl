// requires rigid/broad/search.wgsl rigid/frame/colliders.wgsl rigid/frame/rows.wgsl rigid/collide/solid.wgsl physics/quaternion.wgsl

// AABBs and cells of the colliders (docs/physics section 11.3). `rigid/shape/bounds.rs` is the twin.

struct Box {
    least: vec3f,
    most: vec3f,
}

// The inner side of a plane is infinite, but for an axis along its normal up to rounding.
fn box_of_half_space(normal: vec3f, origin: vec3f) -> Box {
    let beside = max(abs(normal.yzx), abs(normal.zxy));
    let is_along = beside <= vec3f(1e-6);
    return Box(
        select(vec3f(-FAR), origin, is_along & (normal <= vec3f(0.0))), select(vec3f(FAR), origin, is_along & (normal > vec3f(0.0))));
}

// A smooth wall with its axis along y.
fn box_of_smooth(shape: Shape, y: vec3f, origin: vec3f) -> Box {
    if shape.more == HALF_SPACE {
        return box_of_half_space(y, origin);
    }
    var half = vec3f(shape.size.x);
    if shape.more != BOWL {
        half = abs(y) * shape.size.x + max(shape.size.y, shape.size.z) * sqrt(max(vec3f(1.0) - y * y, vec3f(0.0)));
    }
    return Box(origin - half, origin + half);
}

// The box along the outer axes around the core of a shape.
fn box_of_core(shape: Shape, origin: vec3f, turn: vec4f) -> Box {
    let x = turned_vector(turn, vec3f(1.0, 0.0, 0.0));
    let y = turned_vector(turn, vec3f(0.0, 1.0, 0.0));
    let z = turned_vector(turn, vec3f(0.0, 0.0, 1.0));
    if shape.core == CORE_SMOOTH {
        return box_of_smooth(shape, y, origin);
    }
    if HULLS & (shape.core == CORE_HULL) {
        var box = Box(vec3f(FAR), vec3f(-FAR));
        for (var k = 0u; k < 64u && k < vertices_of_core(shape); k++) {
            let vertex = vertex_of_core(shape, k);
            let place = origin + (vertex.x * x + vertex.y * y + vertex.z * z);
            box = Box(min(box.least, place), max(box.most, place));
        }
        return box;
    }
    var half = vec3f(0.0);
    if shape.core == CORE_BOX {
        half = abs(x) * shape.size.x + abs(y) * shape.size.y + abs(z) * shape.size.z;
    } else if shape.core == CORE_SEGMENT {
        half = abs(y) * shape.size.x;
    } else if shape.core == CORE_FACE && (shape.more & TRIANGLE) != 0u {
        let u = x * shape.size.x + y * shape.size.y;
        let v = x * shape.size.z + y * shape.size.w;
        return Box(origin + min(min(u, v), -u - v), origin + max(max(u, v), -u - v));
    } else if shape.core == CORE_FACE {
        half = abs(x * shape.size.x + y * shape.size.y) + abs(x * shape.size.z + y * shape.size.w);
    }
    return Box(origin - half, origin + half);
}

fn bound_collider(collider: u32) {
    let body = body_of_collider(collider);
    let outer = turn_of(body);
    let origin = place_of(body) + turned_vector(outer, place_of_collider(collider));
    let shape = shape_of_collider(collider);
    let core = box_of_core(shape, origin, multiply(outer, turn_of_collider(collider)));
    let grown = shape.radius + bodies[BODY_ROWS * body + 5u].w;
    let least = core.least - grown;
    let most = core.most + grown;
    let edges = most - least;
    let far = max(abs(least), abs(most));
    let reach = max(far.x, max(far.y, far.z));
    let size = max(edges.x, max(edges.y, edges.z)) * (1.0 + ROUNDING) + ROUNDING * reach;
    if PERIODIC && has_mass(body) {
        // Whatever reaches out of the box does so by less than this.
        atomicMax(&counts[4], bitcast<u32>(min(size, FAR)));
    }
    // Shared walls are few, and all worlds look at them.
    let home = home_in_search(body);
    let level = select(level_of(size), LEVELS, JOINED && home == 0u);
    var key = vec2u(LARGE);
    if level < LEVELS {
        key = key_in_world(key_of(level, vec3i(floor((least + most) * (0.5 * fineness_of(level))))), home);
        atomicAdd(&cells[slot_of(key)], 1u);
        let bit = 1u << level;
        if (atomicLoad(&counts[2]) & bit) == 0u {
            atomicOr(&counts[2], bit);
        }
    } else {
        members[search.colliders + atomicAdd(&counts[3], 1u)] = collider;
    }
    bounds[2u * collider] = vec4u(bitcast<vec3u>(least), key.x);
    bounds[2u * collider + 1u] = vec4u(bitcast<vec3u>(most), key.y);
}

@compute @workgroup_size(THREADS)
fn bound(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let collider = thread_of(group, groups, local);
    if collider < search.colliders {
        bound_collider(collider);
    }
}

// Puts the colliders in the order of their slots. Now `cells` has where they start, and comes to have where they end.
@compute @workgroup_size(THREADS)
fn scatter(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let collider = thread_of(group, groups, local);
    if collider >= search.colliders {
        return;
    }
    let key = vec2u(bounds[2u * collider].w, bounds[2u * collider + 1u].w);
    if any(key != vec2u(LARGE)) {
        members[atomicAdd(&cells[slot_of(key)], 1u)] = collider;
    }
}
