// requires rigid/frame/joint.wgsl rigid/frame/block.wgsl rigid/frame/tensor.wgsl

// A row of a joint with the block that answers it and the rotor that it takes along (docs/physics section 11.14).

struct Axis {
    lever: Lever,
    // K with a hard block, and with the block of this pass. With a rotor, the second one is less by what the rotor resists.
    hard: f32,
    give: f32,
    // The impulse of the block that follows an impulse of 1 of the row, along the axes of the joint.
    answer: vec3f,
    // The part of an impulse that the rotor takes.
    share: f32,
    // Impulses on the bodies in this visit, and those on the rotor.
    pulled: f32,
    taken: f32,
}

// A row that no block answers and no rotor resists.
fn axis_alone(lever: Lever) -> Axis {
    let k = 1.0 / lever.inverse;
    return Axis(lever, k, k, vec3f(0.0), 0.0, 0.0, 0.0);
}

// The row of the free axis. The linear block answers a turn, the angular one a slide.
fn axis_of(joint: Joint, ends: ptr<function, Ends>, free: FreeAxis, biased: bool) -> Axis {
    var axis = axis_alone(free.lever);
    var moved = vec3f(0.0);
    var against = vec3f(0.0);
    if (joint.flags & TURNS) != 0u && (joint.flags & 7u) == 7u {
        let turned_a = respond((*ends).mass_a, free.direction);
        let turned_b = respond((*ends).mass_b, free.direction);
        moved = (cross(turned_a, joint.arm_a) + cross(turned_b, joint.arm_b)) * joint.axes;
        against = solved(linear_tensor(joint, ends), vec3<bool>(true), -moved);
    } else if (joint.flags & SLIDES) != 0u && ((joint.flags >> ANGULAR) & 7u) == 7u {
        let turned_a = respond((*ends).mass_a, cross(joint.arm_a, free.direction));
        let turned_b = respond((*ends).mass_b, cross(joint.arm_b, free.direction));
        moved = (turned_a + turned_b) * joint.axes;
        against = solved(angular_tensor(joint, ends), vec3<bool>(true), -moved);
    } else {
        return axis;
    }
    let gain = select(1.0, soft.gain, biased);
    let answered = dot(moved, against);
    // K with a hard block is positive, whatever its rounding.
    let k = axis.hard;
    axis.hard = max(k + answered, 1e-5 * k);
    axis.give = max(k + gain * answered, axis.hard);
    axis.answer = gain * against;
    return axis;
}

// Connects the rotor.
fn take_along(axis: ptr<function, Axis>, armature: f32) {
    let taken = armature * (*axis).give;
    (*axis).share = taken / (1.0 + taken);
    (*axis).give /= 1.0 + taken;
}

// An impulse along the row, of which the rotor takes its part. The block answers the rest.
fn pull_axis(joint: Joint, ends: ptr<function, Ends>, axis: ptr<function, Axis>, impulse: f32) {
    let taken = (*axis).share * impulse;
    let pull = impulse - taken;
    (*axis).taken += taken;
    (*axis).pulled += pull;
    pull_ends(ends, (*axis).lever, pull);
    if any((*axis).answer != vec3f(0.0)) {
        push_ends(joint, ends, answer_of(joint, joint.axes * (pull * (*axis).answer)));
    }
}

// Adds what the block and the rotor took to their impulses.
fn settle_axis(joint: Joint, axis: Axis, own: ptr<function, Impulses>) {
    let answer = answer_of(joint, axis.pulled * axis.answer);
    (*own).linear += answer.impulse;
    (*own).angular += answer.moment;
    (*own).drive -= axis.taken;
}

// The linear block pushes, the angular one turns.
fn answer_of(joint: Joint, answer: vec3f) -> Push {
    let is_push = (joint.flags & TURNS) != 0u;
    return Push(select(vec3f(0.0), answer, is_push), select(answer, vec3f(0.0), is_push));
}
