// requires rigid/frame/rows.wgsl rigid/frame/joint.wgsl rigid/frame/halt.wgsl rigid/frame/report.wgsl

// The rows of joints (docs/physics section 11.14). A thread has a joint, and for this dispatch both of its bodies. In these stages the
// two words of `call` are the first entry of a colour in `joint_order` and the end.

// m_s, r and i_s of the rows of a joint.
struct JointSoftness {
    gain: f32,
    pull: f32,
    loss: f32,
}

// Those of the joint of this thread, and whether this is the first of its two visits in the pass.
var<private> soft: JointSoftness;
var<private> is_first_visit: bool;

// Of a frequency times the substep, with the damping ratio 2.
fn joint_softness(frequency: f32) -> JointSoftness {
    let turn = FULL_TURN * frequency;
    let first = 4.0 + turn;
    let loss = 1.0 / (1.0 + turn * first);
    let gain = turn * first * loss;
    return JointSoftness(gain, gain * turn / (first * frame.h), loss);
}

// A symmetric matrix: xx yy zz; xy xz yz.
struct Tensor {
    diagonal: vec3f,
    beside: vec3f,
}

fn axes_in(bits: u32) -> vec3<bool> {
    return (vec3u(bits) & vec3u(1u, 2u, 4u)) != vec3u(0u);
}

// K^-1 b for the rows that there are, by K = L D L^T.
fn solved(k: Tensor, rows: vec3<bool>, right: vec3f) -> vec3f {
    let d = select(vec3f(1.0), k.diagonal, rows);
    let e = select(vec3f(0.0), k.beside, rows.xxy & rows.yzz);
    let b = select(vec3f(0.0), right, rows);
    let low_y = e.x / d.x;
    let low_z = e.y / d.x;
    let d_y = d.y - low_y * e.x;
    let e_z = e.z - low_y * e.y;
    let last = e_z / d_y;
    let d_z = (d.z - low_z * e.y) - last * e_z;
    let y = b.y - low_y * b.x;
    let z = ((b.z - low_z * b.x) - last * y) / d_z;
    let middle = y / d_y - last * z;
    return vec3f(b.x / d.x - low_y * middle - low_z * z, middle, z);
}

// The change of the impulses of a block.
fn block_change(k: Tensor, rows: vec3<bool>, rate: vec3f, off: vec3f, old: vec3f, biased: bool) -> vec3f {
    if biased {
        return solved(k, rows, -(soft.gain * rate + soft.pull * off)) - soft.loss * old;
    }
    return solved(k, rows, -rate);
}

fn linear_block(joint: Joint, ends: ptr<function, Ends>, old: vec3f, biased: bool) -> vec3f {
    let one = lever_of(joint, ends, joint.axes[0], true);
    let two = lever_of(joint, ends, joint.axes[1], true);
    let three = lever_of(joint, ends, joint.axes[2], true);
    let mass = (*ends).mass_a.inverse + (*ends).mass_b.inverse;
    let k = Tensor(
        vec3f(mass) + vec3f(shared_of(one, one), shared_of(two, two), shared_of(three, three)),
        vec3f(shared_of(one, two), shared_of(one, three), shared_of(two, three)),
    );
    let rate = vec3f(rate_of(ends, one), rate_of(ends, two), rate_of(ends, three));
    let change = block_change(k, axes_in(joint.flags), rate, joint.apart * joint.axes, old, biased);
    push_ends(joint, ends, Push(joint.axes * change, vec3f(0.0)));
    return old + change;
}

// What two levers have in common in K, without the masses.
fn shared_of(one: Lever, two: Lever) -> f32 {
    return dot(one.turn_a, two.response_a) + dot(one.turn_b, two.response_b);
}

