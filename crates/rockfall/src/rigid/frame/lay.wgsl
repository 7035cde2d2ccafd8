// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/colliders.wgsl physics/quaternion.wgsl

// Pairs and points of a frame in order (docs/physics sections 11.4 and 11.5). A pair has room for four points.

// The number of materials, 0; then friction and restitution of each two materials.
@group(0) @binding(37) var<storage, read_write> surfaces: array<vec2f>;


// How far apart two bodies may be to touch in this frame without a hit by a third one.
fn reach_of(a: u32, b: u32) -> f32 {
    let dt = frame.h * f32(frame.substeps);
    let one = motion_of(a);
    let other = motion_of(b);
    let speed = length(other.velocity - one.velocity) + turning_speed(a, one.spin) + turning_speed(b, other.spin);
    let radius_a = select(3e38, bodies[BODY_ROWS * a + 6u].w, has_mass(a));
    let radius_b = select(3e38, bodies[BODY_ROWS * b + 6u].w, has_mass(b));
    return speed * dt + length(frame.gravity) * dt * dt + 0.02 * min(radius_a, radius_b);
}

@compute @workgroup_size(THREADS)
fn lay(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let p = thread_of(group, groups, local);
    if p >= pair_count(arrayLength(&sorted)) {
        return;
    }
    let f = FOUND_ROWS * (sorted[p] & ~FIRST_OF_BLOCK);
    let own = found[f];
    let inner = found[f + 1u];
    let turn_a = turn_of(own.z);
    let turn_b = turn_of(own.w);
    let apart = between(own.z, own.w);
    let normal = turned_vector(turn_a, bitcast<vec3f>(inner.xyz));
    let reach = reach_of(own.z, own.w);
    var info = inner.w & ~NEAR;
    for (var k = 0u; k < (inner.w & 0xffu); k++) {
        let on_a = found[f + 2u + 2u * k];
        let on_b = found[f + 3u + 2u * k];
        let at = POINT_ROWS * (4u * p + k);
        points[at] = on_a;
        points[at + 1u] = vec4u(on_b.xyz, 0u);
        let gap = dot(apart + turned_vector(turn_b, bitcast<vec3f>(on_b.xyz)) - turned_vector(turn_a, bitcast<vec3f>(on_a.xyz)), normal);
        info |= select(NEAR, 0u, gap > reach);
    }
    let materials = u32(surfaces[0].x);
    let surface = surfaces[1u + materials * marks_of_collider(own.x).y + marks_of_collider(own.y).y];
    let at = PAIR_ROWS * p;
    pairs[at] = bitcast<vec4u>(vec4f(normal, surface.x));
    pairs[at + 1u] = vec4u(0u, 0u, 4u * p, info);
    pairs[at + 2u] = vec4u(inner.xyz, bitcast<u32>(surface.y));
    pairs[at + 3u] = own;
}
