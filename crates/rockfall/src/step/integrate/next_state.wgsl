// requires model/step.wgsl physics/forces/load.wgsl physics/forces/sphere_rates.wgsl physics/motion.wgsl physics/rigid.wgsl

// Writes the next stage state of a sphere, from its load in the evaluated stage state.
fn write_next(i: u32, load: Load) {
    let old_position = start_row(0u, i);
    let old_velocity = start_row(1u, i);
    let old_momentum = start_row(2u, i);
    var low = vec3f(0.0);
    if DOUBLE {
        low = start_row(3u, i).xyz;
    }
    var after = Motion(old_position.xyz, low, old_velocity.xyz, old_momentum.xyz);
    if (old_velocity.w > 0.0) & is_free(i) {
        let c = select(0.5, 1.0, evaluation() == 2u) * step.dt;
        let by = c * state[velocity_at(i)].xyz;
        if DOUBLE {
            after = displaced(after, by);
        } else {
            after.position += by;
        }
        let rates = sphere_rates(i, old_velocity.w, load);
        after.velocity += c * rates.acceleration;
        after.momentum += c * rates.torque;
        if !is_finite(after) {
            after = stopped(old_position.xyz, low, evaluation() + 1u, i);
        }
    }
    put_next(0u, i, vec4f(after.position, old_position.w));
    put_next(1u, i, vec4f(after.velocity, old_velocity.w));
    put_next(2u, i, vec4f(after.momentum, old_momentum.w));
    if DOUBLE {
        put_next(3u, i, vec4f(after.low, 0.0));
    }
}
