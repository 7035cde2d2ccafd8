// requires model/step.wgsl

// Number of blocks of sorted objects in sort-and-skip.
fn blocks() -> u32 {
    return (objects() + WORKGROUP - 1u) / WORKGROUP;
}
