// requires model/objects.wgsl physics/forces/net_force.wgsl

// What `rod_forces` found for the end of a rod that a sphere is.
fn add_wrench(i: u32, rod: u32, net: ptr<function, Net>) {
    let end = 4u * rod + select(2u, 0u, rod_ends(rod).x == i);
    (*net).force += wrenches[end].xyz;
    (*net).torque += wrenches[end + 1u].xyz;
}
