// requires model/step.wgsl

// Two sums of vectors, of which a team works out the terms, added up in the order of a list, as one thread would: the same bits come of
// it.

// x, y and z of a term of either sum, then how many times either is added.
var<workgroup> terms: array<f32, 8u * WORKGROUP>;
// x, y and z of either.
var<workgroup> sums: array<f32, 6>;

// All threads of the workgroup must come here, and to the next.
fn begin_sums(local: u32) {
    if local < 6u {
        sums[local] = 0.0;
    }
    workgroupBarrier();
}

// Adds the terms of so many threads. A thread a component; the others go along, for all should have as many rounds before a barrier
// (see run_steps.wgsl).
fn add_in_order(local: u32, count: u32, one: vec3f, times_one: f32, other: vec3f, times_other: f32) {
    terms[local] = one.x;
    terms[WORKGROUP + local] = one.y;
    terms[2u * WORKGROUP + local] = one.z;
    terms[3u * WORKGROUP + local] = other.x;
    terms[4u * WORKGROUP + local] = other.y;
    terms[5u * WORKGROUP + local] = other.z;
    terms[6u * WORKGROUP + local] = times_one;
    terms[7u * WORKGROUP + local] = times_other;
    workgroupBarrier();
    let component = min(local, 5u);
    let term = component * WORKGROUP;
    let times = (6u + component / 3u) * WORKGROUP;
    var sum = sums[component];
    for (var k = 0u; k < count; k++) {
        sum = fma(terms[term + k], terms[times + k], sum);
    }
    workgroupBarrier();
    if local < 6u {
        sums[local] = sum;
    }
}

// What they have come to; after a barrier.
fn first_sum() -> vec3f {
    return vec3f(sums[0], sums[1], sums[2]);
}

fn second_sum() -> vec3f {
    return vec3f(sums[3], sums[4], sums[5]);
}
