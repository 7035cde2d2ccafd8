// requires rigid/frame/rows.wgsl rigid/frame/arc.wgsl physics/quaternion.wgsl

// A joint in the present pose, and how its impulses act (docs/physics section 11.14). `rigid/gpu/joints.rs` makes the arrays.
//
// | array | rows of a joint |
// |---|---|
// | `joints` | place at A, cone; turn of A; place at B, target; turn of B; a, b, flags, frequency of the rows times the substep; limits, their middle, stiffness; damping, limit of the spring, speed, limit of the motor; friction, strengths, 0; effort, drag, armature, 0 |
// | `joint_states` | impulses: four rows in the order of `JointImpulses::to_array`; force, 1 if it is broken; torque, 0; 0. Within a frame, force and torque are sums of impulses, the 0 behind the torque is how far the spring is off, and the last row is the rate of the rotor, for a joint that is no ball in the first number |
// | `joint_order` | no rows: the numbers of the joints, colour by colour |

@group(0) @binding(42) var<storage, read> joints: array<vec4u>;
@group(0) @binding(43) var<storage, read_write> joint_states: array<vec4f>;
@group(0) @binding(44) var<storage, read> joint_order: array<u32>;

const JOINT_ROWS: u32 = 9u;
const JOINT_STATE_ROWS: u32 = 7u;
// Flags. The first bits are those of the linear rows, the next ones those of the angular rows.
const ANGULAR: u32 = 3u;
const TURNS: u32 = 0x40u;
const SLIDES: u32 = 0x80u;
const LINE: u32 = 0x100u;
const LOWER: u32 = 0x200u;
const UPPER: u32 = 0x400u;
const CONE: u32 = 0x800u;
const LOCKED: u32 = 0x1000u;
const SPRUNG: u32 = 0x2000u;
// Something acts on the free axis.
const DRIVEN: u32 = 0x4000u;
const FULL_TURN: f32 = 6.2831855;

struct Joint {
    number: u32,
    a: u32,
    b: u32,
    flags: u32,
    // From both centres to the anchor of B.
    arm_a: vec3f,
    arm_b: vec3f,
    // D.
    apart: vec3f,
    // e_1, e_2, e_3.
    axes: mat3x3f,
    // f_1.
    other: vec3f,
    // V, s.
    twist: vec4f,
}

// Both bodies while a joint is solved.
struct Ends {
    a: Motion,
    b: Motion,
    mass_a: Mass,
    mass_b: Mass,
}

// A direction of a row: an impulse of 1 pushes along it, or has no push; its moments, and the changes of the spins. 1 / K.
struct Lever {
    along: vec3f,
    turn_a: vec3f,
    turn_b: vec3f,
    response_a: vec3f,
    response_b: vec3f,
    inverse: f32,
}

// The free axis.
struct FreeAxis {
    direction: vec3f,
    position: f32,
    lever: Lever,
}

// Impulses of a joint, and those on B that they add up to.
struct Impulses {
    linear: vec3f,
    angular: vec3f,
    locked: f32,
    motor: f32,
    friction: f32,
    lower: f32,
    upper: f32,
    cone: f32,
    resistance: vec3f,
    drive: f32,
}

struct Push {
    impulse: vec3f,
    moment: vec3f,
}

fn joint_row(number: u32, k: u32) -> vec4f {
    return bitcast<vec4f>(joints[JOINT_ROWS * number + k]);
}

fn is_broken(number: u32) -> bool {
    return joint_states[JOINT_STATE_ROWS * number + 4u].w != 0.0;
}

fn impulses_of(number: u32) -> Impulses {
    let at = JOINT_STATE_ROWS * number;
    let one = joint_states[at];
    let two = joint_states[at + 1u];
    let three = joint_states[at + 2u];
    let four = joint_states[at + 3u];
    return Impulses(one.xyz, two.xyz, one.w, two.w, three.x, three.y, three.z, three.w, four.xyz, four.w);
}

fn put_impulses(number: u32, own: Impulses) {
    let at = JOINT_STATE_ROWS * number;
    joint_states[at] = vec4f(own.linear, own.locked);
    joint_states[at + 1u] = vec4f(own.angular, own.motor);
    joint_states[at + 2u] = vec4f(own.friction, own.lower, own.upper, own.cone);
    joint_states[at + 3u] = vec4f(own.resistance, own.drive);
}

fn add_load(number: u32, push: Push) {
    let at = JOINT_STATE_ROWS * number + 4u;
    joint_states[at] += vec4f(push.impulse, 0.0);
    joint_states[at + 1u] += vec4f(push.moment, 0.0);
}

fn joint_at(number: u32) -> Joint {
    let sides = joints[JOINT_ROWS * number + 4u];
    let turn_a = turn_of(sides.x);
    let turn_b = turn_of(sides.y);
    let arm_b = turned_vector(turn_b, joint_row(number, 2u).xyz);
    let anchor_a = turned_vector(turn_a, joint_row(number, 0u).xyz);
    let way = place_of(sides.y) - place_of(sides.x);
    let from_a = way + to_nearest((way - anchor_a) + arm_b);
    let apart = (from_a - anchor_a) + arm_b;
    let one = multiply(turn_a, joint_row(number, 1u));
    let two = multiply(turn_b, joint_row(number, 3u));
    let axes = mat3x3f(
        turned_vector(one, vec3f(1.0, 0.0, 0.0)), turned_vector(one, vec3f(0.0, 1.0, 0.0)), turned_vector(one, vec3f(0.0, 0.0, 1.0))
    );
    let twist = multiply(vec4f(-one.xyz, one.w), two);
    let other = turned_vector(two, vec3f(1.0, 0.0, 0.0));
    let shorter = select(twist, -twist, twist.w < 0.0);
    return Joint(number, sides.x, sides.y, sides.z, from_a + arm_b, arm_b, apart, axes, other, shorter);
}

