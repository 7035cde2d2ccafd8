// requires model/order.wgsl model/step.wgsl

// Which rigid body an object is a part of, and which pairs never touch because of that (docs/physics section 1.5). Lists
// leave such pairs out.

// The rigid body of a sphere, or NO_RIGID.
fn body_of_sphere(sphere: u32) -> u32 {
    if !RIGID_BODIES {
        return NO_RIGID;
    }
    return topology[step.rigid_of_at + insertion_index(sphere)];
}

// The rigid body of a sphere, or of a rod between two of its spheres.
fn rigid_body_of(id: u32) -> u32 {
    if id < step.spheres {
        return body_of_sphere(id);
    }
    if RODS & (id - step.spheres < step.rods) {
        let at = step.rods_at + (id - step.spheres) * ROD_WORDS;
        let body = body_of_sphere(topology[at]);
        return select(NO_RIGID, body, body == body_of_sphere(topology[at + 1u]));
    }
    return NO_RIGID;
}

// Whether two objects never touch because they are parts of one rigid body.
fn never_meet(a: u32, b: u32) -> bool {
    if !RIGID_BODIES {
        return false;
    }
    let body = rigid_body_of(a);
    return (body != NO_RIGID) & (body == rigid_body_of(b));
}
