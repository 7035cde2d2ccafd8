// requires rigid/frame/rows.wgsl rigid/frame/states.wgsl rigid/frame/scratch.wgsl

// instead of rigid/frame/times.wgsl

// The times of contact of blocks with round pairs, and the geometry at them, as `find.wgsl` has found them. In the same kernels
// for frames without round pairs, `times.wgsl` has these functions.

fn hit_of(k: u32, block: Block) -> Hit {
    let found = loads[hit_row(k)];
    return Hit(found.x != 0.0, found.y, found.z, may_wait(found));
}

fn normal_met(sight: Sight, pair: u32, first: u32) -> vec3f {
    return loads[met_row(first) + 1u].xyz;
}

fn count_met(face: Face) -> u32 {
    return room_of(face);
}

fn met(sight: Sight, normal: vec3f, point: u32) -> vec4f {
    return loads[met_row(point)];
}
