// requires rigid/frame/rows.wgsl rigid/frame/joint.wgsl rigid/frame/block.wgsl rigid/frame/axis.wgsl
// requires rigid/frame/drive.wgsl rigid/frame/halt.wgsl rigid/frame/report.wgsl

// The rows of joints (docs/physics section 11.14). A thread has a joint, and for this dispatch both of its bodies. In these stages the
// two words of `call` are the first entry of a colour in `joint_order` and the end.

// Of a frequency times the substep, with the damping ratio 2.
fn joint_softness(frequency: f32) -> JointSoftness {
    let turn = FULL_TURN * frequency;
    let first = 4.0 + turn;
    let loss = 1.0 / (1.0 + turn * first);
    let gain = turn * first * loss;
    return JointSoftness(gain, gain * turn / (first * frame.h), loss);
}

fn locked_row(joint: Joint, ends: ptr<function, Ends>, axis: ptr<function, Axis>, off: f32, old: f32, biased: bool) -> f32 {
    let rate = rate_of(ends, (*axis).lever);
    var next = old - rate / (*axis).give;
    if biased {
        next = (1.0 - soft.loss) * old - (soft.gain * rate + soft.pull * off) / (*axis).give;
    }
    pull_axis(joint, ends, axis, next - old);
    return next;
}

// A row that holds a speed with at most this impulse.
fn motor_row(joint: Joint, ends: ptr<function, Ends>, axis: ptr<function, Axis>, speed: f32, most: f32, old: f32) -> f32 {
    let next = clamp(old - (rate_of(ends, (*axis).lever) - speed) / (*axis).give, -most, most);
    pull_axis(joint, ends, axis, next - old);
    return next;
}

// The motor in reach of a limit: in a substep it goes no farther than to its limit, and there it does not push on. Its speed and
// greatest force.
fn motor_at(position: f32, flags: u32, limits: vec2f, drive: vec2f) -> vec2f {
    let reach = (limits - vec2f(position)) / frame.h;
    var motor = drive;
    if (flags & LOWER) != 0u && drive.x < 0.0 {
        motor.x = max(drive.x, min(reach.x, 0.0));
        motor.y = select(motor.y, 0.0, reach.x >= 0.0);
    }
    if (flags & UPPER) != 0u && drive.x > 0.0 {
        motor.x = min(drive.x, max(reach.y, 0.0));
        motor.y = select(motor.y, 0.0, reach.y <= 0.0);
    }
    return motor;
}

// A row that keeps a gap open, which grows along the lever or, with the side -1, against it.
fn limit_row(joint: Joint, ends: ptr<function, Ends>, axis: ptr<function, Axis>, side: f32, gap: f32, old: f32, biased: bool) -> f32 {
    let rate = side * rate_of(ends, (*axis).lever);
    var next = old;
    if biased && gap > 0.0 {
        next = old - (rate + gap / frame.h) / (*axis).give;
    } else if biased {
        next = (1.0 - soft.loss) * old - (soft.gain * rate + soft.pull * gap) / (*axis).give;
    } else if gap <= 0.0 || old > 0.0 {
        next = old - rate / (*axis).give;
    }
    next = max(next, 0.0);
    pull_axis(joint, ends, axis, side * (next - old));
    return next;
}

// The rows of the free axis.
fn solve_free(joint: Joint, ends: ptr<function, Ends>, own: ptr<function, Impulses>, biased: bool) {
    // A ball whose axes are almost opposite has no twist.
    if is_ball(joint.flags) && dot(joint.axes[0], joint.other) < -0.9 {
        (*own).motor = 0.0;
        (*own).lower = 0.0;
        (*own).upper = 0.0;
        (*own).drive = 0.0;
        return;
    }
    let free = free_axis(joint, ends);
    var axis = axis_of(joint, ends, free, biased);
    if (joint.flags & SPRUNG) != 0u {
        drive_row(joint, ends, free.position, &axis, own, biased);
    }
    let armature = select(joint_row(joint.number, 8u).z, 0.0, is_ball(joint.flags));
    take_along(&axis, armature);
    let drive = joint_row(joint.number, 6u);
    let limits = joint_row(joint.number, 5u).xy;
    if !biased && drive.w > 0.0 {
        let motor = motor_at(free.position, joint.flags, limits, drive.zw);
        (*own).motor = motor_row(joint, ends, &axis, motor.x, frame.h * motor.y, (*own).motor);
    }
    let friction = joint_row(joint.number, 7u).x;
    if !biased && friction > 0.0 && !is_ball(joint.flags) {
        (*own).friction = motor_row(joint, ends, &axis, 0.0, frame.h * friction, (*own).friction);
    }
    if (joint.flags & LOWER) != 0u {
        (*own).lower = limit_row(joint, ends, &axis, 1.0, free.position - limits.x, (*own).lower, biased);
    }
    if (joint.flags & UPPER) != 0u {
        (*own).upper = limit_row(joint, ends, &axis, -1.0, limits.y - free.position, (*own).upper, biased);
    }
    if (joint.flags & LOCKED) != 0u {
        (*own).locked = locked_row(joint, ends, &axis, beyond_target(joint, free.position), (*own).locked, biased);
    }
    settle_axis(joint, axis, own);
    if armature > 0.0 && is_last_visit(biased) {
        joint_states[JOINT_STATE_ROWS * joint.number + 6u].x = rate_of(ends, axis.lever);
    }
}