fn angular_block(joint: Joint, ends: ptr<function, Ends>, old: vec3f, biased: bool) -> vec3f {
    let rows = axes_in(joint.flags >> ANGULAR);
    let both = Mass(
        0.0, (*ends).mass_a.diagonal + (*ends).mass_b.diagonal, (*ends).mass_a.beside + (*ends).mass_b.beside
    );
    let one = respond(both, joint.axes[0]);
    let two = respond(both, joint.axes[1]);
    let three = respond(both, joint.axes[2]);
    let k = Tensor(
        vec3f(dot(joint.axes[0], one), dot(joint.axes[1], two), dot(joint.axes[2], three)),
        vec3f(dot(joint.axes[0], two), dot(joint.axes[0], three), dot(joint.axes[1], three)),
    );
    let rate = ((*ends).b.spin - (*ends).a.spin) * joint.axes;
    let off = select(cross(joint.axes[0], joint.other) * joint.axes, 2.0 * joint.twist.xyz, all(rows));
    let change = block_change(k, rows, rate, off, old, biased);
    push_ends(joint, ends, Push(vec3f(0.0), joint.axes * change));
    return old + change;
}

fn locked_row(ends: ptr<function, Ends>, lever: Lever, off: f32, old: f32, biased: bool) -> f32 {
    let rate = rate_of(ends, lever);
    var next = old - rate * lever.inverse;
    if biased {
        next = (1.0 - soft.loss) * old - (soft.gain * rate + soft.pull * off) * lever.inverse;
    }
    pull_ends(ends, lever, next - old);
    return next;
}

// A row that holds a speed with at most this impulse.
fn motor_row(ends: ptr<function, Ends>, lever: Lever, speed: f32, most: f32, old: f32) -> f32 {
    let next = clamp(old - (rate_of(ends, lever) - speed) * lever.inverse, -most, most);
    pull_ends(ends, lever, next - old);
    return next;
}

// The motor in reach of a limit: in a substep it goes no farther than to its limit, and there it does not push on.
fn held_motor(ends: ptr<function, Ends>, axis: FreeAxis, flags: u32, limits: vec2f, drive: vec2f, old: f32) -> f32 {
    let reach = (limits - vec2f(axis.position)) / frame.h;
    var speed = drive.x;
    var most = drive.y;
    if (flags & LOWER) != 0u && drive.x < 0.0 {
        speed = max(drive.x, min(reach.x, 0.0));
        most = select(most, 0.0, reach.x >= 0.0);
    }
    if (flags & UPPER) != 0u && drive.x > 0.0 {
        speed = min(drive.x, max(reach.y, 0.0));
        most = select(most, 0.0, reach.y <= 0.0);
    }
    return motor_row(ends, axis.lever, speed, most, old);
}

// A row that keeps a gap open, which grows along the lever or, with the side -1, against it.
fn limit_row(ends: ptr<function, Ends>, lever: Lever, side: f32, gap: f32, old: f32, biased: bool) -> f32 {
    let rate = side * rate_of(ends, lever);
    var next = old;
    if biased && gap > 0.0 {
        next = old - (rate + gap / frame.h) * lever.inverse;
    } else if biased {
        next = (1.0 - soft.loss) * old - (soft.gain * rate + soft.pull * gap) * lever.inverse;
    } else if gap <= 0.0 || old > 0.0 {
        next = old - rate * lever.inverse;
    }
    next = max(next, 0.0);
    pull_ends(ends, lever, side * (next - old));
    return next;
}

// Whether friction and damping resist all rotations.
fn is_ball(flags: u32) -> bool {
    return (flags & TURNS) != 0u && ((flags >> ANGULAR) & 7u) == 0u;
}

// Friction and damping of a ball. The impulses of friction.
fn resist(joint: Joint, ends: ptr<function, Ends>, old: vec3f, biased: bool) -> vec3f {
    let friction = frame.h * joint_row(joint.number, 7u).x;
    let damping = frame.h * joint_row(joint.number, 6u).x;
    var k = Tensor((*ends).mass_a.diagonal + (*ends).mass_b.diagonal, (*ends).mass_a.beside + (*ends).mass_b.beside);
    let rate = (*ends).b.spin - (*ends).a.spin;
    if biased && is_first_visit && damping > 0.0 {
        k.diagonal += vec3f(1.0 / damping);
        let moment = solved(k, vec3<bool>(true), -rate);
        push_ends(joint, ends, Push(vec3f(0.0), moment));
        add_load(joint.number, Push(vec3f(0.0), moment));
    }
    if biased || friction == 0.0 {
        return old;
    }
    let before = joint.axes * old;
    var kept = before + solved(k, vec3<bool>(true), -rate);
    let size = length(kept);
    if size > friction {
        kept *= friction / size;
    }
    push_ends(joint, ends, Push(vec3f(0.0), kept - before));
    return kept * joint.axes;
}

