// requires model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/collision/crossings.wgsl
// requires physics/collision/pushed.wgsl physics/contact.wgsl physics/forces/free.wgsl physics/round_pair.wgsl
// requires physics/pairs.wgsl physics/touch.wgsl physics/sine.wgsl physics/walls.wgsl

// Solves lone collisions at their time of contact (docs/physics section 3.6). The pair is moved back to the time at
// which it first touched.

// Number of iterations for the time of contact.
const CONTACT_ROUNDS: u32 = 4u;

// A collision with its impulse. `a` and `b` are the parameters of the contact on A and B.
struct Solved {
    n: vec3f,
    a: f32,
    b: f32,
    impulse: f32,
    // Time since the overlap began, in s.
    tau: f32,
}

// Accelerations of the spheres of a side. For a capsule, both are that of its centre of mass.
struct SideAcceleration {
    a1: vec3f,
    a2: vec3f,
}

fn pull_on(half: ContactSide) -> SideAcceleration {
    var pull = SideAcceleration(vec3f(0.0), vec3f(0.0));
    if half.kind == STATIC {
        return pull;
    }
    let w1 = inverse_mass(half.spheres.x);
    if w1 > 0.0 {
        pull.a1 = free_acceleration(half.spheres.x);
    }
    if !RODS | (half.kind == SPHERE) {
        return pull;
    }
    let w2 = inverse_mass(half.spheres.y);
    if w2 > 0.0 {
        pull.a2 = free_acceleration(half.spheres.y);
    }
    if half.kind == CAPSULE {
        let centre = w1 / (w1 + w2);
        let mean = (1.0 - centre) * pull.a1 + centre * pull.a2;
        return SideAcceleration(mean, mean);
    }
    return pull;
}

// The vector d from end 1 to end 2 of a capsule, and the velocity q of end 2 relative to end 1.
struct Turned {
    d: vec3f,
    q: vec3f,
}

// Moves d and q along a circle for a time (docs/physics section 3.6, equation 3).
fn turned(d: vec3f, q: vec3f, time: f32) -> Turned {
    let dd = dot(d, d);
    let qq = dot(q, q);
    if (dd <= TINY) | (qq <= TINY) {
        return Turned(d, q);
    }
    let rate = sqrt(qq / dd);
    let turn = sine_cosine(time * rate);
    return Turned(turn.y * d + (turn.x / rate) * q, turn.y * q - (turn.x * rate) * d);
}

// The state of a side at an earlier time. `with_acceleration` decides whether the positions include the term of the
// acceleration. The velocities always do. Fixed spheres are not moved.
fn moved_back(half: ContactSide, poise: SideMotion, pull: SideAcceleration, tau: f32, with_acceleration: bool) -> SideMotion {
    var back = poise;
    if half.kind == STATIC {
        return back;
    }
    let square = select(0.0, 0.5 * tau * tau, with_acceleration);
    let w1 = inverse_mass(half.spheres.x);
    if RODS & (half.kind == CAPSULE) {
        let centre = w1 / (w1 + inverse_mass(half.spheres.y));
        let place = (1.0 - centre) * poise.x1 + centre * poise.x2;
        let velocity = (1.0 - centre) * poise.v1 + centre * poise.v2;
        let before = turned(poise.x2 - poise.x1, poise.v2 - poise.v1, -tau);
        let moved = place - tau * velocity + square * pull.a1;
        let slowed = velocity - tau * pull.a1;
        return SideMotion(
            moved - centre * before.d,
            moved + (1.0 - centre) * before.d,
            slowed - centre * before.q,
            slowed + (1.0 - centre) * before.q,
        );
    }
    if w1 > 0.0 {
        back.x1 = poise.x1 - tau * poise.v1 + square * pull.a1;
        back.v1 = poise.v1 - tau * pull.a1;
    }
    if RODS & (half.kind == ROD) {
        if inverse_mass(half.spheres.y) > 0.0 {
            back.x2 = poise.x2 - tau * poise.v2 + square * pull.a2;
            back.v2 = poise.v2 - tau * pull.a2;
        }
    }
    return back;
}

