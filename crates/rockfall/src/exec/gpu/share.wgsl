// Copies the state of some spheres to and from rows of words, for processes that share a scene (share.rs). All numbers are copied as
// words, so that no bit changes.

struct Share {
    // Number of spheres in memory.
    spheres: u32,
    // Where the slots of the insertion indices begin in `topology`, or 0 if both are the same.
    slots_at: u32,
    // Number of rows of this dispatch.
    count: u32,
    // 1 with velocity Verlet. Then a row has velocity, angular momentum, acceleration and torque. Otherwise it has the position, its low part,
    // velocity and angular momentum.
    is_verlet: u32,
    // The axis along which spheres are divided.
    axis: u32,
    // How far a sphere may move along it, in units.
    room: f32,
    // Time step in s.
    dt: f32,
    // The word of `status` that counts the steps of the present call.
    steps_at: u32,
}

@group(0) @binding(0) var<uniform> share: Share;
@group(0) @binding(1) var<storage, read_write> state: array<vec4u>;
@group(0) @binding(2) var<storage, read_write> topology: array<u32>;
@group(0) @binding(3) var<storage, read_write> rates: array<u32>;
// Insertion index of the sphere of each row.
@group(0) @binding(4) var<storage, read_write> indices: array<u32>;
// The rows; for `look`, the place of each sphere along the axis when spheres were divided.
@group(0) @binding(5) var<storage, read_write> words: array<u32>;
// 1 if a sphere may leave its room.
@group(0) @binding(6) var<storage, read_write> is_far: atomic<u32>;
@group(0) @binding(7) var<storage, read_write> status: array<u32>;

const ROW_WORDS: u32 = 12u;
const RATE_WORDS: u32 = 6u;

// A thread in a dispatch of several rows of workgroups.
struct Thread {
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
}

fn row_of(thread: Thread) -> u32 {
    return (thread.group.y * thread.groups.x + thread.group.x) * 256u + thread.local;
}

fn slot_of(index: u32) -> u32 {
    if share.slots_at == 0u {
        return index;
    }
    return topology[share.slots_at + index];
}

// The region of the state that has a part of the motion. The low parts of positions are the last region.
fn region_of(part: u32) -> u32 {
    return array(0u, 3u, 1u, 2u)[part];
}

fn vector_in(at: u32) -> vec3u {
    return vec3u(words[at], words[at + 1u], words[at + 2u]);
}

@compute @workgroup_size(256)
fn take(thread: Thread) {
    let row = row_of(thread);
    if row >= share.count {
        return;
    }
    var at = row * ROW_WORDS;
    let slot = slot_of(indices[row]);
    for (var part = 2u * share.is_verlet; part < 4u; part++) {
        let vector = state[region_of(part) * share.spheres + slot];
        words[at] = vector.x;
        words[at + 1u] = vector.y;
        words[at + 2u] = vector.z;
        at += 3u;
    }
    for (var word = 0u; word < RATE_WORDS * share.is_verlet; word++) {
        words[at + word] = rates[indices[row] * RATE_WORDS + word];
    }
}

// Nothing is put where the step was rejected: it is repeated, and begins with the copies as they are.
@compute @workgroup_size(256)
fn put(thread: Thread) {
    let row = row_of(thread);
    if (row >= share.count) | (status[share.steps_at] == 0u) {
        return;
    }
    var at = row * ROW_WORDS;
    let slot = slot_of(indices[row]);
    for (var part = 2u * share.is_verlet; part < 4u; part++) {
        let place = region_of(part) * share.spheres + slot;
        state[place] = vec4u(vector_in(at), state[place].w);
        at += 3u;
    }
    for (var word = 0u; word < RATE_WORDS * share.is_verlet; word++) {
        rates[indices[row] * RATE_WORDS + word] = words[at + word];
    }
}

// Looks for spheres that are too far from where they were when spheres were divided, also at the next evaluation of forces: with
// velocity Verlet after a drift, otherwise at once.
@compute @workgroup_size(256)
fn look(thread: Thread) {
    let row = row_of(thread);
    if row >= share.count {
        return;
    }
    let slot = slot_of(indices[row]);
    let place = bitcast<f32>(state[slot][share.axis]);
    var drift = 0.0;
    if share.is_verlet != 0u {
        let rate = bitcast<f32>(rates[indices[row] * RATE_WORDS + share.axis]);
        drift = abs((bitcast<f32>(state[share.spheres + slot][share.axis]) + 0.5 * share.dt * rate) * share.dt);
    }
    // Not `>`, so that NaN is far, too.
    if !(abs(place - bitcast<f32>(words[row])) + drift <= share.room) {
        atomicStore(&is_far, 1u);
    }
}
