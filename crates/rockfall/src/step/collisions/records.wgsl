// requires model/entries.wgsl model/step.wgsl

// The records of the collisions of a step (docs/physics sections 3.5 to 3.7). A record has ROWS rows of four words. Floats are stored by their bits, because the rows also hold ids. The weight of a collision is
// its scale in the sweeps. Neighbours are other collisions that share a body with it. A coupling is the change of the
// approach velocity of this collision per unit of the other's impulse.
//
//     0      n; approach velocity
//     1      id of A; id of B and feature, packed like a list entry; parameter on A; parameter on B
//     2      lone collision: n at the time of contact
//            swept collision: GATHERED_* and ONLY bits; coupling with itself; number of neighbours in rows 4..12;
//            coefficient of restitution, in scenes with pairs of materials
//     3      impulse after an even number of sweeps; impulse after an odd number of sweeps; 1 / weight;
//            state: SHARED, SINGLE, or the time of contact of a lone collision, which is not negative
//     4..8   until `weigh_collisions`: a row each for end 1 of A, end 2 of A, end 1 of B, end 2 of B, which holds what a
//            network adds to the weight, how many collisions touch that network, and the projected inverse mass. Only rods
//            of free length use end 2.
//     4..12  from then on: up to NEIGHBOURS neighbours, two per row: record number; coupling

const ROWS: u32 = COLLISION_WORDS / 4u;
const NEIGHBOURS: u32 = 2u * (ROWS - 4u);

// States of a collision that is not lone: it shares a body with another collision (SHARED), or with none (SINGLE).
const SHARED: f32 = -1.0;
const SINGLE: f32 = -2.0;

// The change of velocity of side A, or of side B, is gathered from its bodies instead of the neighbours.
const GATHERED_A: u32 = 1u;
const GATHERED_B: u32 = 2u;
// No other collision touches the bodies of this one.
const ONLY: u32 = 4u;

// Index of a row of a record. Rows of the same number are contiguous, because neighbouring threads mostly read them
// together.
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

// Returns what a network adds to the weight of a record at this end, how many collisions touch that network, and the projected
// inverse mass.
fn network_weight(r: u32, end: u32) -> vec3f {
    return bitcast<vec4f>(collisions[row_at(r, 4u + end)]).xyz;
}

// Row 3 of a record.
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

// The normal along which the impulse acts: for a lone collision, that at its time of contact.
fn impulse_normal(r: u32) -> vec3f {
    let is_lone = bitcast<f32>(collisions[row_at(r, 3u)].w) >= 0.0;
    return bitcast<vec4f>(select(collisions[row_at(r, 0u)], collisions[row_at(r, 2u)], is_lone)).xyz;
}

// The impulse after this number of sweeps. That of a lone collision is not part of a cluster (docs/physics section 3.7), so it is 0 here.
// `weigh_collisions` may write the parameters of such a collision while another thread reads them for a coupling, which therefore must have no effect.
fn impulse_after(r: u32, sweeps: u32) -> f32 {
    let row = bitcast<vec4f>(collisions[row_at(r, 3u)]);
    return select(select(row.y, row.x, (sweeps & 1u) == 0u), 0.0, row.w >= 0.0);
}

// Number of records. In a step with more collisions than room, which is rejected, the number is limited to the room.
fn listed_records() -> u32 {
    return min(atomicLoad(&status.listed), step.collision_room);
}
