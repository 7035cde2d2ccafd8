// requires model/step.wgsl

// Positions as the sum of a high and a low part (docs/physics.md section 5.8). Each component of `low` is at most half of the distance
// of neighbouring f32 numbers at that of `high`.
struct Fine {
    high: vec3f,
    low: vec3f,
}

// The same numbers, hidden from the compiler. Compilers may rearrange sums as if they were not rounded. They would compute the rounding
// errors below as 0.
fn kept(v: vec3f) -> vec3f {
    return bitcast<vec3f>(bitcast<vec3u>(v) ^ vec3u(pass_.zero));
}

// The rounded sum of two vectors, and its rounding error (Knuth 1969).
fn sum_of(a: vec3f, b: vec3f) -> Fine {
    let sum = kept(a + b);
    let share_of_b = kept(sum - a);
    let share_of_a = kept(sum - share_of_b);
    return Fine(sum, kept(a - share_of_a) + kept(b - share_of_b));
}

// The upper half of the digits of each component.
fn upper_half(v: vec3f) -> vec3f {
    return bitcast<vec3f>(bitcast<vec3u>(v) & vec3u(0xfffff000u));
}

// A number times a vector: the rounded product, and its rounding error (Dekker 1971). Products of halves are exact.
fn product_of(s: f32, v: vec3f) -> Fine {
    let factor = vec3f(s);
    let product = kept(factor * v);
    let s_high = upper_half(factor);
    let v_high = upper_half(v);
    let s_low = kept(factor - s_high);
    let v_low = kept(v - v_high);
    let rest = kept(kept(s_high * v_high) - product);
    return Fine(product, kept(kept(rest + s_high * v_low) + s_low * v_high) + s_low * v_low);
}

// The sum of a position and a vector.
fn moved(place: Fine, by: vec3f) -> Fine {
    let sum = sum_of(place.high, by);
    let low = kept(sum.low + place.low);
    // `sum.high` is the larger of the two, so three operations are enough (Dekker 1971).
    let high = kept(sum.high + low);
    return Fine(high, kept(low - kept(high - sum.high)));
}

fn fine_sum(a: Fine, b: Fine) -> Fine {
    return moved(moved(a, b.low), b.high);
}

// The position of a sphere.
fn fine_position(sphere: u32) -> Fine {
    return Fine(state[position_at(sphere)].xyz, state[low_at(sphere)].xyz);
}

// The vector from a point to the centre of a sphere.
fn fine_from(point: vec3f, sphere: u32) -> Fine {
    let place = fine_position(sphere);
    let high = sum_of(place.high, -point);
    return moved(high, place.low);
}

// The vector from the centre of sphere a to that of sphere b, rounded. The difference of the high parts is exact where the spheres are
// near each other (Sterbenz 1974).
fn fine_between(a: u32, b: u32) -> vec3f {
    let from_ = fine_position(a);
    let to = fine_position(b);
    let high = sum_of(to.high, -from_.high);
    return high.high + (high.low + (to.low - from_.low));
}
