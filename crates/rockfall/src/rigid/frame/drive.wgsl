// requires rigid/frame/joint.wgsl rigid/frame/block.wgsl rigid/frame/tensor.wgsl

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

// How the block of a joint answers its drive: the linear one of a turn, the angular one of a slide. Along the axes of the joint.
struct Coupling {
    // The rate of the block that an impulse of 1 of the drive gives.
    moved: vec3f,
    // The impulse of the block that follows an impulse of 1, and the one that follows in any case.
    answer: vec3f,
    expected: vec3f,
}

fn coupling_of(joint: Joint, ends: ptr<function, Ends>, direction: vec3f, own: ptr<function, Impulses>, biased: bool) -> Coupling {
    let all_rows = vec3<bool>(true);
    let gain = select(1.0, soft.gain, biased);
    if (joint.flags & TURNS) != 0u && (joint.flags & 7u) == 7u {
        let turned_a = respond((*ends).mass_a, direction);
        let turned_b = respond((*ends).mass_b, direction);
        let moved = (cross(turned_a, joint.arm_a) + cross(turned_b, joint.arm_b)) * joint.axes;
        let k = linear_tensor(joint, ends);
        let rate = (point_speed((*ends).b, joint.arm_b) - point_speed((*ends).a, joint.arm_a)) * joint.axes;
        let expected = block_change(k, all_rows, rate, joint.apart * joint.axes, (*own).linear, biased);
        return Coupling(moved, gain * solved(k, all_rows, -moved), expected);
    }
    if (joint.flags & SLIDES) != 0u && ((joint.flags >> ANGULAR) & 7u) == 7u {
        let turned_a = respond((*ends).mass_a, cross(joint.arm_a, direction));
        let turned_b = respond((*ends).mass_b, cross(joint.arm_b, direction));
        let moved = (turned_a + turned_b) * joint.axes;
        let k = angular_tensor(joint, ends);
        let rate = ((*ends).b.spin - (*ends).a.spin) * joint.axes;
        let expected = block_change(k, all_rows, rate, 2.0 * joint.twist.xyz, (*own).angular, biased);
        return Coupling(moved, gain * solved(k, all_rows, -moved), expected);
    }
    return Coupling(vec3f(0.0), vec3f(0.0), vec3f(0.0));
}

// The change of the impulse of a drive at a speed of its row, with its K and that of a hard block.
fn drive_change(joint: Joint, k: f32, hard: f32, speed: f32, old: f32) -> f32 {
    let h = frame.h;
    let at = JOINT_STATE_ROWS * joint.number;
    let stiffness = joint_row(joint.number, 5u).w;
    let spring = joint_row(joint.number, 6u).xy;
    let axis = joint_row(joint.number, 8u).xyz;
    let alone = select(1.0, 0.0, is_ball(joint.flags));
    let armature = alone * axis.z;
    // A stiff spring has a damping of its own, and a greatest stiffness.
    let bounded = alone * h * spring.x + clamp(h * h * stiffness - 0.25 / hard, 0.0, 6.0 / hard);
    let free = alone * h * axis.y + armature;
    let push = h * axis.x - min(h * stiffness, 2.0 / (h * hard)) * joint_states[at + 5u].w;
    let kept = armature * joint_states[at + 6u].x - old;
    let both = bounded + free;
    let step = (push + kept - both * speed) / (1.0 + both * k);
    let force = push - bounded * (speed + k * step);
    let most = h * spring.y;
    if abs(force) <= most {
        return step;
    }
    return (clamp(force, -most, most) + kept - free * speed) / (1.0 + free * k);
}

// The drive of the free axis. What the block answers is added to its impulses.
fn drive_row(joint: Joint, ends: ptr<function, Ends>, axis: FreeAxis, own: ptr<function, Impulses>, biased: bool) {
    let at = JOINT_STATE_ROWS * joint.number;
    if biased && is_first_visit {
        joint_states[at + 5u].w = beyond_target(joint, axis.position);
    }
    let block = coupling_of(joint, ends, axis.direction, own, biased);
    let answered = dot(block.moved, block.answer);
    // K with a hard block is positive, whatever its rounding.
    let own_k = 1.0 / axis.lever.inverse;
    let hard = max(own_k + answered / select(1.0, soft.gain, biased), 1e-5 * own_k);
    let k = max(own_k + answered, hard);
    let rate = rate_of(ends, axis.lever) + dot(block.moved, block.expected);
    let step = drive_change(joint, k, hard, rate, (*own).drive);
    (*own).drive += step;
    pull_ends(ends, axis.lever, step);
    let answer = step * block.answer;
    if (joint.flags & TURNS) != 0u {
        (*own).linear += answer;
        push_ends(joint, ends, Push(joint.axes * answer, vec3f(0.0)));
    } else {
        (*own).angular += answer;
        push_ends(joint, ends, Push(vec3f(0.0), joint.axes * answer));
    }
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
