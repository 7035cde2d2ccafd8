// requires model/step.wgsl step/large_spheres/workgroup_per_sphere.wgsl

// Two sums of vectors over a list. The threads of a workgroup compute one term each. The terms are then added in the order of
// the list, as a single thread would add them, so that the sums are bitwise identical.

// Eight rows of WORKGROUP values: x, y and z of the terms of the first sum, x, y and z of those of the second, the factors of
// the first sum, the factors of the second.
var<workgroup> terms: array<f32, 8u * LARGE_WORKGROUP>;
// x, y and z of the first sum, then of the second.
var<workgroup> sums: array<f32, 6>;

// Sets both sums to zero. All threads of the workgroup must call this function and `add_in_order`.
fn begin_sums(local: u32) {
    if local < 6u {
        sums[local] = 0.0;
    }
    workgroupBarrier();
}

// Adds the terms of the first `count` threads: `times_one * one` to the first sum and `times_other * other` to the second.
// Each of the first six threads adds up one component. The other threads run the same loop, because all threads should make
// the same number of rounds before a barrier (see sweep_at_once.wgsl).
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

// Returns the first sum. Between `add_in_order` and this call there must be a barrier.
fn first_sum() -> vec3f {
    return vec3f(sums[0], sums[1], sums[2]);
}

// Returns the second sum, under the same condition.
fn second_sum() -> vec3f {
    return vec3f(sums[3], sums[4], sums[5]);
}
