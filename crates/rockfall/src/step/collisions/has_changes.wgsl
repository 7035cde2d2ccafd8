// Whether there are collisions to apply in this attempt at the step.
fn has_changes() -> bool {
    return (atomicLoad(&status.rejected) == 0u) & (atomicLoad(&status.collided) == 0u) & (atomicLoad(&status.collides) != 0u);
}
