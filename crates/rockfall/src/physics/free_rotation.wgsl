// requires model/step.wgsl physics/quaternion.wgsl physics/sine.wgsl

// Free rotation of rigid bodies (docs/physics section 5.9).

struct Moments {
    // kappa.
    excess: vec3f,
    // 1 / J_m.
    middle: f32,
    // The rotation from the principal axes to the coordinates of the shape.
    axes: vec4f,
}

// A principal axis of a body with this orientation.
fn principal_axis(orientation: vec4f, moments: Moments, k: u32) -> vec3f {
    return turned_vector(orientation, turned_vector(moments.axes, vec3f(f32(k == 0u), f32(k == 1u), f32(k == 2u))));
}

// Rotation by an angular velocity times a time.
fn turn_about(turn: vec3f) -> vec4f {
    let squared = dot(turn, turn);
    if squared <= TINY {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let angle = sqrt(squared);
    let half = sine_cosine(0.5 * angle);
    return vec4f(turn * (half.x / angle), half.y);
}

fn spin_of_body(orientation: vec4f, moments: Moments, momentum: vec3f) -> vec3f {
    var spin = moments.middle * momentum;
    for (var k = 0u; k < 3u; k++) {
        let axis = principal_axis(orientation, moments, k);
        spin += moments.excess[k] * dot(axis, momentum) * axis;
    }
    return spin;
}

// Phi: the orientation after a free rotation for a time.
fn freely_turned(before: vec4f, moments: Moments, momentum: vec3f, time: f32) -> vec4f {
    var q = multiply(turn_about(time * moments.middle * momentum), before);
    for (var turn = 0u; turn < 5u; turn++) {
        // The axes 0, 1, 2, 1, 0.
        let k = min(turn, 4u - turn);
        if moments.excess[k] != 0.0 {
            let axis = principal_axis(q, moments, k);
            let share = select(0.5, 1.0, k == 2u);
            q = multiply(turn_about(share * time * moments.excess[k] * dot(axis, momentum) * axis), q);
        }
    }
    return q / sqrt(dot(q, q));
}
