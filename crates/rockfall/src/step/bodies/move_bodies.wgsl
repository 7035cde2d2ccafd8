// requires model/load_rows.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/escape.wgsl
// requires physics/fine.wgsl physics/forces/rates.wgsl physics/free_rotation.wgsl physics/quaternion.wgsl physics/residue.wgsl physics/rigid.wgsl
// requires physics/rigid_parts.wgsl step/bodies/body_rows.wgsl

// The state in which the spheres of bodies are placed.
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> bodies: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> topology: array<u32>;
@group(0) @binding(5) var<storage, read> wrenches: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> kept_rates: array<f32>;
@group(0) @binding(7) var<storage, read_write> orientations: array<vec4f>;
@group(0) @binding(8) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

// The pass. It is NONE in threads without a body: software Vulkan compiles a kernel again in every dispatch where a branch depends on a
// uniform block alone.
var<private> body_pass: u32;

// The state after the drift, in which forces are evaluated.
fn stage_of(body: u32) -> Pose {
    return Pose(
        Fine(pose_row(body, STAGE_ROW + 3u).xyz, pose_row(body, STAGE_ROW + 4u).xyz),
        pose_row(body, STAGE_ROW).xyz,
        pose_row(body, STAGE_ROW + 1u).xyz,
        pose_row(body, STAGE_ROW + 2u),
    );
}

fn put_stage(body: u32, pose: Pose) {
    put_pose_row(body, STAGE_ROW, vec4f(pose.velocity, 0.0));
    put_pose_row(body, STAGE_ROW + 1u, vec4f(pose.momentum, 0.0));
    put_pose_row(body, STAGE_ROW + 2u, pose.orientation);
    put_pose_row(body, STAGE_ROW + 3u, vec4f(pose.position.high, 0.0));
    put_pose_row(body, STAGE_ROW + 4u, vec4f(pose.position.low, 0.0));
}

// The rates of change from the loads of the members, which were evaluated in the state `pose` (docs/physics section 4.16).
fn rates_of(form: Form, pose: Pose) -> Rates {
    var force = vec3f(0.0);
    var torque = vec3f(0.0);
    for (var member = 0u; member < form.count; member++) {
        let load = load_of(id_of(topology[form.members + member]));
        force += load.force;
        torque += load.torque + cross(turned_vector(pose.orientation, place_of_member(form, member)), load.force);
    }
    return Rates(
        form.inverse_mass * force + step.gravity - step.linear_damping * pose.velocity,
        torque - step.angular_damping * pose.momentum,
    );
}

// The pose with a velocity and an angular momentum after these increments. Row `from_` has the residues before, `to` gets those after.
fn increased_pose(body: u32, from_: u32, to: u32, pose: Pose, by_velocity: vec3f, by_momentum: vec3f) -> Pose {
    var residues = vec4f(0.0);
    if RESIDUES {
        residues = pose_row(body, from_);
    }
    let new_ = increased(pose.velocity, pose.momentum, residues, by_velocity, by_momentum, false);
    if RESIDUES {
        put_pose_row(body, to, new_.residues);
    }
    return Pose(pose.position, new_.velocity, new_.momentum, pose.orientation);
}

// The state after a kick for a time and a drift for the whole step. Row `to` gets the residues after it.
fn kicked(body: u32, form: Form, start: Pose, rates: Rates, kick: f32, to: u32) -> Pose {
    var pose = increased_pose(body, RESIDUE_ROW, to, start, kick * rates.acceleration, kick * rates.torque);
    pose.orientation = freely_turned(start.orientation, form.moments, pose.momentum, step.dt);
    pose.position = fine_moved(start.position, step.dt * pose.velocity);
    return pose;
}

fn rate_at(body: u32) -> u32 {
    return RATE_WORDS * (step.spheres + body);
}

fn kept_rates_of_body(body: u32) -> Rates {
    let at = rate_at(body);
    return Rates(
        vec3f(kept_rates[at], kept_rates[at + 1u], kept_rates[at + 2u]),
        vec3f(kept_rates[at + 3u], kept_rates[at + 4u], kept_rates[at + 5u]),
    );
}

fn keep_rates(body: u32, rates: Rates) {
    let at = rate_at(body);
    for (var k = 0u; k < 3u; k++) {
        kept_rates[at + k] = rates.acceleration[k];
        kept_rates[at + 3u + k] = rates.torque[k];
    }
}

// The number of the pass in a report of a state that is not finite.
fn reported_stage() -> u32 {
    return select(1u, 2u, body_pass == AFTER_KICK);
}

// A body at rest where it was.
fn stopped_body(body: u32, form: Form) -> Pose {
    atomicAdd(&status.bad_count, 1u);
    atomicMin(&status.bad_body, (reported_stage() << BAD_STAGE_SHIFT) | topology[form.members]);
    let start = start_of(body);
    return Pose(start.position, vec3f(0.0), vec3f(0.0), start.orientation);
}

