// requires model/early.wgsl model/load_rows.wgsl model/one_state.wgsl model/put_rates.wgsl model/step.wgsl physics/forces/load.wgsl
// requires physics/forces/rates.wgsl physics/forces/sphere_rates.wgsl physics/motion.wgsl physics/residue.wgsl physics/rotation.wgsl physics/rigid.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> start: array<vec4f>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> kept_rates: array<f32>;
@group(0) @binding(7) var<storage, read_write> orientations: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// The second half of the kick. `state` is the state after the drift. Writes the new state and the rates, and returns the spin in the
// middle of the step.
fn kick_sphere(i: u32, load: Load) -> vec3f {
    let position = state[position_at(i)];
    let velocity = state[velocity_at(i)];
    let momentum = state[momentum_at(i)];
    if (velocity.w <= 0.0) | !is_free(i) {
        return momentum.xyz * momentum.w;
    }
    var rates = sphere_rates(i, velocity.w, load);
    var residues = vec4f(0.0);
    if RESIDUES {
        residues = residue_row(RESIDUE_REGION, i);
    }
    let half = 0.5 * step.dt;
    let new_ = increased(velocity.xyz, momentum.xyz, residues, half * rates.acceleration, half * rates.torque, false);
    var after = Motion(position.xyz, low_row(i), new_.velocity, new_.momentum);
    residues = new_.residues;
    var spin = momentum.xyz * momentum.w;
    if !is_finite(after) {
        after = stopped(start[i].xyz, start[low_at(i)].xyz, 2u, i);
        rates = Rates(vec3f(0.0), vec3f(0.0));
        spin = vec3f(0.0);
        residues = vec4f(0.0);
    }
    put_rates(i, rates);
    start[i] = vec4f(after.position, position.w);
    start[step.spheres + i] = vec4f(after.velocity, velocity.w);
    start[2u * step.spheres + i] = vec4f(after.momentum, momentum.w);
    start[low_at(i)] = vec4f(after.low, 0.0);
    if RESIDUES {
        start[RESIDUE_REGION * step.spheres + i] = residues;
    }
    return spin;
}

@compute @workgroup_size(256)
fn kick(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    var i = wide_thread(group, groups, local);
    if is_early() {
        i = sent_sphere(i);
    }
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    let spin = kick_sphere(i, load_of(i));
    if is_early() {
        return;
    }
    if !LATE_TURN {
        turn_by(i, rotation(spin));
    }
    if i == 0u {
        // The rates belong to the new state.
        status.forces_due = 0u;
    }
}
