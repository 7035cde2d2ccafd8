// requires rigid/frame/places.wgsl rigid/frame/rows.wgsl rigid/frame/search.wgsl rigid/frame/states.wgsl

// The spare gaps of round pairs before the biased pass (docs/physics section 11.7): a body that passes is not deflected.

@compute @workgroup_size(THREADS)
fn spare_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k >= frame.blocks {
        return;
    }
    let block = block_at(k);
    let start = max(clock_of(block.a), clock_of(block.b));
    let rest = frame.h - start;
    let a = motion_of(block.a);
    let b = motion_of(block.b);
    let apart = place_of(block.b) - place_of(block.a);
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let face = face_at(pair);
        if (face.info & ROUND) == 0u {
            continue;
        }
        var found = Search(Place(), false, 0.0, 0.0, 3e38);
        var is_searched = false;
        for (var point = face.first; point < face.first + count_of(face); point++) {
            let row = contacts[2u * point];
            let u = dot(a.velocity + cross(a.spin, row.xyz) - b.velocity - cross(b.spin, row.xyz - apart), face.normal);
            var spare = 0.0;
            if row.w > 0.0 && u * rest > row.w {
                if !is_searched {
                    is_searched = true;
                    found = search(block, pair, start, true, 0.0);
                }
                spare = select(max(found.least - row.w + u * rest, 0.0), 0.0, found.touches);
            }
            contacts[2u * point + 1u].w = spare;
        }
    }
}
