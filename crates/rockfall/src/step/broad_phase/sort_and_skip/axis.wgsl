// requires model/step.wgsl

// Objects in the order of an axis (sort-and-skip).

fn blocks() -> u32 {
    return (objects() + WORKGROUP - 1u) / WORKGROUP;
}
