// requires model/step.wgsl

// Counts the values of a digit in a block of pairs. Each thread counts in a run of consecutive pairs of the block.

// Number of pairs in the run of a thread.
const RUN: u32 = DIGIT_BLOCK / WORKGROUP;

// The count of digit d by thread t is element d * WORKGROUP + t.
var<workgroup> counts: array<u32, DIGITS * WORKGROUP>;

fn digit_of(pair: vec2u) -> u32 {
    return (pair.x >> (pass_.index * DIGIT_BITS)) % DIGITS;
}

// Returns the index in `cells` of the count of a digit in a block. The counts of a digit are consecutive, so that the sum of
// all counts before one is the place of its first pair.
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
