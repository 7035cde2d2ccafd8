// requires model/collision_state.wgsl model/order.wgsl model/step.wgsl physics/collision/body_impulses.wgsl
// requires physics/fine.wgsl physics/free_rotation.wgsl physics/quaternion.wgsl physics/rigid.wgsl
// requires model/objects.wgsl physics/collision/pressed.wgsl physics/rigid_lever.wgsl physics/rigid_parts.wgsl step/bodies/body_rows.wgsl step/collisions/records.wgsl step/collisions/rows.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> bodies: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> topology: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(7) var<storage, read> collisions: array<vec4u>;
@group(0) @binding(8) var<storage, read> next: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> status: StatusAtomic;

// The pose after a lone collision, which acts at its time of contact.
fn hit_at_contact(form: Form, body: u32, pose: Pose, row: u32, r: u32) -> Pose {
    let k = record_at(r);
    let impulse = impulse_at(r);
    let before = freely_turned(pose.orientation, form.moments, pose.momentum, -impulse.tau);
    let turn = multiply(before, vec4f(-pose.orientation.xyz, pose.orientation.w));
    let lever = turned_vector(turn, lever_on_body(rigid_record(body), row, at_on_row(k, row)));
    let push = select(1.0, -1.0, k.a_id == row) * impulse.even * impulse_normal(r);
    let velocity = form.inverse_mass * push;
    let momentum = pose.momentum + cross(lever, push);
    return Pose(
        fine_moved(pose.position, impulse.tau * velocity),
        pose.velocity + velocity,
        momentum,
        freely_turned(before, form.moments, momentum, impulse.tau),
    );
}

// Whether contacts get friction impulses.
fn has_friction_impulses() -> bool {
    return (step.coulomb_friction > 0.0) | (step.collision_friction > 0.0) | ((step.flags & FLAG_PAIR_FRICTION) != 0u);
}

// Counts the pressed contacts that touch a body.
fn count_pressed(body: u32, form: Form) {
    var found = 0u;
    for (var member = 0u; member < form.count; member++) {
        let sphere = id_of(topology[form.members + member]);
        let rods = rods_of(sphere);
        for (var r = 0u; r <= rods.y; r++) {
            let row = row_of_member(body, sphere, rods, r);
            if row != NONE {
                found += pressed_in(row);
            }
        }
    }
    topology[rigid_record(body) + RIGID_PRESSED] = found;
}

// The sums of the friction impulses on the spheres of a body. `number` is NONE without one, and 0 otherwise.
fn friction_kick(form: Form) -> BodyKick {
    var kick = no_kick();
    for (var member = 0u; member < form.count; member++) {
        let sphere = id_of(topology[form.members + member]);
        kick.impulse += next[step.spheres + sphere].xyz;
        kick.torque += next[2u * step.spheres + sphere].xyz;
    }
    kick.number = select(NONE, 0u, any(kick.impulse != vec3f(0.0)) | any(kick.torque != vec3f(0.0)));
    return kick;
}

fn pushed_pose(form: Form, body: u32, kick: BodyKick, is_lone: bool) -> Pose {
    let before = start_of(body);
    var pose = before;
    if is_lone {
        pose = hit_at_contact(form, body, before, kick.row, kick.number);
    } else {
        pose.velocity += form.inverse_mass * kick.impulse;
        pose.momentum += kick.torque;
    }
    if !pose_is_finite(pose) {
        atomicAdd(&status.bad_count, 1u);
        atomicMin(&status.bad_body, topology[form.members]);
        return Pose(before.position, vec3f(0.0), vec3f(0.0), before.orientation);
    }
    return pose;
}

@compute @workgroup_size(64)
fn push_bodies(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) | (atomicLoad(&status.collided) != 2u) {
        return;
    }
    let body = body_of_sphere(i);
    // It does not depend on the uniform block alone, for which software Vulkan would compile the kernel again in every dispatch.
    let kick_pass = select(pass_.index, NONE, body == NO_RIGID);
    if kick_pass == NONE {
        return;
    }
    let form = form_of(body);
    if id_of(topology[form.members]) != i {
        return;
    }
    if (kick_pass != RUBBED) & has_friction_impulses() {
        count_pressed(body, form);
    }
    if (kick_pass != RUBBED) & (atomicLoad(&status.collides) == 0u) {
        return;
    }
    var kick = no_kick();
    if kick_pass == RUBBED {
        kick = friction_kick(form);
    } else {
        kick = body_kick(body, SWEEPS);
    }
    if kick.number == NONE {
        return;
    }
    var is_lone = false;
    if kick_pass != RUBBED {
        is_lone = impulse_at(kick.number).tau >= 0.0;
    }
    put_pose(body, pushed_pose(form, body, kick, is_lone));
    put_pose_row(body, PUSHED_ROW, vec4f(0.0, 0.0, 0.0, 1.0));
}
