// requires model/step.wgsl

// Which spheres may pass a wall with their centre within a step (docs/physics section 2.20).

// Whether a moving sphere moves so far in a step that it may pass a wall before a deep contact was seen.
fn is_fast(radius: f32, velocity: vec4f) -> bool {
    return step.dt * length(velocity.xyz) > FAST_WAY * radius;
}

// Whether an overlap is so deep that the centre of a sphere may be near the wall.
fn is_deep(overlap: f32, radius: f32) -> bool {
    return overlap >= DEEP_OVERLAP * radius;
}
