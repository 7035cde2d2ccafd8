// requires model/objects.wgsl model/step.wgsl physics/forces/net_force.wgsl

// Adds the force and torque that `rod_forces` computed for the end of a rod, to the sphere at that end.
fn add_wrench(i: u32, rod: u32, net: ptr<function, Net>) {
    let end = 4u * rod + select(2u, 0u, rod_ends(rod).x == i);
    (*net).force += wrenches[end].xyz;
    (*net).torque += wrenches[end + 1u].xyz;
}

// Adds the force and torque that `law_forces` computed for the contacts of a sphere.
fn add_law_load(i: u32, net: ptr<function, Net>) {
    let at = 4u * step.rods + 2u * i;
    (*net).force += wrenches[at].xyz;
    (*net).torque += wrenches[at + 1u].xyz;
}
