// requires model/order.wgsl model/step.wgsl physics/fine.wgsl physics/forces/rates.wgsl physics/residue.wgsl

struct Motion {
    position: vec3f,
    // Low part of the position.
    low: vec3f,
    velocity: vec3f,
    momentum: vec3f,
}

fn is_finite(motion: Motion) -> bool {
    return finite(motion.position) & finite(motion.velocity) & finite(motion.momentum);
}

// Reports a sphere whose new state is not finite in this stage (see BadStage in error.rs). Returns the
// motion of a sphere at rest at its old position.
fn stopped(position: vec3f, low: vec3f, stage: u32, sphere: u32) -> Motion {
    atomicAdd(&status.bad_count, 1u);
    atomicMin(&status.bad_body, (stage << BAD_STAGE_SHIFT) | insertion_index(sphere));
    return Motion(position, low, vec3f(0.0), vec3f(0.0));
}

// The position after a displacement, and its low part, in a motion.
fn displaced(motion: Motion, by: vec3f) -> Motion {
    let place = fine_moved(Fine(motion.position, motion.low), by);
    return Motion(place.high, place.low, motion.velocity, motion.momentum);
}

// A motion, and the row of its residues.
struct Kicked {
    motion: Motion,
    residues: vec4f,
}

// A sphere after its velocity has changed for `kick` seconds at the given rates and has then moved it for the whole step.
fn kicked_and_moved(before: Motion, residues: vec4f, rates: Rates, kick: f32, sphere: u32) -> Kicked {
    let new_ = increased(before.velocity, before.momentum, residues, kick * rates.acceleration, kick * rates.torque, VERLET);
    let after = displaced(Motion(before.position, before.low, new_.velocity, new_.momentum), step.dt * new_.velocity);
    if !is_finite(after) {
        return Kicked(stopped(before.position, before.low, 1u, sphere), vec4f(0.0));
    }
    return Kicked(after, new_.residues);
}
