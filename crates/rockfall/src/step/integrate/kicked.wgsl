// requires model/put_rates.wgsl model/step.wgsl physics/forces/net_force.wgsl physics/forces/rates.wgsl
// requires physics/forces/sphere_rates.wgsl physics/motion.wgsl

// The second half of the kick of velocity Verlet. `state` is the state after the drift. Writes the new state and the rates, and
// returns the spin in the middle of the step.
fn kick_sphere(i: u32, net: Net) -> vec3f {
    let position = state[position_at(i)];
    let velocity = state[velocity_at(i)];
    let momentum = state[momentum_at(i)];
    if velocity.w <= 0.0 {
        return momentum.xyz * momentum.w;
    }
    var rates = sphere_rates(i, velocity.w, net);
    var after = Motion(
        position.xyz,
        low_row(i),
        velocity.xyz + 0.5 * step.dt * rates.acceleration,
        momentum.xyz + 0.5 * step.dt * rates.torque,
    );
    var spin = momentum.xyz * momentum.w;
    if !is_finite(after) {
        after = stopped(start[i].xyz, start[low_at(i)].xyz, 2u, i);
        rates = Rates(vec3f(0.0), vec3f(0.0));
        spin = vec3f(0.0);
    }
    put_rates(i, rates);
    start[i] = vec4f(after.position, position.w);
    start[step.spheres + i] = vec4f(after.velocity, velocity.w);
    start[2u * step.spheres + i] = vec4f(after.momentum, momentum.w);
    start[low_at(i)] = vec4f(after.low, 0.0);
    return spin;
}

// Records that the rates belong to the new state.
fn rates_are_kept(i: u32) {
    if i == 0u {
        status.forces_due = 0u;
    }
}
