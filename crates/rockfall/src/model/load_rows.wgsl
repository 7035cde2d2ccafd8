// requires model/step.wgsl physics/forces/load.wgsl

// The loads that the stage `loads` has left in `wrenches`, behind those of the rods.

fn load_at(sphere: u32) -> u32 {
    return 4u * step.rods + 2u * sphere;
}

fn load_of(sphere: u32) -> Load {
    let at = load_at(sphere);
    return Load(wrenches[at].xyz, wrenches[at + 1u].xyz);
}
