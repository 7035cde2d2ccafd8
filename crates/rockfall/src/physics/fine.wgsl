// requires model/step.wgsl physics/period.wgsl

// Positions as the sum of a high and a low part (docs/physics section 5.8). Each component of `low` is at most half of the distance
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

// The rounded products of components, and their rounding errors (Dekker 1971). Products of halves are exact.
fn product_of(a: vec3f, b: vec3f) -> Fine {
    let product = kept(a * b);
    let a_high = upper_half(a);
    let b_high = upper_half(b);
    let a_low = kept(a - a_high);
    let b_low = kept(b - b_high);
    let rest = kept(kept(a_high * b_high) - product);
    return Fine(product, kept(kept(rest + a_high * b_low) + a_low * b_high) + a_low * b_low);
}

// The sum of a position and a vector.
fn fine_moved(place: Fine, by: vec3f) -> Fine {
    let sum = sum_of(place.high, by);
    let low = kept(sum.low + place.low);
    // `sum.high` is the larger of the two, so three operations are enough (Dekker 1971).
    let high = kept(sum.high + low);
    return Fine(high, kept(low - kept(high - sum.high)));
}

fn fine_sum(a: Fine, b: Fine) -> Fine {
    return fine_moved(fine_moved(a, b.low), b.high);
}

// The position of a sphere.
fn fine_position(sphere: u32) -> Fine {
    return Fine(state[position_at(sphere)].xyz, state[low_at(sphere)].xyz);
}

// The vector from a point to the centre of a sphere.
fn fine_from(point: vec3f, sphere: u32) -> Fine {
    let place = fine_position(sphere);
    let high = sum_of(place.high, -point);
    return fine_moved(high, place.low);
}

// The vector from the centre of sphere a to that of sphere b. The difference of the high parts is exact where the spheres are near each
// other (Sterbenz 1974).
fn fine_apart(a: u32, b: u32) -> Fine {
    let from_ = fine_position(a);
    let to = fine_position(b);
    return fine_moved(sum_of(to.high, -from_.high), to.low - from_.low);
}

// The displacement of the box above in a sheared scene, from the upper 48 digits of its phase.
fn fine_slide() -> Fine {
    let phase = shear_phase();
    let length = periods() * along(step.shear_axes >> 2u);
    let upper = product_of(length, vec3f(1.52587890625e-5 * f32(bitcast<i32>(phase.y) >> 16u)));
    let middle = product_of(length, vec3f(2.3283064365386963e-10 * f32(phase.y & 0xffffu)));
    let lower = length * (3.552713678800501e-15 * f32(phase.x >> 16u));
    return fine_moved(fine_moved(fine_moved(upper, middle.high), middle.low), lower);
}

// A vector without some whole periods, and what as many boxes slid.
fn without_periods(d: Fine, count: vec3f) -> Fine {
    let way = product_of(count, periods());
    let rest = fine_moved(fine_moved(d, -way.high), -way.low);
    if SHEARED {
        let boxes = dot(count, along(step.shear_axes & 3u));
        let slid = fine_slide();
        let part = product_of(vec3f(boxes), slid.high);
        return fine_moved(fine_moved(rest, -part.high), -(part.low + boxes * slid.low));
    }
    return rest;
}

// The vector from the centre of sphere a to the nearest image of that of sphere b.
fn fine_between(a: u32, b: u32) -> Fine {
    let apart = fine_apart(a, b);
    if PERIODIC {
        return without_periods(apart, whole_periods(apart.high));
    }
    return apart;
}

// The vector from a corner of a box or polygon to the image of the centre of a sphere that is nearest to the middle of the shape.
// `to_middle` leads from the corner to the middle.
fn fine_from_corner(corner: vec3f, to_middle: vec3f, sphere: u32) -> Fine {
    let apart = fine_from(corner, sphere);
    if PERIODIC {
        return without_periods(apart, whole_periods(apart.high - to_middle));
    }
    return apart;
}

// The vector from the centre of sphere a to the nearest image of that of sphere b.
fn between(a: u32, b: u32) -> vec3f {
    if DOUBLE {
        return fine_between(a, b).high;
    }
    return state[position_at(b)].xyz - state[position_at(a)].xyz;
}

// What is left of the length of a vector beyond the digits of `length`, from the difference of the squares.
fn length_beyond(v: Fine, length: f32) -> f32 {
    let squares = product_of(v.high, v.high);
    let square = product_of(vec3f(length), vec3f(length));
    let one = sum_of(vec3f(squares.high.x), vec3f(squares.high.y));
    let two = sum_of(one.high, vec3f(squares.high.z));
    let rest = sum_of(two.high, -square.high);
    let errors = squares.low.x + squares.low.y + squares.low.z - square.low.x + one.low.x + two.low.x + rest.low.x;
    return 0.5 * (rest.high.x + (errors + 2.0 * dot(v.high, v.low))) / length;
}

// Slack of tests for close spheres, as a factor on a squared distance. It makes these tests accept every pair that the exact
// test accepts. Otherwise the result for a pair would depend on whether its entry has a bit, and bits are lost when lists are
// rebuilt.
const SLACK: f32 = 1.00001;

// Bound for what the low parts of positions, which these tests leave out, and the rounding of differences and whole periods add to a
// distance, as a part of the largest coordinate.
const LOW_PARTS: f32 = 1e-6;

fn largest_coordinate(place: vec4f) -> f32 {
    let size = abs(place.xyz);
    return max(max(size.x, size.y), size.z);
}
