// requires model/counters.wgsl model/step.wgsl physics/forces/net_force.wgsl physics/forces/sphere_rates.wgsl
// requires physics/escape.wgsl
// requires physics/motion.wgsl

// The next stage state of a sphere, from the forces on it in the evaluated stage state.

// Checks all four stage states at once, so that AABBs are read only once. The step has not changed the state yet, so a
// rejected step leaves it as it was.
fn check_escapes(i: u32, start: vec4f, velocity: vec3f, last: vec3f) {
    let aabb = aabbs[i];
    let second = start.xyz + 0.5 * step.dt * velocity;
    var ratio = max(escape_ratio(start.xyz, start.w, aabb), escape_ratio(last, start.w, aabb));
    ratio = max(ratio, escape_ratio(state[position_at(i)].xyz, start.w, aabb));
    // If stage state 2 was not finite, pass 0 has replaced it by the starting position.
    if finite(second) {
        ratio = max(ratio, escape_ratio(second, start.w, aabb));
    }
    if ratio > 0.0 {
        report_escape(ratio);
    }
}

fn write_next(i: u32, net: Net) {
    let old_position = start_row(0u, i);
    let old_velocity = start_row(1u, i);
    let old_momentum = start_row(2u, i);
    var low = vec3f(0.0);
    if DOUBLE {
        low = start_row(3u, i).xyz;
    }
    var after = Motion(old_position.xyz, low, old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        let c = select(0.5, 1.0, evaluation() == 2u) * step.dt;
        let by = c * state[velocity_at(i)].xyz;
        if DOUBLE {
            after = displaced(after, by);
        } else {
            after.position += by;
        }
        let rates = sphere_rates(i, old_velocity.w, net);
        after.velocity += c * rates.acceleration;
        after.momentum += c * rates.torque;
        if !is_finite(after) {
            after = stopped(old_position.xyz, low, evaluation() + 1u, i);
        }
        if evaluation() == 2u {
            check_escapes(i, old_position, old_velocity.xyz, after.position);
            // Stage state 4 is close to the state at the end of the step. This is accurate enough: if a sphere leaves its
            // AABB without a request, the step is rejected.
            request_rebuild(i, vec4f(after.position, old_position.w), vec4f(after.velocity, old_velocity.w));
        }
    }
    put_next(0u, i, vec4f(after.position, old_position.w));
    put_next(1u, i, vec4f(after.velocity, old_velocity.w));
    put_next(2u, i, vec4f(after.momentum, old_momentum.w));
    if DOUBLE {
        put_next(3u, i, vec4f(after.low, 0.0));
    }
}
