// requires model/load_rows.wgsl model/one_state.wgsl model/put_next.wgsl model/rates.wgsl model/step.wgsl
// requires physics/forces/rates.wgsl physics/forces/sphere_rates.wgsl physics/motion.wgsl physics/rigid.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> y3: array<vec4f>;
@group(0) @binding(5) var<storage, read> topology: array<u32>;
@group(0) @binding(6) var<storage, read> kept_rates: array<f32>;
@group(0) @binding(7) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// The rates at the start of the step.
fn starting_rates(i: u32, inverse_mass: f32) -> Rates {
    if status.forces_due != 0u {
        return sphere_rates(i, inverse_mass, load_of(i));
    }
    return kept_rates_of(i);
}

fn drift_sphere(i: u32) {
    let position = state[position_at(i)];
    let velocity = state[velocity_at(i)];
    let momentum = state[momentum_at(i)];
    var after = Motion(position.xyz, low_row(i), velocity.xyz, momentum.xyz);
    var residues = vec4f(0.0);
    if RESIDUES {
        residues = residue_row(RESIDUE_REGION, i);
    }
    if (velocity.w > 0.0) & is_free(i) {
        let kicked = kicked_and_moved(after, residues, starting_rates(i, velocity.w), 0.5 * step.dt, i);
        after = kicked.motion;
        residues = kicked.residues;
    }
    if RESIDUES {
        put_next(RESIDUE_REGION, i, residues);
    }
    put_next(0u, i, vec4f(after.position, position.w));
    put_next(1u, i, vec4f(after.velocity, velocity.w));
    put_next(2u, i, vec4f(after.momentum, momentum.w));
    put_next(3u, i, vec4f(after.low, 0.0));
    if LATE_TURN {
        y3[position_at(i)] = vec4f(position.xyz, 0.0);
        y3[momentum_at(i)] = vec4f(after.momentum * momentum.w, 0.0);
    }
}

@compute @workgroup_size(256)
fn drift(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    drift_sphere(i);
}