// Whether a pair at an earlier time has a contact line and approaches. Extreme forces can make the values infinite or NaN.
fn closes(at: Placed) -> bool {
    let is_known = finite(vec3f(at.touch.overlap, at.closing.approach, at.closing.inverse_mass));
    return is_known & (at.touch.overlap != NO_CONTACT_LINE) & (at.closing.approach > 0.0);
}

// Solves the lone collision of two objects, a before b in insertion order. `found` is their contact in the present state. Where
// contacts within a step are handled, the iteration begins with the time of the first contact on straight paths, if it is within
// the step (docs/physics section 3.10).
fn solve_lone(a_id: u32, b_id: u32, feature: u32, found: Touch) -> Solved {
    var start = 0.0;
    if CONTINUOUS {
        if a_id < step.spheres {
            let radius = state[position_at(a_id)].w;
            var smaller = radius;
            if b_id < step.spheres {
                smaller = min(radius, state[position_at(b_id)].w);
            }
            start = max(0.0, time_of_beginning(a_id, b_id, collision_velocity(smaller, a_id, b_id)));
        }
    }
    return solve_from(a_id, b_id, feature, found, start, false);
}

// Does what `solve_lone` does, with an iteration that begins with the time `start`. The impulse of a crossing is 0 if its objects
// do not approach each other at the time of contact (docs/physics section 3.10).
fn solve_from(a_id: u32, b_id: u32, feature: u32, found: Touch, start: f32, is_crossing: bool) -> Solved {
    var a = contact_side(a_id, found.a);
    var b = contact_side(b_id, found.b);
    let a_now = side_motion_from(a, origin_of(a));
    let b_now = side_motion_from(b, origin_of(a));
    let a_pull = pull_on(a);
    let b_pull = pull_on(b);
    let by_vertex = meets_by_vertex(a, b, a_now, feature);
    let face = OnFace(!is_crossing && is_over_face(a, b, a_now), centre_of(a, a_now).xyz, found);
    var tau = start;
    var at_contact: Placed;
    // The last round evaluates the contact at the time found. It is part of the loop so that compilers make one copy of `placed`.
    for (var round = 0u; round <= CONTACT_ROUNDS; round++) {
        let is_last = round == CONTACT_ROUNDS;
        at_contact = placed(&a, &b, a_now, b_now, a_pull, b_pull, tau, !is_last, feature, by_vertex, face);
        if is_last {
            break;
        }
        if !closes(at_contact) {
            round = CONTACT_ROUNDS - 1u;
            continue;
        }
        tau = clamp(tau + at_contact.touch.overlap / at_contact.closing.approach, 0.0, step.dt);
    }
    if !closes(at_contact) {
        if is_crossing {
            return Solved(found.n, 0.0, 0.0, 0.0, 0.0);
        }
        tau = 0.0;
        at_contact = Placed(found, approach_at(a_id, b_id, found));
    }
    let none = array<vec3f, 4>(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    var pushed = Pushed(vec4u(NONE), none);
    push_side(a, moved_back(a, a_now, a_pull, tau, false), -at_contact.touch.n, 0u, &pushed);
    push_side(b, moved_back(b, b_now, b_pull, tau, false), at_contact.touch.n, 2u, &pushed);
    let inverse_mass = at_contact.closing.inverse_mass;
    let stretching = tau * tau * curvature_along(pushed);
    var effective_inverse_mass = max(inverse_mass + stretching, 0.5 * inverse_mass);
    if !finite(vec3f(stretching)) {
        // With extremely stiff springs the term is infinite or NaN.
        effective_inverse_mass = select(0.5 * inverse_mass, 3e38, bitcast<u32>(stretching) == 0x7f800000u);
    }
    let impulse = (1.0 + restitution_of(a_id, b_id)) * at_contact.closing.approach / effective_inverse_mass;
    return Solved(at_contact.touch.n, at_contact.touch.a, at_contact.touch.b, impulse, tau);
}

// A pair at an earlier time.
struct Placed {
    touch: Touch,
    closing: ApproachSpeed,
}

// The present contact of a sphere at `centre`, if it keeps the plane of the face that it touches when it is moved back in time.
struct OnFace {
    is_kept: bool,
    centre: vec3f,
    present: Touch,
}

// A point of the coordinates in which a pair is compared, in those of the scene.
fn in_scene(a: ContactSide, place: vec3f) -> vec3f {
    if DOUBLE {
        return place + state[position_at(origin_of(a))].xyz;
    }
    return place;
}

// How far a wall has taken a point of it, which was at `place` at the time `tau` earlier (docs/physics section 2.12).
fn taken_along(wall: Wall, place: vec3f, tau: f32, with_acceleration: bool) -> vec3f {
    let around = cross(wall.spin, lever_on_wall(wall, place) + tau * wall.velocity);
    let slowed = select(vec3f(0.0), wall.acceleration, with_acceleration);
    return tau * (wall.velocity + around) + 0.5 * tau * tau * (cross(wall.spin, around) - slowed);
}

// An earlier state of A in coordinates in which the wall is where it is now.
fn seen_from_wall(a: ContactSide, back: SideMotion, wall: Wall, tau: f32, with_acceleration: bool) -> SideMotion {
    var seen = back;
    seen.x1 += taken_along(wall, in_scene(a, back.x1), tau, with_acceleration);
    seen.x2 += taken_along(wall, in_scene(a, back.x2), tau, with_acceleration);
    return seen;
}

// The velocity that the wall had at the contact point, at the time `tau` earlier.
fn wall_velocity_before(a: ContactSide, seen: SideMotion, wall: Wall, tau: f32, found: Touch) -> vec3f {
    var place = centre_of(a, seen);
    if RODS & (a.id >= step.spheres) {
        place = vec4f(mix(seen.x1, seen.x2, found.a), rod_radius(a.id - step.spheres));
    }
    let point = in_scene(a, place.xyz) + (place.w - found.overlap) * found.n;
    return velocity_of_wall(wall, point) - tau * acceleration_of_wall(wall, point);
}

// A unit vector as it was at the time `tau` earlier on a wall that turns.
fn turned_back(n: vec3f, spin: vec3f, tau: f32) -> vec3f {
    let around = cross(-tau * spin, n);
    return normalize(n + around + 0.5 * cross(-tau * spin, around));
}

// Evaluates the contact of a pair at the time `tau` earlier. Also sets the parameters of rods in `a` and `b`.
fn placed(
    a: ptr<function, ContactSide>,
    b: ptr<function, ContactSide>,
    a_now: SideMotion,
    b_now: SideMotion,
    a_pull: SideAcceleration,
    b_pull: SideAcceleration,
    tau: f32,
    with_acceleration: bool,
    feature: u32,
    by_vertex: bool,
    face: OnFace,
) -> Placed {
    let a_back = moved_back(*a, a_now, a_pull, tau, with_acceleration);
    var b_back = moved_back(*b, b_now, b_pull, tau, with_acceleration);
    var found = face.present;
    var a_seen = a_back;
    var wall: Wall;
    if WALLS {
        if (*b).kind == STATIC {
            wall = wall_of((*b).id);
            a_seen = seen_from_wall(*a, a_back, wall, tau, with_acceleration);
        }
    }
    if face.is_kept {
        found.overlap += dot(centre_of(*a, a_seen).xyz - face.centre, found.n);
    } else {
        found = signed_touch(*a, *b, a_seen, b_back, feature, by_vertex);
    }
    if WALLS {
        if (*b).kind == STATIC {
            b_back.v1 = wall_velocity_before(*a, a_seen, wall, tau, found);
            found.n = turned_back(found.n, wall.spin, tau);
        }
    }
    if RODS {
        if (*a).id >= step.spheres {
            (*a).at = found.a;
        }
        if ((*b).id >= step.spheres) & ((*b).kind != STATIC) {
            (*b).at = found.b;
        }
    }
    return Placed(found, approach_of(*a, *b, a_back, b_back, found.n));
}
