// requires rigid/frame/joints.wgsl

// Passes over joints of mechanisms that are not connected to each other. A workgroup has the joints of some mechanisms, and no other one
// has their bodies. So all colours and both visits are one dispatch (docs/physics section 11.14).
//
// `joint_order` begins with a table here: of each group the first entry of each colour, and the end. `call.colour` is the number of groups,
// and `call.biased` that of the colours.

fn visit_colour(group: u32, colour: u32, local: u32, biased: bool, is_first: bool) {
    let at = (call.biased + 1u) * group + colour;
    for (var k = joint_order[at] + local; k < joint_order[at + 1u]; k += THREADS) {
        solve_joint(joint_order[k], biased, is_first);
    }
}

// There and back again; the relax pass begins at the end.
fn visit_twice(group: u32, local: u32, biased: bool) {
    for (var step = 0u; step < 2u * call.biased; step++) {
        let is_first = step < call.biased;
        let there = select(2u * call.biased - 1u - step, step, is_first);
        visit_colour(group, select(call.biased - 1u - there, there, biased), local, biased, is_first);
        storageBarrier();
    }
}

fn group_of(group: vec3u, groups: vec3u) -> u32 {
    return group.x + group.y * groups.x;
}

@compute @workgroup_size(THREADS)
fn push_groups(@builtin(workgroup_id) id: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let group = group_of(id, groups);
    if group < call.colour {
        visit_twice(group, local, true);
    }
}

@compute @workgroup_size(THREADS)
fn relax_groups(@builtin(workgroup_id) id: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let group = group_of(id, groups);
    if group < call.colour {
        visit_twice(group, local, false);
    }
}

@compute @workgroup_size(THREADS)
fn warm_groups(@builtin(workgroup_id) id: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let group = group_of(id, groups);
    if group >= call.colour {
        return;
    }
    for (var colour = 0u; colour < call.biased; colour++) {
        let at = (call.biased + 1u) * group + colour;
        for (var k = joint_order[at] + local; k < joint_order[at + 1u]; k += THREADS) {
            warm_joint(joint_order[k]);
        }
        storageBarrier();
    }
}
