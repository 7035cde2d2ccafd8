// requires rigid/frame/rows.wgsl physics/quaternion.wgsl

// The geometry of the blocks in the present pose (docs/physics section 11.4). Round pairs turn with body a like all others.

fn refresh_block(k: u32) {
    let block = block_at(k);
    let turn_a = turn_of(block.a);
    let turn_b = turn_of(block.b);
    let apart = between(block.a, block.b);
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let at = PAIR_ROWS * pair;
        let old = face_at(pair);
        let normal = turned_vector(turn_a, bitcast<vec3f>(pairs[at + 2u].xyz));
        let one = tangent_one(normal);
        let two = tangent_two(normal);
        let old_one = tangent_one(old.normal);
        let old_two = tangent_two(old.normal);
        pairs[at] = bitcast<vec4u>(vec4f(normal, old.friction));
        if (old.info & BELT) != 0u {
            let sides = pairs[at + 3u].xy + vec2u(CONSTANT_ROWS * frame.bodies);
            let slip = turned_vector(turn_b, constants[sides.y].xyz) - turned_vector(turn_a, constants[sides.x].xyz);
            let belt = vec2f(dot(slip, one), dot(slip, two));
            pairs[at + 1u] = vec4u(bitcast<vec2u>(belt), old.first, old.info);
        }
        for (var point = old.first; point < old.first + count_of(old); point++) {
            let place_a = turned_vector(turn_a, bitcast<vec3f>(points[POINT_ROWS * point].xyz));
            let place_b = apart + turned_vector(turn_b, bitcast<vec3f>(points[POINT_ROWS * point + 1u].xyz));
            let kept = contacts[2u * point + 1u];
            let rub = kept.y * old_one + kept.z * old_two;
            contacts[2u * point] = vec4f(0.5 * (place_a + place_b), dot(place_b - place_a, normal));
            contacts[2u * point + 1u] = vec4f(kept.x, dot(rub, one), dot(rub, two), 0.0);
        }
    }
    blocks[BLOCK_ROWS * k + 1u].z = bitcast<u32>(frame.h);
}

@compute @workgroup_size(THREADS)
fn refresh(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks {
        refresh_block(k);
    }
}
