// requires model/step.wgsl

// What a stage reports: the count of a workgroup, a sphere that left its AABB, or a sphere whose new state is not finite.

var<workgroup> group_count: atomic<u32>;

// Rejects the step, and requests new lists with which it can be repeated.
fn report_escape(ratio: f32) {
    atomicOr(&status.rejected, REJECTED_ESCAPED);
    atomicOr(&status.rebuild, REBUILD_REQUESTED);
    atomicMax(&status.escape_ratio, bitcast<u32>(ratio));
}

