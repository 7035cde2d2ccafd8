// requires model/step.wgsl physics/forces/load.wgsl physics/forces/sphere_rates.wgsl physics/motion.wgsl physics/residue.wgsl

// What stage states 2 to 4 add to a vector of a sphere, velocity or angular momentum, by region: three times the change without the
// slope at Y4.
fn stage_changes(region: u32, i: u32) -> vec3f {
    let y = start_row(region, i).xyz;
    return early_changes(region, i, y) + (y4_row(region, i).xyz - y);
}

// The new value of a vector of a sphere, velocity or angular momentum, by region. `slope` is its rate of change at Y4.
fn finished(region: u32, i: u32, slope: vec3f) -> vec3f {
    return start_row(region, i).xyz + stage_changes(region, i) / 3.0 + (step.dt / 6.0) * slope;
}

// Data of a sphere for the later stages of the step.
struct Finished {
    old_position: vec3f,
    // The mean spin over the step.
    spin: vec3f,
}

// Writes the new state of a sphere, from the stage states and its load in the last of them.
fn finish_sphere(i: u32, load: Load) -> Finished {
    let old_position = start_row(0u, i);
    let old_velocity = start_row(1u, i);
    let old_momentum = start_row(2u, i);
    var spin = old_momentum.xyz * old_momentum.w;
    if old_velocity.w > 0.0 {
        let rates = sphere_rates(i, old_velocity.w, load);
        let low = start_row(3u, i).xyz;
        var after = Motion(old_position.xyz, low, vec3f(0.0), vec3f(0.0));
        var residues = vec4f(0.0);
        if RESIDUES {
            let by_velocity = y4_row(RESIDUE_REGION, i).xyz + (step.dt / 6.0) * rates.acceleration;
            let by_momentum = y4_row(RESIDUE_REGION + 1u, i).xyz + (step.dt / 6.0) * rates.torque;
            let new_ = increased(old_velocity.xyz, old_momentum.xyz, start_row(RESIDUE_REGION, i), by_velocity, by_momentum, false);
            after.velocity = new_.velocity;
            after.momentum = new_.momentum;
            residues = new_.residues;
        } else {
            after.velocity = finished(1u, i, rates.acceleration);
            after.momentum = finished(2u, i, rates.torque);
        }
        // The rates of positions are the velocities of the stage states.
        after = displaced(after, step.dt * (old_velocity.xyz + (early_velocities(i, old_velocity.xyz) + (y4_row(1u, i).xyz - old_velocity.xyz)) / 6.0));
        let sum = early_momenta(i, old_momentum.xyz) + y4_row(2u, i).xyz;
        spin = sum * (old_momentum.w / 6.0);
        if !is_finite(after) {
            after = stopped(old_position.xyz, low, 4u, i);
            spin = vec3f(0.0);
            residues = vec4f(0.0);
        }
        put_start(0u, i, vec4f(after.position, old_position.w));
        put_start(1u, i, vec4f(after.velocity, old_velocity.w));
        put_start(2u, i, vec4f(after.momentum, old_momentum.w));
        put_start(3u, i, vec4f(after.low, 0.0));
        if RESIDUES {
            put_start(RESIDUE_REGION, i, residues);
        }
    }
    return Finished(old_position.xyz, spin);
}
