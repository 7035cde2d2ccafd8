// requires model/objects.wgsl model/step.wgsl physics/free_rotation.wgsl physics/rigid.wgsl

// What rigid bodies are made of, and their rows in `bodies`.

// What a body is made of.
struct Form {
    moments: Moments,
    inverse_mass: f32,
    // First word of its shape, first word of its members, and their number.
    shape: u32,
    members: u32,
    count: u32,
}

fn form_of(body: u32) -> Form {
    let record = rigid_record(body);
    let shape = topology[record + 11u];
    return Form(
        Moments(vector_at(shape + 1u), float_at(shape), vec4f(vector_at(shape + 4u), float_at(shape + 7u))),
        float_at(record + 3u),
        shape,
        topology[record + 12u],
        topology[record + 13u],
    );
}

fn pose_row(body: u32, place: u32) -> vec4f {
    return bodies[RIGID_ROWS * body + place];
}

fn put_pose_row(body: u32, place: u32, row: vec4f) {
    bodies[RIGID_ROWS * body + place] = row;
}

// The place of a member sphere from the centre of mass, in the coordinates of the body.
fn place_of_member(form: Form, member: u32) -> vec3f {
    return vector_at(form.shape + SHAPE_WORDS + 3u * member);
}
