// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl rigid/frame/gather.wgsl rigid/frame/past.wgsl rigid/frame/colours.wgsl

// Blocks keep the colours of the last frame; others wait for one, and those of hubs are left over.

const HUB: u32 = 64u;
// Blocks keep colours below this one. Others look for a smaller colour in each frame.
const KEPT: u32 = 8u;

fn own_number(body: u32) -> u32 {
    return body - max(home_of(body), 1u) + 1u;
}

fn is_crowded(body: u32, is_near: bool) -> bool {
    let all = list_start(body + 1u) - list_start(body);
    return has_mass(body) && (atomicLoad(&marks[2u * body + 1u]) > HUB || (!is_near && all > HUB));
}

fn old_colour(both: vec2u) -> u32 {
    let owner = owner_of(both);
    for (var q = old_starts[owner]; q < old_starts[owner + 1u]; q++) {
        if all(old_pairs[2u * q].zw == both) {
            return old_pairs[2u * q + 1u].y;
        }
    }
    return LEFT_OVER;
}

// Of the numbers that bodies have in their own world.
fn spread(both: vec2u) -> u32 {
    let own = vec2u(own_number(both.x), own_number(both.y));
    var x = (own.x * 0x9e3779b9u) ^ (own.y * 0x85ebca6bu);
    x = (x ^ (x >> 16u)) * 0x85ebca6bu;
    x = (x ^ (x >> 13u)) * 0xc2b2ae35u;
    return x ^ (x >> 16u);
}

@compute @workgroup_size(THREADS)
fn keep(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k >= block_count() {
        return;
    }
    let both = raw[BLOCK_ROWS * k].xy;
    let is_near = raw[BLOCK_ROWS * k + 1u].w == 1u;
    ranks[k] = select(0x80000000u, 0u, is_near) | (spread(both) >> 1u);
    var state = LEFT_OVER;
    if !(is_crowded(both.x, is_near) || is_crowded(both.y, is_near)) {
        state = LEFT_OVER | WAITING;
        let colour = old_colour(both);
        if colour < KEPT {
            state = colour;
        }
    }
    atomicStore(&states[k], state);
}
