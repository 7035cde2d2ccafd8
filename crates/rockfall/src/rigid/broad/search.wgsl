// requires

// The arrays of the search for contacts, and the grids (docs/physics section 11.3). `rigid/gpu/search.rs` makes them.
//
// | array | what it has |
// |---|---|
// | `bounds` | two rows for each collider: least corner of its grown AABB, key; greatest corner, key |
// | `cells` | of each slot of a table of hashed cells: first the number of its colliders, then where they start, then where they end |
// | `members` | colliders in the order of their slots; after as many words as there are colliders: the large ones |
// | `candidates` | pairs of colliders whose AABBs overlap and that may touch; LEFT: two boxes left to the general pair |
// | `found` | ten rows for each manifold: colliders a and b, bodies a and b; normal in coordinates of body a, info; four points as in `points` |
// | `counts` | candidates, manifolds, levels in use (bits), large colliders. The first two go on beyond the room |
// | `owned` | of each body the number of manifolds that it owns |
// | `scales` | of each body the factor of its margin |
//
// A collider lies in the cell of the middle of its AABB, in the grid of its level. The cells of level l have the edge 2^l E, and no AABB is
// larger than a cell of its level. So those of a level that overlap a box have their middles in the box grown by half a cell.

struct Search {
    // Length of a frame, in s.
    dt: f32,
    colliders: u32,
    // Slots of the table: a power of two.
    slots: u32,
    // Room for candidates and for manifolds.
    candidates: u32,
    found: u32,
    // 1 / E.
    fineness: f32,
}

@group(0) @binding(13) var<storage, read_write> bounds: array<vec4u>;
@group(0) @binding(14) var<storage, read_write> cells: array<atomic<u32>>;
@group(0) @binding(15) var<storage, read_write> members: array<u32>;
@group(0) @binding(16) var<storage, read_write> candidates: array<vec2u>;
@group(0) @binding(17) var<storage, read_write> found: array<vec4u>;
@group(0) @binding(18) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(19) var<storage, read_write> owned: array<atomic<u32>>;
@group(0) @binding(21) var<uniform> search: Search;
@group(0) @binding(22) var<storage, read> scales: array<f32>;

// Whether the scene is periodic, and whether worlds share the frame. Kernels of other scenes leave out what these need.
const PERIODIC: bool = true;
const JOINED: bool = true;

const LEVELS: u32 = 32u;
const FOUND_ROWS: u32 = 10u;
const LEFT: u32 = 0x80000000u;
// Stands for an infinite coordinate.
const FAR: f32 = 3.4e38;
// What rounding may add to a box, relative to its greatest coordinate: 2^-17. So a coordinate of a cell is at most 2^17.
const ROUNDING: f32 = 7.62939453125e-6;
// Half the range of a coordinate of a cell.
const MIDDLE: i32 = 262144;
// No key of a cell.
const LARGE: u32 = 0xffffffffu;

// The level of a box of this size; LEVELS or more if it is large. Sizes that are no numbers are large.
fn level_of(size: f32) -> u32 {
    let ratio = size * search.fineness;
    if !(ratio <= 2147483648.0) {
        return LEVELS;
    }
    return ((bitcast<u32>(max(ratio, 1.0)) + 0x7fffffu) >> 23u) - 127u;
}

// 1 / the edge of the cells of a level.
fn fineness_of(level: u32) -> f32 {
    return search.fineness * bitcast<f32>((127u - level) << 23u);
}

// A cell of a level: 19 bits of each coordinate, and 5 of the level.
fn key_of(level: u32, cell: vec3i) -> vec2u {
    let at = vec3u(cell + vec3i(MIDDLE)) & vec3u(0x7ffffu);
    return vec2u(at.x | (at.y << 19u), (at.y >> 13u) | (at.z << 6u) | (level << 25u));
}

fn level_of_key(key: vec2u) -> u32 {
    return key.y >> 25u;
}

fn cell_of_key(key: vec2u) -> vec3i {
    let at = vec3u(key.x & 0x7ffffu, (key.x >> 19u) | ((key.y & 0x3fu) << 13u), (key.y >> 6u) & 0x7ffffu);
    return vec3i(at) - vec3i(MIDDLE);
}

fn home_in_search(body: u32) -> u32 {
    if !JOINED {
        return 0u;
    }
    return home_of(body);
}

// The key of a cell in a world. Worlds that share a frame have cells of their own; where two of them have one key, the homes of the bodies
// still differ. Applied again, it gives the key of the cell back.
fn key_in_world(key: vec2u, home: u32) -> vec2u {
    if !JOINED {
        return key;
    }
    return vec2u(key.x, key.y ^ ((home * 0x9e3779b9u) >> 7u));
}

// The slot of a cell. Cells in a row along x have slots in a row.
fn slot_of(key: vec2u) -> u32 {
    var hash = ((key.x >> 19u) * 0x9e3779b9u) ^ (key.y * 0x85ebca6bu);
    hash = (hash ^ (hash >> 16u)) * 0x85ebca6bu;
    hash = (hash ^ (hash >> 13u)) * 0xc2b2ae35u;
    hash = hash ^ (hash >> 16u);
    return (hash + (key.x & 0x7ffffu)) & (search.slots - 1u);
}
