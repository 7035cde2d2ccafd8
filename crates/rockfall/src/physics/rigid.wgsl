// requires model/objects.wgsl model/step.wgsl physics/rigid_parts.wgsl

// Rigid bodies and their sides of contacts (docs/physics sections 1.5 and 4.16).

fn rigid_record(body: u32) -> u32 {
    return step.rigid_at + RIGID_WORDS * body;
}

// Whether a sphere belongs to no rigid body, so that integrators move it.
fn is_free(sphere: u32) -> bool {
    return body_of_sphere(sphere) == NO_RIGID;
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
