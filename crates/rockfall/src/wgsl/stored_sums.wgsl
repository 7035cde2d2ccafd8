// Where row sums of collisions come from: with rods or large spheres `weigh_collisions` has stored them, entry by entry.

fn row_sum_of(pair: vec2u, slot: vec2u) -> f32 {
    if RODS | LARGE {
        return row_sums[row_of_sums(slot)][slot.y];
    }
    return plain_row_sum(pair.x, pair.y);
}
