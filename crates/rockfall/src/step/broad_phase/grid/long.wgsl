// requires model/step.wgsl

// Long movers. One workgroup works on each of them. The workgroups take turns, because only the device knows the number of
// long movers.

const GROUP_SIZE: u32 = 256u;

fn long_movers() -> u32 {
    return min(cells[3], step.spheres + step.rods);
}

fn long_mover(turn: u32) -> u32 {
    return cells[step.long_at + turn];
}
