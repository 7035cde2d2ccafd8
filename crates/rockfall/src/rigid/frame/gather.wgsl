// requires rigid/frame/rows.wgsl rigid/frame/found.wgsl

// The blocks of a frame by owner and partner, and the list of each body with mass: its own blocks, then those of bodies with greater
// numbers (docs/physics section 11.5).
//
// | array | entry |
// |---|---|
// | `raw` | blocks in order of owners, rows as `blocks`; the last word is 1 for a near one |
// | `marks` | of each body: blocks of others so far; near blocks |
// | `entries` | as `lists`; the second half of what follows the starts is for blocks of others, in any order |

@group(0) @binding(9) var<storage, read_write> entries: array<u32>;
@group(0) @binding(29) var<storage, read_write> marks: array<atomic<u32>>;
@group(0) @binding(38) var<storage, read_write> raw: array<vec4u>;


fn block_count() -> u32 {
    return tallies[frame.bodies];
}

// The first entry of the list of a body, after the starts.
fn list_start(body: u32) -> u32 {
    return tallies[frame.bodies + 1u + body] - tallies[frame.bodies];
}

// Where the blocks of others in the list of a body begin.
fn others_start(body: u32) -> u32 {
    return list_start(body) + tallies[body + 1u] - tallies[body];
}

fn unordered_at(entry: u32) -> u32 {
    return frame.bodies + 1u + (arrayLength(&entries) - frame.bodies - 1u) / 2u + entry;
}

// Whether blocks wait for more rounds of colours.
fn must_wait() -> bool {
    return atomicLoad(&counts[8]) > 0u && call.biased == 0u;
}

fn bodies_of(pair: u32) -> vec2u {
    return pairs[PAIR_ROWS * pair + 3u].zw;
}

// Gathers the pairs of a block and marks where its chunks begin. Returns the number of pairs, whether it is elastic and near, and the
// number of pairs in which a ball may be hidden.
fn gather_pairs(first: u32, end: u32, both: vec2u) -> vec4u {
    var gathered = vec4u(0u);
    var filled = 0u;
    for (var pair = first; pair < end; pair++) {
        if any(bodies_of(pair) != both) {
            break;
        }
        let info = pairs[PAIR_ROWS * pair + 1u].w;
        let room = (info >> 8u) & 0xffu;
        filled += room;
        let opens = pair == first || filled > 4u;
        filled = select(filled, room, opens);
        pairs[PAIR_ROWS * pair + 1u].w = (info & ~OPENS) | select(0u, OPENS, opens);
        gathered.x++;
        gathered.y |= u32(bitcast<f32>(pairs[PAIR_ROWS * pair + 2u].w) > 0.0);
        gathered.z |= u32((info & NEAR) != 0u);
        gathered.w += u32((info & BALL) != 0u);
    }
    return gathered;
}

@compute @workgroup_size(THREADS)
fn gather(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let p = thread_of(group, groups, local);
    let count = pair_count(arrayLength(&sorted));
    if p >= count || sorted[p] < FIRST_OF_BLOCK {
        return;
    }
    let both = bodies_of(p);
    let owner = owner_of(both);
    let partner = partner_of(both, owner);
    let gathered = gather_pairs(p, count, both);
    var own = 0u;
    for (var q = p; q > 0u; q--) {
        if owner_of(bodies_of(q - 1u)) != owner {
            break;
        }
        own += sorted[q - 1u] >> 31u;
    }
    let k = tallies[owner] + own;
    let fixed = !(has_mass(both.x) && has_mass(both.y));
    let flags = select(0u, FIXED, fixed) | select(0u, ELASTIC, gathered.y == 1u)
        | select(0u, SEAMS, fixed && gathered.w > 1u);
    raw[BLOCK_ROWS * k] = vec4u(both, p, gathered.x);
    raw[BLOCK_ROWS * k + 1u] = vec4u(4u * p, min(4u * gathered.x, 0xffffu) | flags, bitcast<u32>(frame.h), gathered.z);
    entries[frame.bodies + 1u + list_start(owner) + own] = 2u * k + u32(owner == both.y);
    atomicAdd(&marks[2u * owner + 1u], gathered.z);
    if has_mass(partner) {
        atomicAdd(&marks[2u * partner + 1u], gathered.z);
        entries[unordered_at(others_start(partner) + atomicAdd(&marks[2u * partner], 1u))] = k;
    }
}
