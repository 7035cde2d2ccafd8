// requires model/step.wgsl physics/fine.wgsl

// Residues: what rounding leaves of the velocity and the angular momentum of a body (docs/physics section 5.10).

// 2^-41: a residue is a multiple of this times the greatest power of 2 that its number reaches.
const RESIDUE_DIGITS: f32 = 4.547473508864641e-13;
// Greatest size of the multiple, which has 19 bits.
const MOST_RESIDUE: f32 = 262143.0;
// Bits of each word of a row of residues, which make it a finite number whose bits no device changes.
const FINITE_WORD: u32 = 0x40000000u;

// A velocity and an angular momentum after an increment, and the row of their residues.
struct Increased {
    velocity: vec3f,
    momentum: vec3f,
    residues: vec4f,
}

// The exponent bits of each component, which are the greatest power of 2 that its size reaches.
fn exponents(number: vec3f) -> vec3u {
    return bitcast<vec3u>(number) & vec3u(0x7f800000u);
}

// The residues of a vector as multiples.
fn multiples_of(number: Fine) -> vec3u {
    let inverse = bitcast<vec3f>(vec3u(0x7f000000u) - exponents(number.high));
    let multiples = round((number.low * inverse) / RESIDUE_DIGITS);
    return bitcast<vec3u>(vec3i(clamp(multiples, vec3f(-MOST_RESIDUE), vec3f(MOST_RESIDUE)))) & vec3u(0x7ffffu);
}

fn packed_residues(velocity: Fine, momentum: Fine) -> vec4f {
    let of_velocity = multiples_of(velocity);
    let of_momentum = multiples_of(momentum);
    let words = (of_velocity << vec3u(10u)) | (of_momentum & vec3u(0x3ffu)) | vec3u(FINITE_WORD);
    let upper = of_momentum >> vec3u(10u);
    return bitcast<vec4f>(vec4u(words, FINITE_WORD | (upper.x << 18u) | (upper.y << 9u) | upper.z));
}

// A vector with its residues. None exceeds a unit in the last place, also where an impulse has changed the vector since.
fn with_residues(high: vec3f, multiples: vec3u) -> Fine {
    let signed = bitcast<vec3i>(multiples << vec3u(13u)) >> vec3u(13u);
    return Fine(high, vec3f(signed) * (bitcast<vec3f>(exponents(high)) * RESIDUE_DIGITS));
}

// The sum of a vector with residues and an increment. In the drift of velocity Verlet its high part does not depend on the residues, so
// a process that has a copy of a body without them computes the same.
fn incremented(number: Fine, by: vec3f, is_drift: bool) -> Fine {
    if is_drift {
        let sum = sum_of(number.high, by);
        return Fine(sum.high, sum.low + number.low);
    }
    return fine_moved(number, by);
}

// Adds increments to a velocity and an angular momentum with a row of residues.
fn increased(
    velocity: vec3f,
    momentum: vec3f,
    residues: vec4f,
    by_velocity: vec3f,
    by_momentum: vec3f,
    is_drift: bool,
) -> Increased {
    if RESIDUES {
        let words = bitcast<vec4u>(residues);
        let upper = (vec3u(words.w) >> vec3u(18u, 9u, 0u)) & vec3u(0x1ffu);
        let of_velocity = (words.xyz >> vec3u(10u)) & vec3u(0x7ffffu);
        let of_momentum = (words.xyz & vec3u(0x3ffu)) | (upper << vec3u(10u));
        let v = incremented(with_residues(velocity, of_velocity), by_velocity, is_drift);
        let l = incremented(with_residues(momentum, of_momentum), by_momentum, is_drift);
        return Increased(v.high, l.high, packed_residues(v, l));
    }
    return Increased(velocity + by_velocity, momentum + by_momentum, residues);
}
