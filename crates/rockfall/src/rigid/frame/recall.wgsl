// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/past.wgsl

// Points take over the impulses that they had in the last frame (docs/physics section 11.5): from the point with their id, else from
// the nearest one that is free and near enough. The w of the first softness has the factor for another substep.

const NOBODY: u32 = 0xffffffffu;

fn old_pair_of(own: vec4u, owner: u32) -> u32 {
    for (var q = old_starts[owner]; q < old_starts[owner + 1u]; q++) {
        if all(old_pairs[2u * q] == own) {
            return q;
        }
    }
    return NOBODY;
}

fn near_of(a: u32, b: u32) -> f32 {
    let radius_a = select(3e38, bodies[BODY_ROWS * a + 6u].w, has_mass(a));
    let radius_b = select(3e38, bodies[BODY_ROWS * b + 6u].w, has_mass(b));
    return 0.1 * min(radius_a, radius_b);
}

// The old partner of each point: its number, or 4.
fn partners_of(first: u32, count: u32, old: u32, near: f32) -> vec4u {
    var partners = vec4u(4u);
    var taken = vec4<bool>(false);
    let others = old_pairs[2u * old + 1u].x;
    for (var k = 0u; k < count; k++) {
        let id = points[POINT_ROWS * (first + k)].w;
        for (var j = 0u; j < others; j++) {
            if !taken[j] && partners[k] == 4u && old_points[2u * (4u * old + j)].w == id {
                partners[k] = j;
                taken[j] = true;
            }
        }
    }
    for (var k = 0u; k < count; k++) {
        if partners[k] != 4u {
            continue;
        }
        let place = bitcast<vec3f>(points[POINT_ROWS * (first + k)].xyz);
        var least = near * near;
        for (var j = 0u; j < others; j++) {
            let offset = bitcast<vec3f>(old_points[2u * (4u * old + j)].xyz) - place;
            let square = dot(offset, offset);
            if !taken[j] && (square < least || (partners[k] == 4u && square == least)) {
                partners[k] = j;
                least = square;
            }
        }
        if partners[k] != 4u {
            taken[partners[k]] = true;
        }
    }
    return partners;
}

@compute @workgroup_size(THREADS)
fn recall(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let p = thread_of(group, groups, local);
    if p >= pair_count(arrayLength(&pairs) / PAIR_ROWS) {
        return;
    }
    let own = pairs[PAIR_ROWS * p + 3u];
    let face = face_at(p);
    let old = old_pair_of(own, owner_of(own.zw));
    var partners = vec4u(4u);
    if old != NOBODY {
        partners = partners_of(face.first, count_of(face), old, near_of(own.z, own.w));
    }
    let scale = frame.soft[0].w;
    for (var k = 0u; k < 4u; k++) {
        var kept = vec4f(0.0);
        if partners[k] != 4u {
            let before = scale * bitcast<vec4f>(old_points[2u * (4u * old + partners[k]) + 1u]);
            let one = dot(before.xyz, tangent_one(face.normal));
            kept = vec4f(before.w, one, dot(before.xyz, tangent_two(face.normal)), 0.0);
        }
        contacts[2u * (face.first + k)] = vec4f(0.0);
        contacts[2u * (face.first + k) + 1u] = kept;
    }
}
