// requires model/step.wgsl

// What a stage reports: the count of a workgroup, a sphere that left its AABB, or a sphere whose new state is not finite.

// The sum of the counts of a workgroup's threads, and in its upper bits the number of threads that have added theirs.
var<workgroup> group_count: atomic<u32>;

// What a thread adds to `group_count` for itself.
const ARRIVED: u32 = 1u << 24u;
const NOT_LAST: u32 = 0xffffffffu;

// Begins a count. All threads must call it before any loop: one driver lets threads that leave a loop early run through a barrier while
// their neighbours are still in the loop (see sweep_at_once.wgsl).
fn begin_count(local: u32) {
    if local == 0u {
        atomicStore(&group_count, 0u);
    }
    workgroupBarrier();
}

// Adds the count of a thread, each of which must call this once. Returns the sum to the thread that comes last, and NOT_LAST to all others.
fn add_to_count(own: u32) -> u32 {
    let before = atomicAdd(&group_count, own + ARRIVED);
    return select(NOT_LAST, (before % ARRIVED) + own, (before / ARRIVED) == (WORKGROUP - 1u));
}

// The bit of `rejected` of a dispatch that finds escapes.
fn escape_bit(dispatch: u32) -> u32 {
    return 1u << (ESCAPE_SHIFT + dispatch);
}

// Whether the step was rejected before this dispatch, which has this number among those that find escapes, or for one of the other reasons
// that `besides` leaves out. A dispatch in which a body is found outside its AABB is completed by all threads, so that no count depends
// on the order in which they run.
fn was_rejected_before(dispatch: u32, besides: u32) -> bool {
    return (atomicLoad(&status.rejected) & ~(escape_bit(dispatch) | besides)) != 0u;
}

// Rejects the step, and requests new lists with which it can be repeated. `dispatch` is the number of this dispatch.
fn report_escape(ratio: f32, dispatch: u32) {
    atomicOr(&status.rejected, escape_bit(dispatch));
    atomicOr(&status.rebuild, REBUILD_REQUESTED);
    atomicMax(&status.escape_ratio, bitcast<u32>(ratio));
}

