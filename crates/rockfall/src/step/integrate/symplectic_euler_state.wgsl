// requires model/counters.wgsl model/step.wgsl physics/forces/net_force.wgsl physics/forces/sphere_rates.wgsl
// requires physics/escape.wgsl
// requires physics/motion.wgsl

// The next state of a sphere by symplectic Euler, from the forces on it.

fn write_symplectic_euler(i: u32, net: Net) {
    let old_position = state[position_at(i)];
    let old_velocity = state[velocity_at(i)];
    let old_momentum = state[momentum_at(i)];
    let low = low_row(i);
    var after = Motion(old_position.xyz, low, old_velocity.xyz, old_momentum.xyz);
    if old_velocity.w > 0.0 {
        let ratio = escape_ratio(old_position.xyz, old_position.w, aabbs[i]);
        if ratio > 0.0 {
            report_escape(ratio);
        }
        let rates = sphere_rates(i, old_velocity.w, net);
        after.velocity += step.dt * rates.acceleration;
        after.momentum += step.dt * rates.torque;
        after = displaced(after, step.dt * after.velocity);
        if !is_finite(after) {
            after = stopped(old_position.xyz, low, 1u, i);
        }
    }
    put_next(0u, i, vec4f(after.position, old_position.w));
    put_next(1u, i, vec4f(after.velocity, old_velocity.w));
    put_next(2u, i, vec4f(after.momentum, old_momentum.w));
    put_next(3u, i, vec4f(after.low, 0.0));
    if RODS {
        remember(i, old_position.xyz, after.momentum * old_momentum.w);
    }
}
