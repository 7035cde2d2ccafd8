// requires model/counters.wgsl model/step.wgsl physics/forces/net_force.wgsl physics/forces/sphere_rates.wgsl

// The new value of a vector of a sphere: position, velocity or angular momentum, by region. `slope` is its rate of change
// at Y4.
fn finished(region: u32, i: u32, slope: vec3f) -> vec3f {
    let y = start_row(region, i).xyz;
    let sum = early_changes(region, i, y) + (y4_row(region, i).xyz - y);
    return y + sum / 3.0 + (step.dt / 6.0) * slope;
}

// Data of a sphere for the later stages of the step.
struct Finished {
    old_position: vec3f,
    // The mean spin over the step.
    spin: vec3f,
}

// Writes the new state of a sphere, from the stage states and the last force evaluation.
fn finish_sphere(i: u32, net: Net) -> Finished {
    let old_position = start_row(0u, i);
    let old_velocity = start_row(1u, i);
    let old_momentum = start_row(2u, i);
    var spin = old_momentum.xyz * old_momentum.w;
    if old_velocity.w > 0.0 {
        let rates = sphere_rates(i, old_velocity.w, net);
        var after = Motion(
            finished(0u, i, y4_row(1u, i).xyz),
            finished(1u, i, rates.acceleration),
            finished(2u, i, rates.torque),
        );
        let sum = early_momenta(i, old_momentum.xyz) + y4_row(2u, i).xyz;
        spin = sum * (old_momentum.w / 6.0);
        if !is_finite(after) {
            after = stopped(old_position.xyz, 4u, i);
            spin = vec3f(0.0);
        }
        put_start(0u, i, vec4f(after.position, old_position.w));
        put_start(1u, i, vec4f(after.velocity, old_velocity.w));
        put_start(2u, i, vec4f(after.momentum, old_momentum.w));
    }
    return Finished(old_position.xyz, spin);
}
