// requires model/entries.wgsl model/step.wgsl

// Collisions of the step as they are listed: ROWS rows of a buffer each, floats by their bits, for ids are no floats
// (docs/physics.md sections 3.5 to 3.7).
//
//     0      n, approach velocity
//     1      id of A, entry of B, parameter on A, on B
//     2      of a lone collision: n at its time of contact; of one that shares bodies: GATHERED_* and ONLY bits, by how much a unit of its
//            own impulse changes its approach velocity, and how many neighbours are written below
//     3      impulse after an even number of sweeps, after an odd one, 1 / weight, and the state: the time of contact of a lone
//            collision (not negative), SHARED or SINGLE
//     4..8   before it is weighed: what a network adds to the weight at end 1 and 2 of A, at end 1 and 2 of B, and how many
//            collisions touch that network; of what is no free rod end 1 has it all
//     4..12  after that: NEIGHBOURS other collisions of its bodies, number and coupling each: by how much a unit of their impulse
//            changes its approach velocity

const ROWS: u32 = COLLISION_WORDS / 4u;
const NEIGHBOURS: u32 = 2u * (ROWS - 4u);

// States of a collision that is not lone: another one shares a body with it, or none.
const SHARED: f32 = -1.0;
const SINGLE: f32 = -2.0;

// The changes of side A, or B, are gathered body by body, not from neighbours.
const GATHERED_A: u32 = 1u;
const GATHERED_B: u32 = 2u;
// No other collision touches its bodies.
const ONLY: u32 = 4u;

// Where a row of a record stands: beside the same row of its neighbours in memory, which are mostly read together.
fn row_at(r: u32, row: u32) -> u32 {
    return row * step.collision_room + r;
}

struct Record {
    n: vec3f,
    approach: f32,
    a_id: u32,
    b_id: u32,
    feature: u32,
    a: f32,
    b: f32,
}

// What networks add to the weight of a collision at an end and the next, each with how many collisions touch the network.
fn network_weights(r: u32, end: u32) -> vec4f {
    return bitcast<vec4f>(vec4u(collisions[row_at(r, 4u + end)].xy, collisions[row_at(r, 5u + end)].xy));
}

// How the impulse of a collision goes on.
struct Impulse {
    even: f32,
    odd: f32,
    inverse: f32,
    tau: f32,
}

fn record_at(r: u32) -> Record {
    let first = bitcast<vec4f>(collisions[row_at(r, 0u)]);
    let second = collisions[row_at(r, 1u)];
    let at = bitcast<vec2f>(second.zw);
    return Record(first.xyz, first.w, second.x, entry_id(second.y), entry_feature(second.y), at.x, at.y);
}

fn impulse_at(r: u32) -> Impulse {
    let row = bitcast<vec4f>(collisions[row_at(r, 3u)]);
    return Impulse(row.x, row.y, row.z, row.w);
}

// The normal along which the impulse acts.
fn impulse_normal(r: u32) -> vec3f {
    let is_lone = bitcast<f32>(collisions[row_at(r, 3u)].w) >= 0.0;
    return bitcast<vec4f>(select(collisions[row_at(r, 0u)], collisions[row_at(r, 2u)], is_lone)).xyz;
}

// The impulse that so many sweeps have come to.
fn impulse_after(r: u32, sweeps: u32) -> f32 {
    let row = collisions[row_at(r, 3u)];
    return bitcast<f32>(select(row.y, row.x, (sweeps & 1u) == 0u));
}

// Records that there are. The room is asked for as well: a step that has more is void.
fn listed_records() -> u32 {
    return min(atomicLoad(&status.listed), step.collision_room);
}