fn ends_of(joint: Joint) -> Ends {
    return Ends(motion_of(joint.a), motion_of(joint.b), mass_of(joint.a), mass_of(joint.b));
}

fn put_ends(joint: Joint, ends: ptr<function, Ends>) {
    if has_mass(joint.a) {
        put_motion(joint.a, (*ends).a);
    }
    if has_mass(joint.b) {
        put_motion(joint.b, (*ends).b);
    }
}

fn lever_of(joint: Joint, ends: ptr<function, Ends>, direction: vec3f, is_linear: bool) -> Lever {
    let turn_a = select(direction, cross(joint.arm_a, direction), is_linear);
    let turn_b = select(direction, cross(joint.arm_b, direction), is_linear);
    let response_a = respond((*ends).mass_a, turn_a);
    let response_b = respond((*ends).mass_b, turn_b);
    let straight = select(0.0, (*ends).mass_a.inverse + (*ends).mass_b.inverse, is_linear);
    let k = straight + (dot(turn_a, response_a) + dot(turn_b, response_b));
    return Lever(select(vec3f(0.0), direction, is_linear), turn_a, turn_b, response_a, response_b, 1.0 / k);
}

// The rate of the position of a row.
fn rate_of(ends: ptr<function, Ends>, lever: Lever) -> f32 {
    let straight = dot(lever.along, (*ends).b.velocity - (*ends).a.velocity);
    return straight + (dot(lever.turn_b, (*ends).b.spin) - dot(lever.turn_a, (*ends).a.spin));
}

fn pull_ends(ends: ptr<function, Ends>, lever: Lever, impulse: f32) {
    (*ends).a.velocity -= ((*ends).mass_a.inverse * impulse) * lever.along;
    (*ends).a.spin -= impulse * lever.response_a;
    (*ends).b.velocity += ((*ends).mass_b.inverse * impulse) * lever.along;
    (*ends).b.spin += impulse * lever.response_b;
}

fn push_ends(joint: Joint, ends: ptr<function, Ends>, push: Push) {
    (*ends).a.velocity -= (*ends).mass_a.inverse * push.impulse;
    (*ends).a.spin -= respond((*ends).mass_a, cross(joint.arm_a, push.impulse) + push.moment);
    (*ends).b.velocity += (*ends).mass_b.inverse * push.impulse;
    (*ends).b.spin += respond((*ends).mass_b, cross(joint.arm_b, push.impulse) + push.moment);
}

// An angle, or a difference of two, the shorter way around.
fn reduced(angle: f32, middle: f32) -> f32 {
    return angle - FULL_TURN * round((angle - middle) / FULL_TURN);
}

// The direction of the free axis.
fn free_direction(joint: Joint) -> vec3f {
    let axis = joint.axes[0];
    if (joint.flags & TURNS) != 0u {
        let cosine = dot(axis, joint.other);
        if cosine < -0.9 {
            return axis;
        }
        return (axis + joint.other) / (1.0 + cosine);
    }
    let distance = length(joint.apart);
    if (joint.flags & SLIDES) != 0u || distance == 0.0 {
        return axis;
    }
    return joint.apart / distance;
}

fn free_position(joint: Joint) -> f32 {
    if (joint.flags & TURNS) != 0u {
        return reduced(2.0 * arc_of(joint.twist.x, joint.twist.w), joint_row(joint.number, 5u).z);
    }
    if (joint.flags & SLIDES) != 0u {
        return dot(joint.axes[0], joint.apart);
    }
    return length(joint.apart);
}

fn free_axis(joint: Joint, ends: ptr<function, Ends>) -> FreeAxis {
    let direction = free_direction(joint);
    return FreeAxis(direction, free_position(joint), lever_of(joint, ends, direction, (joint.flags & TURNS) == 0u));
}

// How far the position is beyond the target.
fn beyond_target(joint: Joint, position: f32) -> f32 {
    let beyond = position - joint_row(joint.number, 2u).w;
    return select(beyond, reduced(beyond, 0.0), (joint.flags & TURNS) != 0u);
}

// About what the cone turns B back; 0 without a direction.
fn cone_direction(joint: Joint) -> vec3f {
    let across = cross(joint.other, joint.axes[0]);
    let size = length(across);
    if size == 0.0 {
        return across;
    }
    return across / size;
}

fn push_along(joint: Joint, direction: vec3f, size: f32) -> Push {
    let along = size * direction;
    let turns = (joint.flags & TURNS) != 0u;
    return Push(select(along, vec3f(0.0), turns), select(vec3f(0.0), along, turns));
}

// What all impulses that are kept exert on B.
fn push_of(joint: Joint, own: Impulses) -> Push {
    var push = Push(joint.axes * own.linear, joint.axes * (own.angular + own.resistance));
    if (joint.flags & DRIVEN) != 0u {
        let size = own.locked + own.motor + own.friction + own.lower - own.upper + own.drive;
        let more = push_along(joint, free_direction(joint), size);
        push.impulse += more.impulse;
        push.moment += more.moment;
    }
    if (joint.flags & CONE) != 0u {
        push.moment += own.cone * cone_direction(joint);
    }
    return push;
}
