// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/past.wgsl rigid/frame/report.wgsl

// The end of a frame: what its contacts come to, and what is kept of them (docs/physics section 11.5).

fn is_number(v: vec4f) -> bool {
    return all((bitcast<vec4u>(v) & vec4u(0x7f800000u)) != vec4u(0x7f800000u));
}

// The number of points that touch and the deepest overlap.
@compute @workgroup_size(THREADS)
fn sum_up(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let p = thread_of(group, groups, local);
    if p >= pair_count(arrayLength(&pairs) / PAIR_ROWS) {
        return;
    }
    let face = face_at(p);
    var touching = 0u;
    var deepest = 0.0;
    for (var k = face.first; k < face.first + count_of(face); k++) {
        let gap = contacts[2u * k].w;
        touching += u32(gap <= 0.0 || contacts[2u * k + 1u].x > 0.0);
        deepest = max(deepest, -gap);
    }
    if touching > 0u {
        atomicAdd(&report[4], touching);
        atomicMax(&report[5], bitcast<u32>(deepest));
    }
}

@compute @workgroup_size(THREADS)
fn store(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let p = thread_of(group, groups, local);
    if p <= frame.bodies {
        old_starts[p] = owned[p];
    }
    if p >= pair_count(arrayLength(&pairs) / PAIR_ROWS) {
        return;
    }
    let face = face_at(p);
    old_pairs[2u * p] = pairs[PAIR_ROWS * p + 3u];
    let struck = points[POINT_ROWS * face.first + 1u].w;
    let is_finite = (struck & 0x7f800000u) != 0x7f800000u;
    old_pairs[2u * p + 1u] = vec4u(count_of(face), face.info >> 24u, select(0u, struck, is_finite), 0u);
    let one = tangent_one(face.normal);
    let two = tangent_two(face.normal);
    for (var k = 0u; k < count_of(face); k++) {
        let kept = contacts[2u * (face.first + k) + 1u];
        let place = points[POINT_ROWS * (face.first + k)];
        let impulse = vec4f(kept.y * one + kept.z * two, kept.x);
        let holds = is_number(impulse) && is_number(bitcast<vec4f>(vec4u(place.xyz, 0u)));
        old_points[2u * (4u * p + k)] = select(vec4u(0u), place, holds);
        old_points[2u * (4u * p + k) + 1u] = select(vec4u(0u), bitcast<vec4u>(impulse), holds);
    }
}
