// The next stage state of a sphere, from the forces on it in the one that is evaluated.

fn write_next(i: u32, net: Net) {
    let old_position = start_row(0u, i);
    let old_velocity = start_row(1u, i);
    let old_momentum = start_row(2u, i);
    var after = Motion(old_position.xyz, old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        let c = select(0.5, 1.0, evaluation() == 2u) * step.dt;
        after.position += c * state[velocity_at(i)].xyz;
        after.velocity += c * (step.gravity + old_velocity.w * net.force);
        after.momentum += c * net.torque;
        if !is_finite(after) {
            after = stopped(old_position.xyz, evaluation() + 1u, i);
        }
        var ratio = escape_ratio(after.position, old_position.w, aabbs[i]);
        if evaluation() == 0u {
            ratio = max(ratio, escape_ratio(old_position.xyz, old_position.w, aabbs[i]));
        }
        if ratio > 0.0 {
            tell_escape(ratio);
        }
        // Stage state 4 is about where the step will end, which is good enough: whoever leaves unannounced voids a step.
        if evaluation() == 2u {
            ask_for_lists(i, vec4f(after.position, old_position.w), vec4f(after.velocity, old_velocity.w));
        }
    }
    put_next(0u, i, vec4f(after.position, old_position.w));
    put_next(1u, i, vec4f(after.velocity, old_velocity.w));
    put_next(2u, i, vec4f(after.momentum, old_momentum.w));
}
