// requires model/counters.wgsl model/step.wgsl physics/forces/net_force.wgsl physics/forces/sphere_rates.wgsl

// The new value of three components of a sphere in a region of the state, given the slope at Y4.
fn finished(region: u32, i: u32, slope: vec3f) -> vec3f {
    let y = start_row(region, i).xyz;
    let sum = (y2_row(region, i).xyz - y) + 2.0 * (y3_row(region, i).xyz - y) + (y4_row(region, i).xyz - y);
    return y + sum / 3.0 + (step.dt / 6.0) * slope;
}

// What the rest of the step needs to know of a sphere.
struct Finished {
    old_position: vec3f,
    // The mean over the step.
    spin: vec3f,
}

// The new state of a sphere from all four evaluations, the last of which is given.
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
        let sum = old_momentum.xyz + 2.0 * y2_row(2u, i).xyz + 2.0 * y3_row(2u, i).xyz + y4_row(2u, i).xyz;
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
