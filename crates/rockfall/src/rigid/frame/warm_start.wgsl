// requires rigid/frame/rows.wgsl

// The warm start (docs/physics section 11.8): what each block adds, and the sum of it for a body.

fn put_load(k: u32, block: Block) {
    let apart = between(block.a, block.b);
    var impulse = vec3f(0.0);
    var moment_a = vec3f(0.0);
    var moment_b = vec3f(0.0);
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let face = face_at(pair);
        let one = tangent_one(face.normal);
        let two = tangent_two(face.normal);
        for (var point = face.first; point < face.first + count_of(face); point++) {
            let kept = contacts[2u * point + 1u];
            if kept.x > 0.0 {
                let arm = contacts[2u * point].xyz;
                let own = kept.x * face.normal + kept.y * one + kept.z * two;
                impulse += own;
                moment_a -= cross(arm, own);
                moment_b += cross(arm - apart, own);
            }
        }
    }
    loads[LOAD_ROWS * k] = vec4f(impulse, 0.0);
    loads[LOAD_ROWS * k + 1u] = vec4f(moment_a, 0.0);
    loads[LOAD_ROWS * k + 2u] = vec4f(moment_b, 0.0);
}

// The motion of a body with the loads of its blocks.
fn gathered(body: u32, mass: Mass, motion: Motion) -> Motion {
    var impulse = vec3f(0.0);
    var moment = vec3f(0.0);
    let end = lists[body + 1u];
    for (var entry = lists[body]; entry < end; entry++) {
        let listed = lists[frame.bodies + 1u + entry];
        let side = listed & 1u;
        let at = LOAD_ROWS * (listed >> 1u);
        impulse += select(-1.0, 1.0, side == 1u) * loads[at].xyz;
        moment += loads[at + 1u + side].xyz;
    }
    return Motion(motion.velocity + mass.inverse * impulse, motion.spin + respond(mass, moment));
}

// What the blocks add to the first warm start of a frame. What they add to later ones is formed by the relax pass.
@compute @workgroup_size(THREADS)
fn load(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks {
        put_load(k, block_at(k));
    }
}
