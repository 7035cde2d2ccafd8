// Whether this attempt at the step has collisions to apply.
fn has_changes() -> bool {
    return (atomicLoad(&status.rejected) == 0u) & (atomicLoad(&status.collided) == 0u) & (atomicLoad(&status.collides) != 0u);
}
