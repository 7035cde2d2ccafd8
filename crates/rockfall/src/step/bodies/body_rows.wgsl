// requires model/objects.wgsl model/step.wgsl physics/fine.wgsl physics/free_rotation.wgsl physics/rigid.wgsl physics/rigid_form.wgsl

// What rigid bodies are made of, and their rows in `bodies`.

struct Pose {
    position: Fine,
    velocity: vec3f,
    momentum: vec3f,
    orientation: vec4f,
}

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
    return Form(
        moments_in(record),
        float_at(record + 3u),
        topology[record + 11u],
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

// The state at the start of the step.
fn start_of(body: u32) -> Pose {
    let place = Fine(pose_row(body, 0u).xyz, pose_row(body, 1u).xyz);
    return Pose(place, pose_row(body, 2u).xyz, pose_row(body, 3u).xyz, pose_row(body, 4u));
}

fn pose_is_finite(pose: Pose) -> bool {
    return finite(pose.position.high) & finite(pose.velocity) & finite(pose.momentum) & finite(pose.orientation.xyz) & finite(pose.orientation.www);
}

// The place of a member sphere from the centre of mass, in the coordinates of the body.
fn place_of_member(form: Form, member: u32) -> vec3f {
    return vector_at(form.shape + SHAPE_WORDS + 3u * member);
}

// Writes the pose to the first rows.
fn put_pose(body: u32, pose: Pose) {
    put_pose_row(body, 0u, vec4f(pose.position.high, 0.0));
    put_pose_row(body, 1u, vec4f(pose.position.low, 0.0));
    put_pose_row(body, 2u, vec4f(pose.velocity, 0.0));
    put_pose_row(body, 3u, vec4f(pose.momentum, 0.0));
    put_pose_row(body, 4u, pose.orientation);
}
