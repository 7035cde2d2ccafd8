// requires model/step.wgsl physics/quaternion.wgsl physics/sine.wgsl

// The rotation of `orientations`.

// Rotation by an angular velocity during one step, by the exponential map.
fn rotation(spin: vec3f) -> vec4f {
    let squared = dot(spin, spin);
    if squared <= TINY {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let rate = sqrt(squared);
    let half = sine_cosine(0.5 * rate * step.dt);
    return vec4f(spin * (half.x / rate), half.y);
}

// An orientation after a rotation. A rotation that is not finite is skipped.
fn rotated(before: vec4f, by: vec4f) -> vec4f {
    let after = multiply(by, before);
    let q = after / sqrt(dot(after, after));
    return select(before, q, finite(q.xyz) & finite(q.www));
}

fn turn_by(sphere: u32, by: vec4f) {
    // A sphere that does not rotate keeps its orientation, which then need not be read.
    if all(by.xyz == vec3f(0.0)) {
        return;
    }
    orientations[sphere] = rotated(orientations[sphere], by);
}
