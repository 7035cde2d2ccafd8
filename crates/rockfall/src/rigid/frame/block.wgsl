// requires rigid/frame/joint.wgsl rigid/frame/tensor.wgsl

// The blocks of rows of a joint (docs/physics section 11.14).

// m_s, r and i_s of the rows of a joint.
struct JointSoftness {
    gain: f32,
    pull: f32,
    loss: f32,
}

// Those of the joint of this thread.
var<private> soft: JointSoftness;

// The change of the impulses of a block.
fn block_change(k: Tensor, rows: vec3<bool>, rate: vec3f, off: vec3f, old: vec3f, biased: bool) -> vec3f {
    if biased {
        return solved(k, rows, -(soft.gain * rate + soft.pull * off)) - soft.loss * old;
    }
    return solved(k, rows, -rate);
}

fn linear_tensor(joint: Joint, ends: ptr<function, Ends>) -> Tensor {
    let one = lever_of(joint, ends, joint.axes[0], true);
    let two = lever_of(joint, ends, joint.axes[1], true);
    let three = lever_of(joint, ends, joint.axes[2], true);
    let mass = (*ends).mass_a.inverse + (*ends).mass_b.inverse;
    return Tensor(
        vec3f(mass) + vec3f(shared_of(one, one), shared_of(two, two), shared_of(three, three)),
        vec3f(shared_of(one, two), shared_of(one, three), shared_of(two, three)),
    );
}

fn angular_tensor(joint: Joint, ends: ptr<function, Ends>) -> Tensor {
    let both = Mass(
        0.0, (*ends).mass_a.diagonal + (*ends).mass_b.diagonal, (*ends).mass_a.beside + (*ends).mass_b.beside
    );
    let one = respond(both, joint.axes[0]);
    let two = respond(both, joint.axes[1]);
    let three = respond(both, joint.axes[2]);
    return Tensor(
        vec3f(dot(joint.axes[0], one), dot(joint.axes[1], two), dot(joint.axes[2], three)),
        vec3f(dot(joint.axes[0], two), dot(joint.axes[0], three), dot(joint.axes[1], three)),
    );
}

// What two levers have in common in K, without the masses.
fn shared_of(one: Lever, two: Lever) -> f32 {
    return dot(one.turn_a, two.response_a) + dot(one.turn_b, two.response_b);
}

fn linear_block(joint: Joint, ends: ptr<function, Ends>, old: vec3f, biased: bool) -> vec3f {
    let rate = (point_speed((*ends).b, joint.arm_b) - point_speed((*ends).a, joint.arm_a)) * joint.axes;
    let change = block_change(linear_tensor(joint, ends), axes_in(joint.flags), rate, joint.apart * joint.axes, old, biased);
    push_ends(joint, ends, Push(joint.axes * change, vec3f(0.0)));
    return old + change;
}

fn angular_block(joint: Joint, ends: ptr<function, Ends>, old: vec3f, biased: bool) -> vec3f {
    let rows = axes_in(joint.flags >> ANGULAR);
    let rate = ((*ends).b.spin - (*ends).a.spin) * joint.axes;
    let off = select(cross(joint.axes[0], joint.other) * joint.axes, 2.0 * joint.twist.xyz, all(rows));
    let change = block_change(angular_tensor(joint, ends), rows, rate, off, old, biased);
    push_ends(joint, ends, Push(vec3f(0.0), joint.axes * change));
    return old + change;
}

// Velocity of a point at an arm from the centre of a body.
fn point_speed(motion: Motion, arm: vec3f) -> vec3f {
    return motion.velocity + cross(motion.spin, arm);
}
