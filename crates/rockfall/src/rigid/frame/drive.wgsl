// requires rigid/frame/joint.wgsl rigid/frame/tensor.wgsl

// What acts by the rate of a joint at the end of a substep: springs, dampers, efforts, drags and rotors (docs/physics section 11.14).

// Whether this is the first of the two visits of the joint of this thread in the pass.
var<private> is_first_visit: bool;

fn is_last_visit(biased: bool) -> bool {
    return !biased && !is_first_visit;
}

// Whether friction, damping and rotor resist all rotations.
fn is_ball(flags: u32) -> bool {
    return (flags & TURNS) != 0u && ((flags >> ANGULAR) & 7u) == 0u;
}

// Velocity of a point at an arm from the centre of a body.
fn point_speed(motion: Motion, arm: vec3f) -> vec3f {
    return motion.velocity + cross(motion.spin, arm);
}

// The velocity of B at the anchor and its spin, relative to A, that a push gives.
fn response_to(joint: Joint, ends: ptr<function, Ends>, push: Push) -> Push {
    let a = respond((*ends).mass_a, cross(joint.arm_a, push.impulse) + push.moment);
    let b = respond((*ends).mass_b, cross(joint.arm_b, push.impulse) + push.moment);
    let linear = (*ends).mass_a.inverse + (*ends).mass_b.inverse;
    return Push(linear * push.impulse + cross(a, joint.arm_a) + cross(b, joint.arm_b), a + b);
}

// What the rows of the joint answer at once to a push of 1 along the free axis.
fn answer_to(joint: Joint, ends: ptr<function, Ends>, alone: Push) -> Push {
    let zero = vec3f(0.0);
    let all_rows = vec3<bool>(true);
    let moved = response_to(joint, ends, alone);
    if (joint.flags & TURNS) != 0u && (joint.flags & 7u) == 7u {
        let x = response_to(joint, ends, Push(vec3f(1.0, 0.0, 0.0), zero)).impulse;
        let y = response_to(joint, ends, Push(vec3f(0.0, 1.0, 0.0), zero)).impulse;
        let z = response_to(joint, ends, Push(vec3f(0.0, 0.0, 1.0), zero)).impulse;
        let k = Tensor(vec3f(x.x, y.y, z.z), vec3f(y.x, z.x, z.y));
        return Push(solved(k, all_rows, -moved.impulse), zero);
    }
    if (joint.flags & SLIDES) != 0u && ((joint.flags >> ANGULAR) & 7u) == 7u {
        let k = Tensor((*ends).mass_a.diagonal + (*ends).mass_b.diagonal, (*ends).mass_a.beside + (*ends).mass_b.beside);
        return Push(zero, solved(k, all_rows, -moved.moment));
    }
    return Push(zero, zero);
}

// The change of the impulse of a drive at a speed of its row, with K.
fn drive_change(joint: Joint, k: f32, speed: f32, old: f32) -> f32 {
    let h = frame.h;
    let at = JOINT_STATE_ROWS * joint.number;
    let stiffness = joint_row(joint.number, 5u).w;
    let spring = joint_row(joint.number, 6u).xy;
    let axis = joint_row(joint.number, 8u).xyz;
    let alone = select(1.0, 0.0, is_ball(joint.flags));
    let armature = alone * axis.z;
    // theta h^2 k = h^2 k - 1 / K - J_a, or 0.
    let bounded = alone * h * spring.x + max(h * h * stiffness - 1.0 / k - armature, 0.0);
    let free = alone * h * axis.y + armature;
    let push = h * (axis.x - stiffness * joint_states[at + 5u].w);
    let kept = armature * joint_states[at + 6u].x - old;
    let all = bounded + free;
    let step = (push + kept - all * speed) / (1.0 + all * k);
    let force = push - bounded * (speed + k * step);
    let most = h * spring.y;
    if abs(force) <= most {
        return step;
    }
    return (clamp(force, -most, most) + kept - free * speed) / (1.0 + free * k);
}

// The drive of the free axis. What the blocks answer is added to their impulses.
fn drive_row(joint: Joint, ends: ptr<function, Ends>, axis: FreeAxis, own: ptr<function, Impulses>, biased: bool) {
    let at = JOINT_STATE_ROWS * joint.number;
    if biased && is_first_visit {
        joint_states[at + 5u].w = beyond_target(joint, axis.position);
    }
    let alone = push_along(joint, axis.direction, 1.0);
    let answer = answer_to(joint, ends, alone);
    let push = Push(alone.impulse + answer.impulse, alone.moment + answer.moment);
    let moved = response_to(joint, ends, push);
    let k = dot(push.impulse, moved.impulse) + dot(push.moment, moved.moment);
    let speed = point_speed((*ends).b, joint.arm_b) - point_speed((*ends).a, joint.arm_a);
    let rate = dot(push.impulse, speed) + dot(push.moment, (*ends).b.spin - (*ends).a.spin);
    let step = drive_change(joint, k, rate, (*own).drive);
    (*own).drive += step;
    (*own).linear += (step * answer.impulse) * joint.axes;
    (*own).angular += (step * answer.moment) * joint.axes;
    push_ends(joint, ends, Push(step * push.impulse, step * push.moment));
    if is_last_visit(biased) && !is_ball(joint.flags) {
        joint_states[at + 6u].x = rate + k * step;
    }
}

// h (c + c_d) + J_a of a ball; 0 for others.
fn resistance_of(number: u32) -> f32 {
    let axis = joint_row(number, 8u);
    let all = frame.h * (joint_row(number, 6u).x + axis.y) + axis.z;
    return select(0.0, all, is_ball(joints[JOINT_ROWS * number + 4u].z));
}

// The drive of a ball about all axes, along those of the joint. Its impulses.
fn resist(joint: Joint, ends: ptr<function, Ends>, old: vec3f, biased: bool) -> vec3f {
    let resistance = resistance_of(joint.number);
    if resistance == 0.0 {
        return old;
    }
    var k = Tensor((*ends).mass_a.diagonal + (*ends).mass_b.diagonal, (*ends).mass_a.beside + (*ends).mass_b.beside);
    k.diagonal += vec3f(1.0 / resistance);
    let at = JOINT_STATE_ROWS * joint.number + 6u;
    let kept = joint.axes * (old - joint_row(joint.number, 8u).z * joint_states[at].xyz);
    let rate = (*ends).b.spin - (*ends).a.spin;
    let step = solved(k, vec3<bool>(true), -(rate + kept / resistance));
    push_ends(joint, ends, Push(vec3f(0.0), step));
    if is_last_visit(biased) {
        joint_states[at] = vec4f(((*ends).b.spin - (*ends).a.spin) * joint.axes, 0.0);
    }
    return old + step * joint.axes;
}

// Friction of a ball. Its impulses.
fn rub(joint: Joint, ends: ptr<function, Ends>, old: vec3f) -> vec3f {
    let friction = frame.h * joint_row(joint.number, 7u).x;
    if friction == 0.0 {
        return old;
    }
    let k = Tensor((*ends).mass_a.diagonal + (*ends).mass_b.diagonal, (*ends).mass_a.beside + (*ends).mass_b.beside);
    let before = joint.axes * old;
    var kept = before + solved(k, vec3<bool>(true), -((*ends).b.spin - (*ends).a.spin));
    let size = length(kept);
    if size > friction {
        kept *= friction / size;
    }
    push_ends(joint, ends, Push(vec3f(0.0), kept - before));
    return kept * joint.axes;
}
