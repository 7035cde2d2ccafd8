// The new value of three components at a place in the state, given the slope at Y4.
fn finished(at: u32, slope: vec3f) -> vec3f {
    let y = start[at].xyz;
    let sum = (y2[at].xyz - y) + 2.0 * (y3[at].xyz - y) + (state[at].xyz - y);
    return y + sum / 3.0 + (step.dt / 6.0) * slope;
}

// What the rest of the step needs to know of a sphere.
struct Finished {
    old_position: vec3f,
    // The mean over the step.
    spin: vec3f,
}

// The last force evaluation, and the new state of a sphere from all four.
fn finish_sphere(i: u32) -> Finished {
    let old_position = start[position_at(i)];
    let old_velocity = start[velocity_at(i)];
    let old_momentum = start[momentum_at(i)];
    var spin = old_momentum.xyz * old_momentum.w;
    if old_velocity.w > 0.0 {
        let net = net_force(i);
        var after = Motion(
            finished(position_at(i), state[velocity_at(i)].xyz),
            finished(velocity_at(i), step.gravity + old_velocity.w * net.force),
            finished(momentum_at(i), net.torque),
        );
        let at = momentum_at(i);
        spin = (old_momentum.xyz + 2.0 * y2[at].xyz + 2.0 * y3[at].xyz + state[at].xyz) * (old_momentum.w / 6.0);
        if !is_finite(after) {
            after = stopped(old_position.xyz, 4u, i);
            spin = vec3f(0.0);
        }
        start[position_at(i)] = vec4f(after.position, old_position.w);
        start[velocity_at(i)] = vec4f(after.velocity, old_velocity.w);
        start[momentum_at(i)] = vec4f(after.momentum, old_momentum.w);
    }
    return Finished(old_position.xyz, spin);
}
