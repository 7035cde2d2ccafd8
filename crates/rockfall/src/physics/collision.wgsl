// requires model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl physics/round_pair.wgsl
// requires physics/scale.wgsl physics/walls.wgsl step/collisions/rows.wgsl

// The two sides of a contact in the collision phase: their kind, velocity along the normal and inverse mass
// (docs/physics sections 3.2 and 3.3).

// Kinds of sides: a box or polygon; a sphere; a rod of free length or of a network; a rigid capsule.
const STATIC: u32 = 0u;
const SPHERE: u32 = 1u;
const ROD: u32 = 2u;
const CAPSULE: u32 = 3u;

// One side of a contact.
struct ContactSide {
    kind: u32,
    id: u32,
    // Both are the sphere itself, or they are the ends of the rod.
    spheres: vec2u,
    // Parameter of the contact from end 1 to end 2 of a rod; 0 or 1 for an end sphere of a capsule.
    at: f32,
}

// An end of a side: a sphere, and its share of the impulse of the contact.
struct SideEnd {
    sphere: u32,
    share: f32,
}

// End 0 or 1 of a side. Only a rod that is not part of a capsule has two.
fn side_end(half: ContactSide, end: u32) -> SideEnd {
    if end == 1u {
        return SideEnd(half.spheres.y, half.at);
    }
    return SideEnd(half.spheres.x, select(1.0, 1.0 - half.at, half.kind == ROD));
}

// Positions and velocities of the spheres of a side. `v1` of a box or polygon is the velocity of the contact point on it.
struct SideMotion {
    x1: vec3f,
    x2: vec3f,
    v1: vec3f,
    v2: vec3f,
}

// The side of an object.
fn contact_side(id: u32, at: f32) -> ContactSide {
    if id < step.spheres {
        if RODS {
            let rod = capsule_with(id);
            if rod != NONE {
                let ends = rod_ends(rod);
                return ContactSide(CAPSULE, id, ends, select(0.0, 1.0, ends.y == id));
            }
        }
        return ContactSide(SPHERE, id, vec2u(id), 0.0);
    }
    if RODS & (id - step.spheres < step.rods) {
        let rod = id - step.spheres;
        let is_free = !(rod_length(rod) > 0.0);
        return ContactSide(select(CAPSULE, ROD, is_free | !is_capsule(rod)), id, rod_ends(rod), at);
    }
    return ContactSide(STATIC, id, vec2u(0u), 0.0);
}

// The motion of a side, with positions as seen from its first sphere.
fn side_motion(half: ContactSide) -> SideMotion {
    return side_motion_from(half, half.spheres.x);
}

// The sphere from which the positions of a pair are seen: the first one of A.
fn origin_of(a: ContactSide) -> u32 {
    return a.spheres.x;
}

// The motion of a side, with positions as seen from a sphere (`place_from`). The velocity of a fixed end of a rod counts as 0, because
// the motion of its surface does not move the rod.
fn side_motion_from(half: ContactSide, origin: u32) -> SideMotion {
    var poise = SideMotion(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    if half.kind == STATIC {
        return poise;
    }
    let v1 = state[velocity_at(half.spheres.x)];
    poise.x1 = place_from(origin, half.spheres.x);
    poise.v1 = v1.xyz;
    if !RODS | (half.kind == SPHERE) {
        return poise;
    }
    let v2 = state[velocity_at(half.spheres.y)];
    poise.x2 = place_from(origin, half.spheres.y);
    poise.v1 = select(vec3f(0.0), v1.xyz, v1.w > 0.0);
    poise.v2 = select(vec3f(0.0), v2.xyz, v2.w > 0.0);
    return poise;
}

// A rigid capsule as one body.
struct Capsule {
    // From end 1 to end 2.
    d: vec3f,
    // Velocity of the centre of mass.
    velocity: vec3f,
    // Angular velocity across the axis.
    spin: vec3f,
    inverse_mass: f32,
    // Inverse moment of inertia about the centre of mass, across the axis.
    inverse_inertia: f32,
    // m2 / M: the position of the centre of mass on the axis, 0 at end 1 and 1 at end 2.
    centre: f32,
}

// The part of a vector across the axis d of a capsule.
fn across_axis(v: vec3f, d: vec3f) -> vec3f {
    if dot(d, d) <= TINY {
        return v;
    }
    let scaled = scale_of(d) * d;
    return across(v, scaled, dot(scaled, scaled));
}

fn capsule_of(ends: vec2u, poise: SideMotion) -> Capsule {
    let w1 = inverse_mass(ends.x);
    let w2 = inverse_mass(ends.y);
    let l1 = state[momentum_at(ends.x)];
    let l2 = state[momentum_at(ends.y)];
    let reduced_mass = 1.0 / (w1 + w2);
    let centre = w1 * reduced_mass;
    let d = poise.x2 - poise.x1;
    let squared = dot(d, d);
    let inverse_inertia = 1.0 / (reduced_mass * squared + 1.0 / l1.w + 1.0 / l2.w);
    let whole = across_axis(reduced_mass * cross(d, poise.v2 - poise.v1) + l1.xyz + l2.xyz, d);
    let velocity = (1.0 - centre) * poise.v1 + centre * poise.v2;
    return Capsule(d, velocity, whole * inverse_inertia, w1 * w2 * reduced_mass, inverse_inertia, centre);
}

// Torque, about the centre of mass, of the impulse n at a parameter of the axis.
fn torque_at(capsule: Capsule, at: f32, n: vec3f) -> vec3f {
    return (at - capsule.centre) * cross(capsule.d, n);
}

// Velocity of a side along n, and its inverse mass for an impulse along n. On a network both are the values before the
// projection.
fn response(half: ContactSide, poise: SideMotion, n: vec3f) -> vec2f {
    if half.kind == STATIC {
        return vec2f(dot(poise.v1, n), 0.0);
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

// The approach velocity of a contact along n, and its inverse mass, summed over both sides.
struct ApproachSpeed {
    approach: f32,
    inverse_mass: f32,
}

fn approach_of(a: ContactSide, b: ContactSide, a_poise: SideMotion, b_poise: SideMotion, n: vec3f) -> ApproachSpeed {
    let one = response(a, a_poise, n);
    let two = response(b, b_poise, n);
    return ApproachSpeed(one.x - two.x, one.y + two.y);
}

// The approach velocity and the inverse mass of the contact `found` of two objects, in the present state.
fn approach_at(a: u32, b: u32, found: Touch) -> ApproachSpeed {
    let one = contact_side(a, found.a);
    let two = contact_side(b, found.b);
    var motion = side_motion(two);
    if WALLS {
        if two.kind == STATIC {
            motion.v1 = velocity_of_wall(wall_of(b), contact_point(a, found.a, found.overlap, found.n));
        }
    }
    return approach_of(one, two, side_motion(one), motion, found.n);
}