// The velocity of B at the anchor and its spin, relative to A, that a push gives.
fn response_to(joint: Joint, ends: ptr<function, Ends>, push: Push) -> Push {
    let a = respond((*ends).mass_a, cross(joint.arm_a, push.impulse) + push.moment);
    let b = respond((*ends).mass_b, cross(joint.arm_b, push.impulse) + push.moment);
    let linear = (*ends).mass_a.inverse + (*ends).mass_b.inverse;
    return Push(linear * push.impulse + cross(a, joint.arm_a) + cross(b, joint.arm_b), a + b);
}

// A spring of 1 along the free axis, with what the rows of the joint answer at once.
fn spring_push(joint: Joint, ends: ptr<function, Ends>, axis: vec3f) -> Push {
    let zero = vec3f(0.0);
    let all_rows = vec3<bool>(true);
    let alone = push_along(joint, axis, 1.0);
    let answer = response_to(joint, ends, alone);
    if (joint.flags & TURNS) != 0u && (joint.flags & 7u) == 7u {
        let x = response_to(joint, ends, Push(vec3f(1.0, 0.0, 0.0), zero)).impulse;
        let y = response_to(joint, ends, Push(vec3f(0.0, 1.0, 0.0), zero)).impulse;
        let z = response_to(joint, ends, Push(vec3f(0.0, 0.0, 1.0), zero)).impulse;
        let k = Tensor(vec3f(x.x, y.y, z.z), vec3f(y.x, z.x, z.y));
        return Push(solved(k, all_rows, -answer.impulse), axis);
    }
    if (joint.flags & SLIDES) != 0u && ((joint.flags >> ANGULAR) & 7u) == 7u {
        let k = Tensor((*ends).mass_a.diagonal + (*ends).mass_b.diagonal, (*ends).mass_a.beside + (*ends).mass_b.beside);
        return Push(axis, solved(k, all_rows, -answer.moment));
    }
    return alone;
}

// What the spring adds in a visit. Between both visits of the biased pass, the impulse of a damper is in the last row of the joint.
fn spring_row(joint: Joint, ends: ptr<function, Ends>, axis: FreeAxis) -> Push {
    let h = frame.h;
    let stiffness = joint_row(joint.number, 5u).w;
    let drive = joint_row(joint.number, 6u);
    let push = spring_push(joint, ends, axis.direction);
    let answer = response_to(joint, ends, push);
    let k = dot(push.impulse, answer.impulse) + dot(push.moment, answer.moment);
    // theta h^2 k = h^2 k - 1 / K, or 0.
    let damping = select(h * drive.x, 0.0, is_ball(joint.flags)) + max(h * h * stiffness - 1.0 / k, 0.0);
    let speed = point_speed((*ends).b, joint.arm_b) - point_speed((*ends).a, joint.arm_a);
    let rate = dot(push.impulse, speed) + dot(push.moment, (*ends).b.spin - (*ends).a.spin);
    let kept = JOINT_STATE_ROWS * joint.number + 4u;
    let old = select(joint_states[kept].w, 0.0, is_first_visit);
    let wanted = h * stiffness * beyond_target(joint, axis.position) + damping * rate + old;
    let most = h * drive.y;
    let next = clamp(old - wanted / (1.0 + damping * k), -most, most);
    joint_states[kept].w = select(0.0, next, is_first_visit);
    let size = next - old;
    let all = Push(size * push.impulse, size * push.moment);
    push_ends(joint, ends, all);
    return all;
}

// Velocity of a point at an arm from the centre of a body.
fn point_speed(motion: Motion, arm: vec3f) -> vec3f {
    return motion.velocity + cross(motion.spin, arm);
}

