// requires physics/quaternion.wgsl rigid/collide/box_box.wgsl rigid/collide/half_space.wgsl rigid/collide/manifold.wgsl
// requires rigid/collide/polyhedra.wgsl rigid/collide/round.wgsl rigid/collide/solid.wgsl

// Contacts of two shapes in a relative pose: which pair of cores is solved where (docs/physics section 11.13). A shape is two rows of
// four words in memory (`Shape`).

fn axes_of(turn: vec4f) -> mat3x3f {
    return mat3x3f(
        turned_vector(turn, vec3f(1.0, 0.0, 0.0)), turned_vector(turn, vec3f(0.0, 1.0, 0.0)), turned_vector(turn, vec3f(0.0, 0.0, 1.0)));
}

// A pair whose cores are in the order of the table, without balls and capsules.
fn collide_flat_in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    let other = Solid(b, position, axes);
    if a.core == CORE_SMOOTH {
        return collide_half_space(a, other, reach);
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
            return collide_solids(solid_at_origin(a), other, reach);
        }
    }
    return manifold;
}

// A pair whose cores are in the order of the table.
fn collide_in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    if b.core == CORE_POINT || b.core == CORE_SEGMENT {
        return collide_round_in_order(a, b, position, axes, reach);
    }
    return collide_flat_in_order(a, b, position, axes, reach);
}

// The contact points of two shapes with a separation of at most `reach`, in coordinates of a. There b has this position and turn.
fn collide(a: Shape, b: Shape, position: vec3f, turn: vec4f, reach: f32) -> Manifold {
    let axes = axes_of(turn);
    let pair = in_order(a, b, position, axes);
    var manifold = collide_in_order(pair.a, pair.b, pair.position, pair.axes, reach);
    if pair.is_exchanged {
        exchange_shapes(&manifold, position, axes);
    }
    return manifold;
}
