// requires physics/quaternion.wgsl rigid/collide/manifold.wgsl

// The order of two shapes (docs/physics section 11.13), for kernels that solve a part of the pairs of cores. Such a kernel has a function
// `collide_in_order` for pairs whose cores are in the order of the table.

fn axes_of_turn(turn: vec4f) -> mat3x3f {
    return mat3x3f(
        turned_vector(turn, vec3f(1.0, 0.0, 0.0)), turned_vector(turn, vec3f(0.0, 1.0, 0.0)), turned_vector(turn, vec3f(0.0, 0.0, 1.0)));
}

// The contact points of two shapes with a separation of at most `reach`, in coordinates of a. There b has this position and turn.
fn collide(a: Shape, b: Shape, position: vec3f, turn: vec4f, reach: f32) -> Manifold {
    let is_exchanged = a.core > b.core;
    let axes = axes_of_turn(turn);
    var first = a;
    var second = b;
    var own_position = position;
    var own_axes = axes;
    if is_exchanged {
        first = b;
        second = a;
        own_position = -(position * axes);
        own_axes = transpose(axes);
    }
    var manifold = collide_in_order(first, second, own_position, own_axes, reach);
    if is_exchanged {
        exchange_shapes(&manifold, position, axes);
    }
    return manifold;
}
