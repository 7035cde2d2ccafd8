// requires physics/contact.wgsl

// The sum of the contact forces on a rod, or on a sphere by a law with history.

// Forces and torques on both ends of a rod, and the counters of its contacts. Those of a sphere are at end 1.
struct MoverLoad {
    force_1: vec3f,
    torque_1: vec3f,
    force_2: vec3f,
    torque_2: vec3f,
    contacts: u32,
    deepest: f32,
}

fn no_load() -> MoverLoad {
    return MoverLoad(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0u, 0.0);
}

// Adds a force and a torque on a mover at a parameter between its ends. Side A of a contact also counts it.
fn add_load(force: vec3f, torque: vec3f, at: f32, is_a: bool, overlap: f32, sum: ptr<function, MoverLoad>) {
    (*sum).force_1 += (1.0 - at) * force;
    (*sum).torque_1 += (1.0 - at) * torque;
    (*sum).force_2 += at * force;
    (*sum).torque_2 += at * torque;
    if is_a {
        (*sum).contacts += 1u;
        (*sum).deepest = max((*sum).deepest, overlap);
    }
}

// Adds a contact of which the mover is side A or side B.
fn add_contact(contact: ContactForce, at: f32, is_a: bool, overlap: f32, sum: ptr<function, MoverLoad>) {
    let force = select(-contact.force, contact.force, is_a);
    let torque = select(contact.arm_b, contact.arm_a, is_a) * contact.torque_per_arm;
    add_load(force, torque, at, is_a, overlap, sum);
}

fn put_rod_load(rod: u32, load: MoverLoad) {
    wrenches[4u * rod] = vec4f(load.force_1, 0.0);
    wrenches[4u * rod + 1u] = vec4f(load.torque_1, 0.0);
    wrenches[4u * rod + 2u] = vec4f(load.force_2, 0.0);
    wrenches[4u * rod + 3u] = vec4f(load.torque_2, 0.0);
}
