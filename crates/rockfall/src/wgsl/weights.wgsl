// How much each of many collisions of one body weighs (physics.md section 3): s_k is 1 over a row sum. Where there are no rods
// both sides of a contact work it out, by the same sums in the same order.

// Row sum up to which nothing else presses, so that the overlap may be removed.
const ALONE: f32 = 1.001;

// Sums of |G_kl| / sqrt(G_kk G_ll).
struct RowSums {
    colliding: f32,
    overlapping: f32,
}

fn add_term(term: f32, entry: u32, sums: ptr<function, RowSums>) {
    (*sums).overlapping += term;
    if (entry & ENTRY_COLLIDES) != 0u {
        (*sums).colliding += term;
    }
}

// Adds the contacts of a plain sphere, `other` left out, coupled with a contact of normal `n` there and inverse mass G_kk.
// False where one of them is not plain.
fn add_coupled_plain(sphere: u32, other: u32, n: vec3f, inverse_mass: f32, sums: ptr<function, RowSums>) -> bool {
    let velocity = state[velocity_at(sphere)];
    if velocity.w <= 0.0 {
        return true;
    }
    let own = state[position_at(sphere)];
    let count = count_of(sphere);
    let first = first_of(sphere);
    for (var begin = 0u; begin < count; begin += LOOK) {
        var rest = entries_with(ENTRY_OVERLAPS, first, begin, count);
        var now = meet(first, begin, rest);
        while rest != 0u {
            rest &= rest - 1u;
            let ahead = meet(first, begin, rest);
            let id = entry_id(now.entry);
            if !are_plain(sphere, id) {
                return false;
            }
            let l = plain_with(sphere, own, velocity, now);
            if (id != other) & (l.overlap > 0.0) {
                add_term(velocity.w * abs(dot(n, l.n)) / (sqrt(inverse_mass) * sqrt(l.inverse_mass)), now.entry, sums);
            }
            now = ahead;
        }
    }
    return true;
}

// A row sum as one number, never 0: negative where nothing else presses, so that the overlap is to be removed.
fn signed_sum(sums: RowSums) -> f32 {
    let sum = max(sums.colliding, 1.0);
    return select(sum, -sum, sums.overlapping <= ALONE);
}

// The row sum of a plain contact among plain ones; 0 where one is not plain.
fn plain_row_sum(a: u32, b: u32) -> f32 {
    let k = plain_contact(a, b);
    var sums = RowSums(1.0, 1.0);
    if !add_coupled_plain(a, b, k.n, k.inverse_mass, &sums) {
        return 0.0;
    }
    if b < step.spheres {
        if !add_coupled_plain(b, a, k.n, k.inverse_mass, &sums) {
            return 0.0;
        }
    }
    return signed_sum(sums);
}
