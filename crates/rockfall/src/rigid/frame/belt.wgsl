// requires rigid/frame/states.wgsl rigid/frame/rows.wgsl physics/quaternion.wgsl

// Velocity of the surface of b less that of a along the tangents (docs/physics section 11.4).
fn belt_in(sight: Sight, pair: u32, normal: vec3f) -> vec2f {
    let at = PAIR_ROWS * pair;
    if (pairs[at + 1u].w & BELT) == 0u {
        return vec2f(0.0);
    }
    let sides = pairs[at + 3u].xy + vec2u(CONSTANT_ROWS * frame.bodies);
    let slip = turned_vector(sight.b.turn, constants[sides.y].xyz) - turned_vector(sight.a.turn, constants[sides.x].xyz);
    return vec2f(dot(slip, tangent_one(normal)), dot(slip, tangent_two(normal)));
}
