// requires model/step.wgsl

// A digit of the keys of a block of pairs: each thread has a run of them, and counts for itself.

const RUN: u32 = DIGIT_BLOCK / WORKGROUP;

// Of digit d and thread t at d * WORKGROUP + t.
var<workgroup> counts: array<u32, DIGITS * WORKGROUP>;

fn digit_of(pair: vec2u) -> u32 {
    return (pair.x >> (pass_.index * DIGIT_BITS)) % DIGITS;
}

// The word of `cells` for a digit and a block: digit by digit, so that the sums of all before it are where the pairs go.
fn digit_at(digit: u32, block: u32) -> u32 {
    return CELLS_AT + digit * ((step.spheres + DIGIT_BLOCK - 1u) / DIGIT_BLOCK) + block;
}

fn count_run(block: u32, local: u32) {
    for (var digit = 0u; digit < DIGITS; digit++) {
        counts[digit * WORKGROUP + local] = 0u;
    }
    let first = block * DIGIT_BLOCK + local * RUN;
    for (var k = first; k < min(first + RUN, step.spheres); k++) {
        counts[digit_of(pairs[k]) * WORKGROUP + local] += 1u;
    }
    workgroupBarrier();
}
