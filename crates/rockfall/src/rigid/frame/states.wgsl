// requires rigid/frame/rows.wgsl rigid/frame/turn.wgsl physics/quaternion.wgsl

// States of bodies within a substep (docs/physics section 11.7), and what the times of contact of all pairs need.


struct State {
    place: vec3f,
    turn: vec4f,
    motion: Motion,
}

// Both bodies of a block at a time.
struct Sight {
    a: State,
    b: State,
    // x_b - x_a.
    apart: vec3f,
}

// Steps of the search for a touch.
const SEARCH_STEPS: u32 = 8u;

struct Hit {
    found: bool,
    time: f32,
    // delta.
    depth: f32,
    // All hit points may wait.
    waits: bool,
}

fn clock_of(body: u32) -> f32 {
    return bodies[BODY_ROWS * body].w;
}

fn momentum_of(body: u32) -> vec3f {
    return bodies[BODY_ROWS * body + 6u].xyz;
}

fn field_of(body: u32) -> vec3f {
    return select(vec3f(0.0), frame.gravity, has_mass(body));
}

fn state_at(body: u32, time: f32) -> State {
    var state = State(place_of(body), turn_of(body), motion_of(body));
    if time == 0.0 {
        return state;
    }
    let before = state.motion;
    if !has_mass(body) {
        state.place += time * before.velocity;
        let turn = time * before.spin;
        if any(turn != vec3f(0.0)) {
            state.turn = unit_turn(multiply(rotation_by(turn), state.turn));
        }
        return state;
    }
    let top = top_of(body);
    let momentum = momentum_of(body);
    state.place += time * before.velocity + (0.5 * time * time) * frame.gravity;
    state.turn = freely_turned(top, state.turn, momentum, time);
    state.motion.velocity += time * frame.gravity;
    state.motion.spin = respond(mass_in(top, state.turn, 0.0), momentum);
    return state;
}

fn sight_at(block: Block, time: f32) -> Sight {
    let a = state_at(block.a, time);
    let b = state_at(block.b, time);
    return Sight(a, b, (b.place - a.place) + image_of(block.a, block.b));
}

fn inner_normal(pair: u32) -> vec3f {
    return bitcast<vec3f>(pairs[PAIR_ROWS * pair + 2u].xyz);
}

// The places of a point on both bodies, from the centre of a.
fn on_a(sight: Sight, point: u32) -> vec3f {
    return turned_vector(sight.a.turn, bitcast<vec3f>(points[POINT_ROWS * point].xyz));
}

fn on_b(sight: Sight, point: u32) -> vec3f {
    return sight.apart + turned_vector(sight.b.turn, bitcast<vec3f>(points[POINT_ROWS * point + 1u].xyz));
}

// Radius of the smaller body with mass.
fn least_radius(block: Block) -> f32 {
    let a = bodies[BODY_ROWS * block.a + 6u].w;
    let b = bodies[BODY_ROWS * block.b + 6u].w;
    if !has_mass(block.a) {
        return b;
    }
    return select(a, min(a, b), has_mass(block.b));
}

// The speed at which a point of a block must close to be hit, besides that of the field. Negative if no point can close fast enough.
fn least_speed_of(block: Block, fall: f32) -> f32 {
    let least = select(0.1 * least_radius(block) / frame.h, 0.0, (block.info & ELASTIC) != 0u);
    let a = motion_of(block.a);
    let b = motion_of(block.b);
    var bound = 1.5 * (length(b.velocity - a.velocity) + turning_speed(block.a, a.spin) + turning_speed(block.b, b.spin));
    if (block.info & FIXED) != 0u {
        bound += fall;
    }
    return select(-1.0, least, bound > max(least, fall));
}

// Approach speed at a point at an arm from the centre of a.
fn approach_at(sight: Sight, arm: vec3f, normal: vec3f) -> f32 {
    let speed = sight.b.motion.velocity + cross(sight.b.motion.spin, arm - sight.apart)
        - sight.a.motion.velocity - cross(sight.a.motion.spin, arm);
    return -dot(speed, normal);
}

// Whether a point with a gap and an approach speed comes before another one. Points that leave come last, the nearest one first.
fn comes_before(gap: f32, speed: f32, other_gap: f32, other_speed: f32) -> bool {
    if speed > 0.0 {
        return other_speed <= 0.0 || gap / speed < other_gap / other_speed;
    }
    return other_speed <= 0.0 && gap < other_gap;
}

// A round pair touches at a gap of this share of the radius.
const TOUCH: f32 = 1e-4;
// A hit that is late by at most this share of the rest of a substep happens at its end.
const LATE: f32 = 0.01;
// The latest impact, in parts of a substep: rows divide by what is left.
const LAST: f32 = 0.999999;

// By how much a hit may be late. The rows of this substep would stop a body that is at the surface at its end up to rounding.
fn late_of(speed: f32, rest: f32, radius: f32) -> f32 {
    return min(LATE * rest, TOUCH * radius / speed);
}

// The first time at which a gap closes; negative if there is none within the rest. A hit that is late by a little is at its end.
fn root_of(gap: f32, u: f32, pull: f32, rest: f32, fall: f32, late: f32) -> f32 {
    let square = u * u + 2.0 * pull * gap;
    if square < 0.0 {
        return -1.0;
    }
    let time = 2.0 * gap / (u + sqrt(square));
    return select(-1.0, min(time, rest), time >= 0.0 && time <= rest + late && u + pull * time > fall);
}
