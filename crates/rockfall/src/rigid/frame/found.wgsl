// requires rigid/frame/rows.wgsl

// The manifolds of a frame in order (docs/physics section 11.5): by the body that owns them, its partner, and the colliders. Of two
// bodies a < b with mass, b owns; with one, that one. So the world, on which thousands rest, owns nothing.
//
// | array | entry |
// |---|---|
// | `found` | 10 rows of a manifold: colliders (2), a, b; n in coordinates of a, info; then of each point: l_A, id; l_B, its place among those of the owner |
// | `counts` | 1: manifolds; 8: blocks that wait for a colour; from 16 on: first block of each colour, of the left-over ones, their end |
// | `owned` | of each body its first manifold, and the end |
// | `order` | manifolds by owner |
// | `sorted` | manifolds in order; bit 31 for the first of a block |
// | `tallies` | of each body its first block, and the end; then of each body the first entry of its list plus the number of blocks, and the end |

@group(0) @binding(17) var<storage, read_write> found: array<vec4u>;
@group(0) @binding(18) var<storage, read_write> counts: array<atomic<u32>>;
@group(0) @binding(19) var<storage, read_write> owned: array<u32>;
@group(0) @binding(33) var<storage, read_write> order: array<u32>;
@group(0) @binding(27) var<storage, read_write> sorted: array<u32>;
@group(0) @binding(28) var<storage, read_write> tallies: array<u32>;

const FOUND_ROWS: u32 = 10u;
const FIRST_OF_BLOCK: u32 = 0x80000000u;

fn owner_of(bodies_of_pair: vec2u) -> u32 {
    return select(bodies_of_pair.x, bodies_of_pair.y, has_mass(bodies_of_pair.y));
}

fn partner_of(bodies_of_pair: vec2u, owner: u32) -> u32 {
    return select(bodies_of_pair.x, bodies_of_pair.y, bodies_of_pair.x == owner);
}

// Manifolds of the frame; none if there was no room for all, because then the frame begins anew.
fn pair_count(room: u32) -> u32 {
    let count = atomicLoad(&counts[1]);
    return select(count, 0u, count > room);
}
