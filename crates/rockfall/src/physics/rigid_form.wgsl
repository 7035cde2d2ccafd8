// requires model/objects.wgsl physics/free_rotation.wgsl

// What the record of a rigid body says about its form and its orientation.

fn moments_in(record: u32) -> Moments {
    let shape = topology[record + 11u];
    return Moments(vector_at(shape + 1u), float_at(shape), vec4f(vector_at(shape + 4u), float_at(shape + 7u)));
}

fn orientation_in(record: u32) -> vec4f {
    return vec4f(vector_at(record + 14u), float_at(record + 17u));
}
