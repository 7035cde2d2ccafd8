// requires model/objects.wgsl model/step.wgsl physics/fine.wgsl

// Corrections of batches of fixed-length rods (docs/physics section 5.4). A workgroup sweeps one batch, colour by colour.
// The rods of one colour share no moving sphere, so no two threads write to the same sphere.

// Largest relative error, and maximum number of sweeps, at which the sweeps end.
const TOLERANCE: f32 = 1e-5;
const MAX_SWEEPS: u32 = 400u;

// A difference of two vectors counts as a rounding error up to this times the sum of their largest components.
const LENGTH_ROUNDING: f32 = 4.8e-7;

fn largest(v: vec3f) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

// Absolute value of an error; 0 when it is only a rounding error of the difference of two vectors.
fn without_rounding(error: f32, one: vec3f, two: vec3f) -> f32 {
    return select(abs(error), 0.0, abs(error) <= LENGTH_ROUNDING * (largest(one) + largest(two)));
}

var<workgroup> worst: atomic<u32>;
var<workgroup> go_on: u32;

struct Batch {
    colours: u32,
    // First of `colours + 1` words: the offsets at which the rods of each colour start, and the end.
    at: u32,
}

fn batch_at(index: u32) -> Batch {
    let at = topology[step.batches_at + index];
    return Batch(topology[at], at + 1u);
}

fn start_sweeps(local: u32) {
    if local == 0u {
        atomicStore(&worst, 0u);
    }
    workgroupBarrier();
}

// Whether another sweep is needed after `sweeps` sweeps. All threads of the workgroup must call it. A batch of one colour is
// exact after one sweep. Positive floats are ordered as their bits are.
fn sweep_again(local: u32, error: f32, sweeps: u32, colours: u32) -> bool {
    atomicMax(&worst, bitcast<u32>(error));
    workgroupBarrier();
    if local == 0u {
        let off = bitcast<f32>(atomicLoad(&worst)) > TOLERANCE;
        go_on = select(0u, 1u, off & (colours > 1u) & (sweeps < MAX_SWEEPS));
        atomicStore(&worst, 0u);
    }
    return workgroupUniformLoad(&go_on) != 0u;
}

// Moves the ends of a rod along its axis so that the rod has its length. Returns the relative error before the correction.
fn restore_length(rod: u32) -> f32 {
    let ends = rod_ends(rod);
    let w1 = inverse_mass(ends.x);
    let w2 = inverse_mass(ends.y);
    let sum = w1 + w2;
    if sum <= 0.0 {
        return 0.0;
    }
    let target_length = rod_length(rod);
    let one = state[position_at(ends.x)].xyz;
    let two = state[position_at(ends.y)].xyz;
    let d = between(ends.x, ends.y);
    let squared = dot(d, d);
    var n = vec3f(0.0, 1.0, 0.0);
    var distance = 0.0;
    if squared > TINY {
        distance = sqrt(squared);
        n = d / distance;
    }
    let correction = n * ((distance - target_length) / sum);
    move_end(ends.x, w1, correction);
    move_end(ends.y, -w2, correction);
    return without_rounding(distance - target_length, one, two) / target_length;
}

// Displaces an end of a rod, unless the result is not finite. A fixed sphere is not written at all, because rods of one colour
// may share it.
fn move_end(sphere: u32, weight: f32, displacement: vec3f) {
    let before = fine_position(sphere);
    let after = fine_moved(before, weight * displacement);
    if (weight != 0.0) & finite(after.high) {
        state[position_at(sphere)] = vec4f(after.high, state[position_at(sphere)].w);
        state[low_at(sphere)] = vec4f(after.low, 0.0);
    }
}

fn change_end_velocity(sphere: u32, weight: f32, impulse: vec3f) {
    let before = state[velocity_at(sphere)];
    let after = before.xyz + weight * impulse;
    if (weight != 0.0) & finite(after) {
        state[velocity_at(sphere)] = vec4f(after, before.w);
    }
}
