// Long movers: a workgroup looks around for each, and its threads share out the rows of cells, TEAM_ACROSS by TEAM_ACROSS.

const TEAM: u32 = 256u;
const TEAM_ACROSS: i32 = 16;

fn share_of(local: u32) -> Share {
    return Share(i32(local) % TEAM_ACROSS, i32(local) / TEAM_ACROSS, TEAM_ACROSS);
}

// The workgroups take turns: how many long movers there are is known on the device alone.
fn long_movers() -> u32 {
    return cells[3];
}

fn long_mover(turn: u32) -> u32 {
    return cells[step.long_at + turn];
}