// Velocity Verlet: the second half of the kick.
fn after_kick(body: u32, form: Form) -> Pose {
    var pose = stage_of(body);
    let rates = rates_of(form, pose);
    let half = 0.5 * step.dt;
    pose = increased_pose(body, DRIFTED_ROW, RESIDUE_ROW, pose, half * rates.acceleration, half * rates.torque);
    if pose_is_finite(pose) {
        keep_rates(body, rates);
        return pose;
    }
    keep_rates(body, Rates(vec3f(0.0), vec3f(0.0)));
    return stopped_body(body, form);
}

fn moved_body(body: u32, form: Form) -> Pose {
    let start = start_of(body);
    if body_pass == AFTER_KICK {
        return after_kick(body, form);
    }
    var rates = Rates(vec3f(0.0), vec3f(0.0));
    if (body_pass == AFTER_DRIFT) & (status.forces_due == 0u) {
        rates = kept_rates_of_body(body);
    } else {
        rates = rates_of(form, start);
    }
    let is_drift = body_pass == AFTER_DRIFT;
    let residues_to = select(RESIDUE_ROW, DRIFTED_ROW, is_drift);
    let pose = kicked(body, form, start, rates, select(1.0, 0.5, is_drift) * step.dt, residues_to);
    if !pose_is_finite(pose) {
        return stopped_body(body, form);
    }
    return pose;
}

// Places the member spheres, and their orientations at the end of the step.
fn place_members(form: Form, pose: Pose, is_new: bool) {
    let spin = spin_of_body(pose.orientation, form.moments, pose.momentum);
    for (var member = 0u; member < form.count; member++) {
        let i = id_of(topology[form.members + member]);
        let lever = turned_vector(pose.orientation, place_of_member(form, member));
        let place = fine_moved(pose.position, lever);
        let radius = state[position_at(i)].w;
        let before = state[velocity_at(i)];
        let velocity = vec4f(pose.velocity + cross(spin, lever), before.w);
        let inverse_inertia = state[momentum_at(i)].w;
        state[position_at(i)] = vec4f(place.high, radius);
        state[velocity_at(i)] = velocity;
        state[momentum_at(i)] = vec4f(spin / inverse_inertia, inverse_inertia);
        if is_new | DOUBLE | VERLET {
            state[low_at(i)] = vec4f(place.low, 0.0);
        }
        if is_new {
            orientations[i] = pose.orientation;
        }
        if body_pass == AFTER_EULER {
            request_rebuild(i, vec4f(place.high, radius), velocity);
        }
    }
}

fn put_vector(at: u32, v: vec3f) {
    let bits = bitcast<vec3u>(v);
    topology[at] = bits.x;
    topology[at + 1u] = bits.y;
    topology[at + 2u] = bits.z;
}

// Writes the centre, the inverse inertia and the orientation that contacts read.
fn put_record(body: u32, form: Form, pose: Pose) {
    let record = rigid_record(body);
    put_vector(record, pose.position.high);
    var diagonal = vec3f(form.moments.middle);
    var mixed = vec3f(0.0);
    for (var k = 0u; k < 3u; k++) {
        let axis = principal_axis(pose.orientation, form.moments, k);
        diagonal += form.moments.excess[k] * axis * axis;
        mixed += form.moments.excess[k] * axis.xxy * axis.yzz;
    }
    put_vector(record + 4u, diagonal);
    put_vector(record + 7u, mixed);
    put_vector(record + 14u, pose.orientation.xyz);
    topology[record + 17u] = bitcast<u32>(pose.orientation.w);
}

@compute @workgroup_size(64)
fn move_bodies(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if i >= step.spheres {
        return;
    }
    // Neighbouring threads have neighbouring bodies, because spheres are sorted in memory.
    let body = rigid_body_of(i);
    body_pass = select(pass_.index, NONE, body == NO_RIGID);
    if body_pass == NONE {
        return;
    }
    let form = form_of(body);
    if id_of(topology[form.members]) != i {
        return;
    }
    if body_pass == BEFORE_STEP {
        let start = start_of(body);
        // In a world that was just packed, the spheres are where the CPU put them, which rounds in another way.
        place_members(form, start, true);
        put_record(body, form, start);
        return;
    }
    if atomicLoad(&status.rejected) != 0u {
        return;
    }
    let pose = moved_body(body, form);
    let is_new = body_pass >= AFTER_KICK;
    if is_new {
        put_pose(body, pose);
    } else {
        put_stage(body, pose);
    }
    place_members(form, pose, is_new);
    put_record(body, form, pose);
}