// The rows of the free axis. That of the locked distance comes later. A spring adds its load at once.
fn solve_free(joint: Joint, ends: ptr<function, Ends>, axis: FreeAxis, own: ptr<function, Impulses>, biased: bool) {
    let drive = joint_row(joint.number, 6u);
    let limits = joint_row(joint.number, 5u).xy;
    // A ball whose axes are almost opposite has no twist.
    let has_row = !is_ball(joint.flags) || dot(joint.axes[0], joint.other) >= -0.9;
    let acts = is_first_visit || joint_row(joint.number, 5u).w == 0.0;
    if has_row && biased && acts && (joint.flags & SPRUNG) != 0u {
        add_load(joint.number, spring_row(joint, ends, axis));
    }
    if has_row && !biased && drive.w > 0.0 {
        (*own).motor = held_motor(ends, axis, joint.flags, limits, vec2f(drive.z, frame.h * drive.w), (*own).motor);
    }
    if is_ball(joint.flags) {
        (*own).angular = resist(joint, ends, (*own).angular, biased);
    }
    if !has_row {
        (*own).motor = 0.0;
        (*own).lower = 0.0;
        (*own).upper = 0.0;
        return;
    }
    let friction = joint_row(joint.number, 7u).x;
    if !biased && friction > 0.0 && !is_ball(joint.flags) {
        (*own).friction = motor_row(ends, axis.lever, 0.0, frame.h * friction, (*own).friction);
    }
    if (joint.flags & LOWER) != 0u {
        (*own).lower = limit_row(ends, axis.lever, 1.0, axis.position - limits.x, (*own).lower, biased);
    }
    if (joint.flags & UPPER) != 0u {
        (*own).upper = limit_row(ends, axis.lever, -1.0, limits.y - axis.position, (*own).upper, biased);
    }
}

fn solve_cone(joint: Joint, ends: ptr<function, Ends>, old: f32, biased: bool) -> f32 {
    let across = cross(joint.other, joint.axes[0]);
    let direction = cone_direction(joint);
    if all(direction == vec3f(0.0)) {
        return old;
    }
    let gap = joint_row(joint.number, 0u).w - arc_of(length(across), dot(joint.axes[0], joint.other));
    return limit_row(ends, lever_of(joint, ends, direction, false), 1.0, gap, old, biased);
}

fn solve_joint(number: u32, biased: bool, is_first: bool) {
    if is_broken(number) {
        return;
    }
    is_first_visit = is_first;
    soft = joint_softness(bitcast<f32>(joints[JOINT_ROWS * number + 4u].w));
    let joint = joint_at(number);
    var ends = ends_of(joint);
    var own = impulses_of(number);
    var axis: FreeAxis;
    if (joint.flags & DRIVEN) != 0u {
        axis = free_axis(joint, &ends);
        solve_free(joint, &ends, axis, &own, biased);
    }
    if (joint.flags & CONE) != 0u {
        own.cone = solve_cone(joint, &ends, own.cone, biased);
    }
    if (joint.flags & LOCKED) != 0u {
        own.locked = locked_row(&ends, axis.lever, beyond_target(joint, axis.position), own.locked, biased);
    }
    if ((joint.flags >> ANGULAR) & 7u) != 0u {
        own.angular = angular_block(joint, &ends, own.angular, biased);
    }
    if (joint.flags & 7u) != 0u {
        own.linear = linear_block(joint, &ends, own.linear, biased);
    }
    put_ends(joint, &ends);
    put_impulses(number, own);
    if !biased && !is_first {
        add_load(number, push_of(joint, own));
    }
}

