// requires rigid/frame/rows.wgsl physics/quaternion.wgsl physics/sine.wgsl

// Inertia and the free rotation (docs/physics sections 5.9 and 11.1).

struct Top {
    moments: vec3f,
    // 1 / J_m.
    middle: f32,
    // kappa.
    excess: vec3f,
    // Turns coordinates along the principal axes into those of the body.
    axes: vec4f,
}

fn top_of(body: u32) -> Top {
    let at = CONSTANT_ROWS * body;
    let j = constants[at + 1u].xyz;
    let middle = max(min(j.x, j.y), min(max(j.x, j.y), j.z));
    let excess = select(1.0 / j - vec3f(1.0 / middle), vec3f(0.0), j == vec3f(middle));
    return Top(j, 1.0 / middle, excess, constants[at]);
}

// A principal axis in the world.
fn axis_of(top: Top, q: vec4f, k: u32) -> vec3f {
    return turned_vector(q, turned_vector(top.axes, vec3f(f32(k == 0u), f32(k == 1u), f32(k == 2u))));
}

fn mass_in(top: Top, q: vec4f, inverse_mass: f32) -> Mass {
    var mass = Mass(inverse_mass, vec3f(top.middle), vec3f(0.0));
    for (var k = 0u; k < 3u; k++) {
        let excess = select(top.excess.x, select(top.excess.y, top.excess.z, k == 2u), k > 0u);
        if excess != 0.0 {
            let e = axis_of(top, q, k);
            mass.diagonal += excess * e * e;
            mass.beside += excess * e.xxy * e.yzz;
        }
    }
    return mass;
}

// The rotation by a vector.
fn rotation_by(turn: vec3f) -> vec4f {
    let squared = dot(turn, turn);
    if squared <= 1e-30 {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let angle = sqrt(squared);
    let half = sine_cosine(0.5 * angle);
    return vec4f(turn * (half.x / angle), half.y);
}

fn turned_about(top: Top, q: vec4f, momentum: vec3f, k: u32, rate: f32) -> vec4f {
    if rate == 0.0 {
        return q;
    }
    let e = axis_of(top, q, k);
    return multiply(rotation_by(rate * dot(e, momentum) * e), q);
}

fn unit_turn(q: vec4f) -> vec4f {
    return q / sqrt(dot(q, q));
}

// Phi.
fn freely_turned(top: Top, before: vec4f, momentum: vec3f, time: f32) -> vec4f {
    let half = 0.5 * time;
    var q = multiply(rotation_by(time * top.middle * momentum), before);
    q = turned_about(top, q, momentum, 0u, half * top.excess.x);
    q = turned_about(top, q, momentum, 1u, half * top.excess.y);
    q = turned_about(top, q, momentum, 2u, time * top.excess.z);
    q = turned_about(top, q, momentum, 1u, half * top.excess.y);
    q = turned_about(top, q, momentum, 0u, half * top.excess.x);
    return unit_turn(q);
}
