// requires model/objects.wgsl physics/forces/net_force.wgsl

// Adds the force and torque that `rod_forces` computed for the end of a rod, to the sphere at that end.
fn add_wrench(i: u32, rod: u32, net: ptr<function, Net>) {
    let end = 4u * rod + select(2u, 0u, rod_ends(rod).x == i);
    (*net).force += wrenches[end].xyz;
    (*net).torque += wrenches[end + 1u].xyz;
}
