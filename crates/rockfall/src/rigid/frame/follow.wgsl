// requires rigid/frame/rows.wgsl rigid/frame/turn.wgsl

// L = I omega.
fn momentum_in(top: Top, q: vec4f, spin: vec3f) -> vec3f {
    let one = axis_of(top, q, 0u);
    let two = axis_of(top, q, 1u);
    let three = axis_of(top, q, 2u);
    return top.moments.x * dot(one, spin) * one + top.moments.y * dot(two, spin) * two + top.moments.z * dot(three, spin) * three;
}

// The momentum of a body after rows (docs/physics section 11.9): L = I omega where omega differs by a bit from the one that belongs
// to L. That one is omega_0: the kick and the drift set both.
fn follow(body: u32) {
    let at = BODY_ROWS * body;
    let spin = bodies[at + 3u].xyz;
    if any(bitcast<vec3u>(spin) != bitcast<vec3u>(bodies[at + 8u].xyz)) {
        bodies[at + 6u] = vec4f(momentum_in(top_of(body), bodies[at + 1u], spin), bodies[at + 6u].w);
        bodies[at + 8u] = vec4f(spin, 0.0);
    }
}