fn solve_cone(joint: Joint, ends: ptr<function, Ends>, old: f32, biased: bool) -> f32 {
    let across = cross(joint.other, joint.axes[0]);
    let direction = cone_direction(joint);
    if all(direction == vec3f(0.0)) {
        return old;
    }
    let gap = joint_row(joint.number, 0u).w - arc_of(length(across), dot(joint.axes[0], joint.other));
    var axis = axis_alone(lever_of(joint, ends, direction, false));
    return limit_row(joint, ends, &axis, 1.0, gap, old, biased);
}

// Rows that no block answers come before the blocks, and those that a block answers after them.
fn solve_joint(number: u32, biased: bool, is_first: bool) {
    if is_broken(number) {
        return;
    }
    is_first_visit = is_first;
    soft = joint_softness(bitcast<f32>(joints[JOINT_ROWS * number + 4u].w));
    let joint = joint_at(number);
    var ends = ends_of(joint);
    var own = impulses_of(number);
    if is_ball(joint.flags) {
        own.resistance = resist(joint, &ends, own.resistance, biased);
        if !biased {
            own.angular = rub(joint, &ends, own.angular);
        }
    }
    if (joint.flags & CONE) != 0u {
        own.cone = solve_cone(joint, &ends, own.cone, biased);
    }
    if ((joint.flags >> ANGULAR) & 7u) != 0u {
        own.angular = angular_block(joint, &ends, own.angular, biased);
    }
    if (joint.flags & 7u) != 0u {
        own.linear = linear_block(joint, &ends, own.linear, biased);
    }
    if (joint.flags & DRIVEN) != 0u {
        solve_free(joint, &ends, &own, biased);
    }
    put_ends(joint, &ends);
    put_impulses(number, own);
    if is_last_visit(biased) {
        add_load(number, push_of(joint, own));
    }
}

// The start of a frame: the impulses of the last one, in proportion to the substep, but none of a row that is no more, and no load yet.
fn open_joint(number: u32) {
    let at = JOINT_STATE_ROWS * number;
    let broken = joint_states[at + 4u].w;
    joint_states[at + 4u] = vec4f(0.0, 0.0, 0.0, broken);
    joint_states[at + 5u] = vec4f(0.0);
    let rows = array(joint_states[at], joint_states[at + 1u], joint_states[at + 2u], joint_states[at + 3u]);
    var own = Impulses();
    if broken == 0.0 && is_finite_row(rows[0]) && is_finite_row(rows[1]) && is_finite_row(rows[2]) && is_finite_row(rows[3]) {
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
        own.resistance = select(vec3f(0.0), scale * rows[3].xyz, resistance_of(number) > 0.0);
        own.drive = select(0.0, scale * rows[3].w, (flags & SPRUNG) != 0u);
    }
    put_impulses(number, own);
    joint_states[at + 6u] = vec4f(0.0);
    if joint_row(number, 8u).z > 0.0 {
        start_rotor(number);
    }
}

// The rate of a rotor is that of its joint.
fn start_rotor(number: u32) {
    let joint = joint_at(number);
    var ends = ends_of(joint);
    var rotor = (ends.b.spin - ends.a.spin) * joint.axes;
    if !is_ball(joint.flags) {
        rotor = vec3f(rate_of(&ends, free_axis(joint, &ends).lever), 0.0, 0.0);
    }
    joint_states[JOINT_STATE_ROWS * number + 6u] = vec4f(rotor, 0.0);
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
    let force = joint_states[at + 4u].xyz / time;
    let torque = joint_states[at + 5u].xyz / time;
    let strengths = joint_row(number, 7u).yz;
    // Strengths above are infinite.
    let most = vec2f(1e38);
    let breaks = any((vec2f(length(force), length(torque)) > strengths) & (strengths < most));
    joint_states[at + 4u] = vec4f(force, select(0.0, 1.0, breaks));
    joint_states[at + 5u] = vec4f(torque, 0.0);
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