// The start of a frame: the impulses of the last one, in proportion to the substep, but none of a row that is no more, and no load yet.
fn open_joint(number: u32) {
    let at = JOINT_STATE_ROWS * number;
    let broken = joint_states[at + 3u].w;
    joint_states[at + 3u] = vec4f(0.0, 0.0, 0.0, broken);
    joint_states[at + 4u] = vec4f(0.0);
    let rows = array(joint_states[at], joint_states[at + 1u], joint_states[at + 2u]);
    var own = Impulses();
    if broken == 0.0 && is_finite_row(rows[0]) && is_finite_row(rows[1]) && is_finite_row(rows[2]) {
        let scale = frame.soft[0].w;
        let flags = joints[JOINT_ROWS * number + 4u].z;
        let motor = frame.h * joint_row(number, 6u).w;
        let friction = frame.h * joint_row(number, 7u).x;
        own.linear = scale * rows[0].xyz;
        own.angular = scale * rows[1].xyz;
        own.locked = select(0.0, scale * rows[0].w, (flags & LOCKED) != 0u);
        own.motor = clamp(scale * rows[1].w, -motor, motor);
        own.friction = clamp(scale * rows[2].x, -friction, friction);
        let size = length(own.angular);
        if is_ball(flags) && size > friction {
            own.angular *= friction / size;
        }
        own.lower = select(0.0, scale * rows[2].y, (flags & LOWER) != 0u);
        own.upper = select(0.0, scale * rows[2].z, (flags & UPPER) != 0u);
        own.cone = select(0.0, scale * rows[2].w, (flags & CONE) != 0u);
    }
    put_impulses(number, own);
}

fn is_finite_row(row: vec4f) -> bool {
    return is_finite(row.xyz) && is_finite(row.www);
}

fn warm_joint(number: u32) {
    if is_broken(number) {
        return;
    }
    let joint = joint_at(number);
    var ends = ends_of(joint);
    push_ends(joint, &ends, push_of(joint, impulses_of(number)));
    put_ends(joint, &ends);
}

// The end of a frame: the mean force and torque, and whether the joint bears them.
fn close_joint(number: u32) {
    let at = JOINT_STATE_ROWS * number;
    if is_broken(number) {
        return;
    }
    let time = frame.h * f32(frame.substeps);
    let force = joint_states[at + 3u].xyz / time;
    let torque = joint_states[at + 4u].xyz / time;
    let strengths = joint_row(number, 7u).yz;
    // Strengths above are infinite.
    let most = vec2f(1e38);
    let breaks = any((vec2f(length(force), length(torque)) > strengths) & (strengths < most));
    joint_states[at + 3u] = vec4f(force, select(0.0, 1.0, breaks));
    joint_states[at + 4u] = vec4f(torque, 0.0);
    if breaks {
        put_impulses(number, Impulses());
        atomicAdd(&report[6], 1u);
    }
}

// The number of the joint of a thread; `NO_JOINT` beyond the end.
fn joint_of(group: vec3u, groups: vec3u, local: u32) -> u32 {
    let k = call.colour + thread_of(group, groups, local);
    if k >= call.biased {
        return NO_JOINT;
    }
    return joint_order[k];
}

const NO_JOINT: u32 = 0xffffffffu;

@compute @workgroup_size(THREADS)
fn open_joints(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = joint_of(group, groups, local);
    if number != NO_JOINT {
        open_joint(number);
    }
}

@compute @workgroup_size(THREADS)
fn warm_joints(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = joint_of(group, groups, local);
    if number != NO_JOINT {
        warm_joint(number);
    }
}

@compute @workgroup_size(THREADS)
fn push_joints(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = joint_of(group, groups, local);
    if number != NO_JOINT {
        solve_joint(number, true, true);
    }
}

@compute @workgroup_size(THREADS)
fn relax_joints(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = joint_of(group, groups, local);
    if number != NO_JOINT {
        solve_joint(number, false, true);
    }
}

@compute @workgroup_size(THREADS)
fn push_joints_again(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = joint_of(group, groups, local);
    if number != NO_JOINT {
        solve_joint(number, true, false);
    }
}

@compute @workgroup_size(THREADS)
fn relax_joints_again(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = joint_of(group, groups, local);
    if number != NO_JOINT {
        solve_joint(number, false, false);
    }
}

@compute @workgroup_size(THREADS)
fn close_joints(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let number = joint_of(group, groups, local);
    if number != NO_JOINT {
        close_joint(number);
    }
}
