// requires model/step.wgsl physics/forces/load.wgsl physics/forces/sphere_rates.wgsl physics/motion.wgsl physics/rigid.wgsl

// Makes the next state of a sphere by symplectic Euler its state, and returns the new spin.
fn symplectic_euler_sphere(i: u32, load: Load) -> vec3f {
    let old_position = state[position_at(i)];
    let old_velocity = state[velocity_at(i)];
    let old_momentum = state[momentum_at(i)];
    var after = Motion(old_position.xyz, low_row(i), old_velocity.xyz, old_momentum.xyz);
    if (old_velocity.w > 0.0) & is_free(i) {
        var residues = vec4f(0.0);
        if RESIDUES {
            residues = residue_row(RESIDUE_REGION, i);
        }
        let kicked = kicked_and_moved(after, residues, sphere_rates(i, old_velocity.w, load), step.dt, i);
        after = kicked.motion;
        put_start(0u, i, vec4f(after.position, old_position.w));
        put_start(1u, i, vec4f(after.velocity, old_velocity.w));
        put_start(2u, i, vec4f(after.momentum, old_momentum.w));
        put_start(3u, i, vec4f(after.low, 0.0));
        if RESIDUES {
            put_start(RESIDUE_REGION, i, kicked.residues);
        }
    }
    return after.momentum * old_momentum.w;
}
