// requires rigid/frame/joint.wgsl rigid/frame/axis.wgsl rigid/frame/tensor.wgsl

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

// The drive of the free axis.
fn drive_row(
    joint: Joint, ends: ptr<function, Ends>, position: f32, axis: ptr<function, Axis>, own: ptr<function, Impulses>, biased: bool
) {
    if biased && is_first_visit {
        joint_states[JOINT_STATE_ROWS * joint.number + 5u].w = beyond_target(joint, position);
    }
    let step = drive_change(joint, (*axis).give, (*axis).hard, rate_of(ends, (*axis).lever), (*own).drive);
    (*own).drive += step;
    pull_axis(joint, ends, axis, step);
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
