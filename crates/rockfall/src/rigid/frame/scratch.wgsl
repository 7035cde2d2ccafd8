// requires rigid/frame/rows.wgsl

// What is found of impacts with round pairs, in `loads` after the copies: of each block a row (whether it is hit, tau,
// delta, whether it may wait plus twice the number of reflections of its bodies before it was found); then of each
// point two rows: the common place from the centre of a at tau, and the gap; the normal.

fn hit_row(k: u32) -> u32 {
    return LOAD_ROWS * frame.blocks + COPY_ROWS * (frame.blocks - frame.left_over) + k;
}

fn may_wait(hit: vec4f) -> bool {
    return fract(0.5 * hit.w) != 0.0;
}

fn met_row(point: u32) -> u32 {
    return hit_row(frame.blocks) + 2u * point;
}

// The room of a pair for points.
fn room_of(face: Face) -> u32 {
    return (face.info >> 8u) & 0xffu;
}
