// requires model/step.wgsl

// Whether loads are wanted in this step. Another thread of this dispatch may reject the step. Then no result is
// used. The end of that step says how many blocks are needed.
fn are_loads_wanted(own: u32) -> bool {
    return ((atomicLoad(&status.rejected) & ~(REJECTED_HISTORY | own)) == 0u) & (status.history_needed == 0u);
}

// Whether this pass computes loads. Velocity Verlet mostly has the rates at the start of a step from the step before.
fn are_loads_due() -> bool {
    return !VERLET | (evaluation() != 0u) | (status.forces_due != 0u);
}
