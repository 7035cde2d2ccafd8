// requires model/step.wgsl

// Whether a stage that rebuilds lists has work. It waits for these bits of `rebuild`. A step that was rejected because a body left its
// AABB gets new lists, so that the next one can repeat it (`close_step`). The stage defines `status`, which it does not share.
fn builds_lists(bits: u32) -> bool {
    let may_repeat = has_only_escaped(status.rejected) & (status.repeated == 0u);
    return ((status.rebuild & bits) != 0u) & ((status.rejected == 0u) | may_repeat);
}
