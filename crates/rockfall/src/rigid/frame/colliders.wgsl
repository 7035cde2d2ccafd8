// requires rigid/collide/manifold.wgsl

// Colliders (docs/physics section 11.1): a place in coordinates of a body, and a shape. `rigid/gpu/shapes.rs` has the same rows.
//
// Rows of a collider: place, body; turn; group, material, 1 if its surface has a velocity, the groups that it meets; the two rows of its
// shape.

@group(0) @binding(11) var<storage, read> colliders: array<vec4u>;
@group(0) @binding(12) var<storage, read> hulls: array<vec4u>;

const COLLIDER_ROWS: u32 = 5u;

fn body_of_collider(collider: u32) -> u32 {
    return colliders[COLLIDER_ROWS * collider].w;
}

// Its origin in coordinates of its body.
fn place_of_collider(collider: u32) -> vec3f {
    return bitcast<vec3f>(colliders[COLLIDER_ROWS * collider].xyz);
}

fn turn_of_collider(collider: u32) -> vec4f {
    return bitcast<vec4f>(colliders[COLLIDER_ROWS * collider + 1u]);
}

// Group, material, 1 if its surface has a velocity, the groups that it meets.
fn marks_of_collider(collider: u32) -> vec4u {
    return colliders[COLLIDER_ROWS * collider + 2u];
}

fn shape_of_collider(collider: u32) -> Shape {
    let size = bitcast<vec4f>(colliders[COLLIDER_ROWS * collider + 3u]);
    let rest = colliders[COLLIDER_ROWS * collider + 4u];
    return Shape(size, bitcast<f32>(rest.x), rest.y, rest.z, 0u);
}
