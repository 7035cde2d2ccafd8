// requires model/objects.wgsl model/step.wgsl

// Batches of fixed-length rods (physics.md section 5): a workgroup sweeps one batch colour by colour. The rods of one
// colour share no sphere that moves, so that its threads do not meet.

// Relative error of a length, and the number of sweeps, at which sweeping ends.
const TOLERANCE: f32 = 1e-5;
const MAX_SWEEPS: u32 = 400u;

// An error up to this times the sum of the largest components that it is the difference of is their rounding.
const LENGTH_ROUNDING: f32 = 4.8e-7;

fn largest(v: vec3f) -> f32 {
    return max(abs(v.x), max(abs(v.y), abs(v.z)));
}

// A difference, and 0 where it is only the rounding of two vectors.
fn but_rounding(error: f32, one: vec3f, two: vec3f) -> f32 {
    return select(abs(error), 0.0, abs(error) <= LENGTH_ROUNDING * (largest(one) + largest(two)));
}

var<workgroup> worst: atomic<u32>;
var<workgroup> go_on: u32;

struct Batch {
    colours: u32,
    // First of `colours + 1` words that hold where a colour's rods begin.
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

// Whether another sweep is due, after `sweeps` of them. The whole workgroup must come here.
// One colour is exact after one sweep. Positive floats order like their bits.
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

// Moves the ends of a rod along it until it has its length; gives the relative error that there was.
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
    let d = two - one;
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
    return but_rounding(distance - target_length, one, two) / target_length;
}

// The rods of one colour may share a sphere that is fixed: it is not written at all. An end that would leave what f32 holds
// stays as it is.
fn move_end(sphere: u32, weight: f32, displacement: vec3f) {
    let before = state[position_at(sphere)];
    let after = before.xyz + weight * displacement;
    if (weight != 0.0) & finite(after) {
        state[position_at(sphere)] = vec4f(after, before.w);
    }
}

fn kick_end(sphere: u32, weight: f32, impulse: vec3f) {
    let before = state[velocity_at(sphere)];
    let after = before.xyz + weight * impulse;
    if (weight != 0.0) & finite(after) {
        state[velocity_at(sphere)] = vec4f(after, before.w);
    }
}
