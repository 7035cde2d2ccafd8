// requires model/objects.wgsl model/step.wgsl

// The lever of a contact on the rigid body with this record: from the centre of the body to that of the sphere `id`, or to the point of the
// axis of the rod `id` at the parameter `at`.
fn lever_on_body(record: u32, id: u32, at: f32) -> vec3f {
    var place = vec3f(0.0);
    if !RODS | (id < step.spheres) {
        place = state[position_at(id)].xyz;
    } else {
        let ends = rod_ends(id - step.spheres);
        place = mix(state[position_at(ends.x)].xyz, state[position_at(ends.y)].xyz, at);
    }
    return place - vector_at(record);
}
