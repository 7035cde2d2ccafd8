// requires model/order.wgsl model/step.wgsl

// Which rigid body and which box an object is a part of, and which pairs never touch because of that (docs/physics.md sections 1.5 and
// 2.16). Lists leave such pairs out.

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

// What an object is of a box of a rigid body: 0 for nothing, otherwise the first word of the box, with BOX_RIM for a vertex or an edge.
fn box_word(id: u32) -> u32 {
    if !BODY_BOXES {
        return 0u;
    }
    if id < step.spheres {
        return topology[step.rigid_parts_at + insertion_index(id)];
    }
    if RODS & (id - step.spheres < step.rods) {
        return topology[step.rigid_parts_at + id];
    }
    return 0u;
}

// The length that the margin of the AABB of a sphere is measured in: the radius, or half the shortest edge of the box that the sphere is a
// part of, because a vertex moves as its box does.
fn margin_length(sphere: u32, radius: f32) -> f32 {
    let word = box_word(sphere);
    if word == 0u {
        return radius;
    }
    let at = word & ~BOX_RIM;
    let half = bitcast<vec3f>(vec3u(topology[at + 4u], topology[at + 5u], topology[at + 6u]));
    return min(min(half.x, half.y), half.z) + bitcast<f32>(topology[at + 3u]);
}

// Whether an object with this word stands for the solid of a box.
fn is_solid(word: u32) -> bool {
    return (word != 0u) & ((word & BOX_RIM) == 0u);
}

// Whether all contacts of an object exert forces alone: it is a rod that ends in a rigid body and does not belong to it.
fn is_forced(id: u32) -> bool {
    if RODS & (id - step.spheres < step.rods) {
        let at = step.rods_at + (id - step.spheres) * ROD_WORDS;
        let ends_in_body = (body_of_sphere(topology[at]) != NO_RIGID) | (body_of_sphere(topology[at + 1u]) != NO_RIGID);
        return ends_in_body & (rigid_body_of(id) == NO_RIGID);
    }
    return false;
}

// Whether one of two objects is a part of a box.
fn has_box(a: u32, b: u32) -> bool {
    return (box_word(a) | box_word(b)) != 0u;
}

// Whether the contact of two objects exerts forces and gets no impulses (docs/physics.md section 4.16).
fn has_forces_alone(a: u32, b: u32) -> bool {
    if !RIGID_BODIES {
        return false;
    }
    if is_forced(a) {
        return true;
    }
    return is_forced(b);
}

// Whether other parts of its boxes stand for a pair.
fn is_left_to_others(a: u32, b: u32) -> bool {
    let one = box_word(a);
    let other = box_word(b);
    let a_sphere = a < step.spheres;
    let b_sphere = b < step.spheres;
    if is_solid(one) | is_solid(other) {
        // A solid also meets the corners of walls.
        let is_with_wall = max(a, b) >= step.spheres + step.rods;
        return (is_solid(one) & is_solid(other)) | !((a_sphere & b_sphere) | is_with_wall);
    }
    if a_sphere & b_sphere {
        return (one | other) != 0u;
    }
    // A sphere and an edge. Walls have no words.
    return (a_sphere & (other != 0u) & (b - step.spheres < step.rods)) | (b_sphere & (one != 0u));
}

// Whether two objects never touch because of the rigid bodies that they are parts of.
fn never_meet(a: u32, b: u32) -> bool {
    if !RIGID_BODIES {
        return false;
    }
    let body = rigid_body_of(a);
    if (body != NO_RIGID) & (body == rigid_body_of(b)) {
        return true;
    }
    return BODY_BOXES && is_left_to_others(a, b);
}
