// requires model/objects.wgsl model/step.wgsl physics/geometry.wgsl step/collisions/rows.wgsl

// The two sides of a contact in the collision phase: what gives way there, how fast it closes, and what mass an impulse meets
// (docs/physics.md section 3).

// What one side of a contact is: a box or polygon; a sphere; a rod of free length or of a network; a rigid capsule.
const STATIC: u32 = 0u;
const SPHERE: u32 = 1u;
const ROD: u32 = 2u;
const CAPSULE: u32 = 3u;

struct Half {
    kind: u32,
    id: u32,
    // The sphere itself, or both ends of the rod.
    spheres: vec2u,
    // Parameter of the contact from end 1 to end 2 of a rod; 0 or 1 for an end sphere of a capsule.
    at: f32,
}

// Positions and velocities of the spheres of a side.
struct Poise {
    x1: vec3f,
    x2: vec3f,
    v1: vec3f,
    v2: vec3f,
}

fn half_of(id: u32, at: f32) -> Half {
    if id < step.spheres {
        if RODS {
            let rod = capsule_with(id);
            if rod != NONE {
                let ends = rod_ends(rod);
                return Half(CAPSULE, id, ends, select(0.0, 1.0, ends.y == id));
            }
        }
        return Half(SPHERE, id, vec2u(id), 0.0);
    }
    if RODS & (id - step.spheres < step.rods) {
        let rod = id - step.spheres;
        let is_free = !(rod_length(rod) > 0.0);
        return Half(select(CAPSULE, ROD, is_free | !is_capsule(rod)), id, rod_ends(rod), at);
    }
    return Half(STATIC, id, vec2u(0u), 0.0);
}

// The surface velocity of a rod's fixed end is not the rod's.
fn poise_of(half: Half) -> Poise {
    var poise = Poise(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    if half.kind == STATIC {
        return poise;
    }
    let v1 = state[velocity_at(half.spheres.x)];
    poise.x1 = state[position_at(half.spheres.x)].xyz;
    poise.v1 = v1.xyz;
    if !RODS | (half.kind == SPHERE) {
        return poise;
    }
    let v2 = state[velocity_at(half.spheres.y)];
    poise.x2 = state[position_at(half.spheres.y)].xyz;
    poise.v1 = select(vec3f(0.0), v1.xyz, v1.w > 0.0);
    poise.v2 = select(vec3f(0.0), v2.xyz, v2.w > 0.0);
    return poise;
}

// A rigid capsule as one body.
struct Capsule {
    // From end 1 to end 2.
    d: vec3f,
    // Of the centre of mass.
    velocity: vec3f,
    // Spin across the axis.
    spin: vec3f,
    inverse_mass: f32,
    // About the centre, across the axis.
    inverse_inertia: f32,
    // m2 / M: where on the axis, from end 1, the centre is.
    centre: f32,
}

fn capsule_of(ends: vec2u, poise: Poise) -> Capsule {
    let w1 = inverse_mass(ends.x);
    let w2 = inverse_mass(ends.y);
    let l1 = state[momentum_at(ends.x)];
    let l2 = state[momentum_at(ends.y)];
    let reduced_mass = 1.0 / (w1 + w2);
    let centre = w1 * reduced_mass;
    let d = poise.x2 - poise.x1;
    let squared = dot(d, d);
    let inverse_inertia = 1.0 / (reduced_mass * squared + 1.0 / l1.w + 1.0 / l2.w);
    var whole = reduced_mass * cross(d, poise.v2 - poise.v1) + l1.xyz + l2.xyz;
    if squared > TINY {
        whole = across(whole, d, squared);
    }
    let velocity = (1.0 - centre) * poise.v1 + centre * poise.v2;
    return Capsule(d, velocity, whole * inverse_inertia, w1 * w2 * reduced_mass, inverse_inertia, centre);
}

// Torque about the centre of a unit impulse at a parameter of the axis.
fn torque_at(capsule: Capsule, at: f32, n: vec3f) -> vec3f {
    return (at - capsule.centre) * cross(capsule.d, n);
}

// Velocity along n, and inverse mass that an impulse along n meets: that of one body alone where it is a network.
fn response(half: Half, poise: Poise, n: vec3f) -> vec2f {
    if half.kind == STATIC {
        return vec2f(0.0);
    }
    if !RODS | (half.kind == SPHERE) {
        return vec2f(dot(poise.v1, n), inverse_mass(half.spheres.x));
    }
    if half.kind == ROD {
        let s = 1.0 - half.at;
        let t = half.at;
        let velocity = dot(s * poise.v1 + t * poise.v2, n);
        return vec2f(velocity, s * s * inverse_mass(half.spheres.x) + t * t * inverse_mass(half.spheres.y));
    }
    let capsule = capsule_of(half.spheres, poise);
    let torque = torque_at(capsule, half.at, n);
    return vec2f(
        dot(capsule.velocity, n) + dot(torque, capsule.spin),
        capsule.inverse_mass + dot(torque, torque) * capsule.inverse_inertia,
    );
}

// A contact as it is now: how fast it closes along n, and the inverse mass that its impulse meets.
struct Closing {
    approach: f32,
    inverse_mass: f32,
}

fn closing_of(a: Half, b: Half, a_poise: Poise, b_poise: Poise, n: vec3f) -> Closing {
    let one = response(a, a_poise, n);
    let two = response(b, b_poise, n);
    return Closing(one.x - two.x, one.y + two.y);
}

// The contact of two objects, a before b, that touch like this.
fn closing_at(a: u32, b: u32, found: Touch) -> Closing {
    let one = half_of(a, found.a);
    let two = half_of(b, found.b);
    return closing_of(one, two, poise_of(one), poise_of(two), found.n);
}
