// requires physics/quaternion.wgsl rigid/collide/ball.wgsl rigid/collide/box_box.wgsl rigid/collide/capsule.wgsl
// requires rigid/collide/half_space.wgsl rigid/collide/manifold.wgsl rigid/collide/polyhedra.wgsl rigid/collide/solid.wgsl

// Contacts of two shapes in a relative pose: which pair of cores is solved where (docs/physics.md section 11.13). A shape is two rows of
// four words in memory (`Shape`).

fn axes_of(turn: vec4f) -> mat3x3f {
    return mat3x3f(
        turned_vector(turn, vec3f(1.0, 0.0, 0.0)), turned_vector(turn, vec3f(0.0, 1.0, 0.0)), turned_vector(turn, vec3f(0.0, 0.0, 1.0)));
}

// A pair whose cores are in the order of the table.
fn collide_in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    if b.core == CORE_POINT {
        return collide_ball(a, b.radius, position, reach);
    }
    let other = Solid(b, position, axes);
    if a.core == CORE_HALF_SPACE {
        return collide_half_space(a, other, reach);
    }
    let own = Solid(a, vec3f(0.0), mat3x3f(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0)));
    if CAPSULES & (b.core == CORE_SEGMENT) {
        if a.core == CORE_SEGMENT {
            return collide_capsules(own, other, reach);
        }
        return collide_capsule(own, other, reach);
    }
    var manifold = no_contact();
    if a.core == CORE_BOX && b.core == CORE_BOX && a.radius + b.radius <= 0.0 {
        manifold = collide_boxes(a.size.xyz, b.size.xyz, position, axes, reach);
    } else {
        manifold.count = UNDECIDED;
    }
    if manifold.count == UNDECIDED {
        manifold.count = 0u;
        // Boxes without radii hardly ever come here.
        if SOLIDS {
            return collide_solids(own, other, reach);
        }
    }
    return manifold;
}

// The contact points of two shapes with a separation of at most `reach`, in coordinates of a. There b has this position and turn.
fn collide(a: Shape, b: Shape, position: vec3f, turn: vec4f, reach: f32) -> Manifold {
    let is_exchanged = a.core > b.core;
    let axes = axes_of(turn);
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
