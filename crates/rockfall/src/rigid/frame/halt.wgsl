// requires rigid/frame/rows.wgsl

fn is_finite(v: vec3f) -> bool {
    return all((bitcast<vec3u>(v) & vec3u(0x7f800000u)) != vec3u(0x7f800000u));
}

// Whether all points of a body are finite in a pose.
fn fits(body: u32, place: vec3f, turn: vec4f) -> bool {
    let radius = bodies[BODY_ROWS * body + 6u].w;
    return is_finite(abs(place) + radius) & is_finite(turn.xyz) & is_finite(turn.www);
}

// Whether the velocities of all points of a body, and the angular momenta of all spheres in it, are finite. Their radii are at most
// twice that of the body.
fn moves_finitely(body: u32) -> bool {
    let at = BODY_ROWS * body;
    let radius = bodies[at + 6u].w;
    let velocity = bodies[at + 2u].xyz;
    let rim = radius * bodies[at + 3u].xyz;
    let speed = max(max(abs(velocity.x), abs(velocity.y)), abs(velocity.z)) + (abs(rim.x) + abs(rim.y) + abs(rim.z));
    let inner = (1.6 * radius) * rim / bodies[at + 2u].w;
    return is_finite(velocity) & is_finite(vec3f(speed)) & is_finite(inner) & is_finite(bodies[at + 6u].xyz);
}

// Stops a body where it is: its next pose or its motion is not finite.
fn halt(body: u32) {
    let at = BODY_ROWS * body;
    bodies[at + 2u] = vec4f(0.0, 0.0, 0.0, bodies[at + 2u].w);
    bodies[at + 3u] = vec4f(0.0, 0.0, 0.0, bodies[at + 3u].w);
    bodies[at + 6u] = vec4f(0.0, 0.0, 0.0, bodies[at + 6u].w);
    bodies[at + 7u].w = 1.0;
    bodies[at + 8u] = vec4f(0.0, 0.0, 0.0, bodies[at + 8u].w + 1.0);
}
