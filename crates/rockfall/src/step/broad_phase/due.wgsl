// requires model/step.wgsl

// Whether a stage that rebuilds lists has work. `rebuild` has the bits of `status.rebuild` that the stage waits for. A step that was
// rejected because a body left its AABB gets new lists, so that the next one can repeat it (`close_step`).
fn builds_lists(rebuild: u32, rejected: u32) -> bool {
    return (rebuild != 0u) & ((rejected & ~REJECTED_ESCAPED) == 0u);
}
