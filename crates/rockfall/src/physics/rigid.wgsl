// requires model/objects.wgsl model/order.wgsl model/step.wgsl

// Rigid bodies and their sides of contacts (docs/physics.md sections 1.5 and 4.16).

fn rigid_record(body: u32) -> u32 {
    return step.rigid_at + RIGID_WORDS * body;
}

// The rigid body of a sphere, or NO_RIGID.
fn body_of_sphere(sphere: u32) -> u32 {
    if !RIGID_BODIES {
        return NO_RIGID;
    }
    return topology[step.rigid_of_at + insertion_index(sphere)];
}

// Whether a sphere belongs to no rigid body, so that integrators move it.
fn is_free(sphere: u32) -> bool {
    return body_of_sphere(sphere) == NO_RIGID;
}

// The rigid body of a sphere, or of a rod between two of its spheres.
fn rigid_body_of(id: u32) -> u32 {
    if id < step.spheres {
        return body_of_sphere(id);
    }
    if RODS & (id - step.spheres < step.rods) {
        let ends = rod_ends(id - step.spheres);
        let body = body_of_sphere(ends.x);
        return select(NO_RIGID, body, body == body_of_sphere(ends.y));
    }
    return NO_RIGID;
}

// Whether two objects are parts of one rigid body.
fn in_one_body(a: u32, b: u32) -> bool {
    if !RIGID_BODIES {
        return false;
    }
    let body = rigid_body_of(a);
    return (body != NO_RIGID) && (body == rigid_body_of(b));
}

// Whether one of two objects is a part of a rigid body. Such a contact exerts forces alone.
fn touches_body(a: u32, b: u32) -> bool {
    if !RIGID_BODIES {
        return false;
    }
    return (rigid_body_of(a) != NO_RIGID) | (rigid_body_of(b) != NO_RIGID);
}

// A vector times the tensor of the inverse inertia.
fn by_inverse_inertia(record: u32, v: vec3f) -> vec3f {
    let diagonal = vector_at(record + 4u);
    let mixed = vector_at(record + 7u);
    return vec3f(
        dot(vec3f(diagonal.x, mixed.x, mixed.y), v),
        dot(vec3f(mixed.x, diagonal.y, mixed.z), v),
        dot(vec3f(mixed.y, mixed.z, diagonal.z), v),
    );
}
