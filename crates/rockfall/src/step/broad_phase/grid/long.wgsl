// requires model/step.wgsl

// Long movers: a workgroup works on each. The workgroups take turns: how many long movers there are is known on the device alone.

const GROUP_SIZE: u32 = 256u;

fn long_movers() -> u32 {
    return min(cells[3], step.spheres + step.rods);
}

fn long_mover(turn: u32) -> u32 {
    return cells[step.long_at + turn];
}
