// Objects in the order of an axis (sort-and-skip).

fn objects() -> u32 {
    return step.spheres + step.rods + step.boxes + step.polygons;
}

fn blocks() -> u32 {
    return (objects() + WORKGROUP - 1u) / WORKGROUP;
}
