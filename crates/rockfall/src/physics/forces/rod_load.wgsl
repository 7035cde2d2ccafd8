// requires physics/forces/net_force.wgsl

// The loads of the contacts of a rod.

// Forces and torques on both ends, and the counts of its contacts.
struct RodLoad {
    force_1: vec3f,
    torque_1: vec3f,
    force_2: vec3f,
    torque_2: vec3f,
    contacts: u32,
    deepest: f32,
}

fn no_rod_load() -> RodLoad {
    return RodLoad(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0u, 0.0);
}

// Adds a contact at a parameter between the ends. Side A of a contact also counts it.
fn add_to_ends(push: Push, at: f32, is_a: bool, sum: ptr<function, RodLoad>) {
    let torque = push.arm * push.torque_per_arm;
    (*sum).force_1 += (1.0 - at) * push.force;
    (*sum).torque_1 += (1.0 - at) * torque;
    (*sum).force_2 += at * push.force;
    (*sum).torque_2 += at * torque;
    if is_a {
        (*sum).contacts += 1u;
        (*sum).deepest = max((*sum).deepest, push.overlap);
    }
}
