// requires model/order.wgsl model/step.wgsl

// What a stage reports: the count of a workgroup, a sphere that left its AABB, or a sphere whose new state is not finite.

var<workgroup> group_count: atomic<u32>;

// Rejects the step, and requests new lists with which it can be repeated.
fn report_escape(ratio: f32) {
    atomicOr(&status.rejected, REJECTED_ESCAPED);
    atomicOr(&status.rebuild, REBUILD_REQUESTED);
    atomicMax(&status.escape_ratio, bitcast<u32>(ratio));
}

struct Motion {
    position: vec3f,
    velocity: vec3f,
    momentum: vec3f,
}

fn is_finite(motion: Motion) -> bool {
    return finite(motion.position) & finite(motion.velocity) & finite(motion.momentum);
}

// Reports a sphere whose new state is not finite in this stage (see BadStage in error.rs). Returns the
// motion of a sphere at rest at its old position.
fn stopped(position: vec3f, stage: u32, sphere: u32) -> Motion {
    atomicAdd(&status.bad_count, 1u);
    atomicMin(&status.bad_body, (stage << BAD_STAGE_SHIFT) | insertion_index(sphere));
    return Motion(position, vec3f(0.0), vec3f(0.0));
}
