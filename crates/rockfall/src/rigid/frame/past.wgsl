// requires

// What is kept from frame to frame (docs/physics section 11.5).
//
// | array | entry |
// |---|---|
// | `old_starts` | of each body the first pair that it owned, and the end |
// | `old_pairs` | 2 rows: colliders (2), a, b; points, colour of its block, normal impulse of its impacts, 0 |
// | `old_points` | 2 rows: l_A, id; T along the axes of the world, N. Four points for each pair |

@group(0) @binding(34) var<storage, read_write> old_starts: array<u32>;
@group(0) @binding(35) var<storage, read_write> old_pairs: array<vec4u>;
@group(0) @binding(36) var<storage, read_write> old_points: array<vec4u>;
