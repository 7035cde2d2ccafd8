// requires model/step.wgsl physics/forces/load.wgsl physics/forces/rates.wgsl physics/forces/sphere_rates.wgsl
// requires physics/motion.wgsl

// Writes what the evaluations up to this one add to velocity and angular momentum in the step. Stage states alone would lose it by
// rounding.
fn put_increments(i: u32, rates: Rates) {
    var of_velocity = vec3f(0.0);
    var of_momentum = vec3f(0.0);
    var weight = step.dt / 6.0;
    if evaluation() != 0u {
        of_velocity = residue_row(RESIDUE_REGION, i).xyz;
        of_momentum = residue_row(RESIDUE_REGION + 1u, i).xyz;
        weight = 2.0 * weight;
    }
    put_next(RESIDUE_REGION, i, vec4f(of_velocity + weight * rates.acceleration, 0.0));
    put_next(RESIDUE_REGION + 1u, i, vec4f(of_momentum + weight * rates.torque, 0.0));
}

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
    if old_velocity.w > 0.0 {
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
        if RESIDUES {
            put_increments(i, rates);
        }
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
