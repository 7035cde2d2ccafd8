// requires rigid/collide/ball.wgsl rigid/collide/capsule.wgsl rigid/collide/manifold.wgsl rigid/collide/solid.wgsl

// Round pairs: a ball or a capsule against everything (docs/physics section 11.13).

// A pair whose cores are in the order of the table. There the second shape has this position and these axes.
struct OrderedPair {
    a: Shape,
    b: Shape,
    position: vec3f,
    axes: mat3x3f,
    is_exchanged: bool,
}

fn in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f) -> OrderedPair {
    if a.core > b.core {
        return OrderedPair(b, a, -(position * axes), transpose(axes), true);
    }
    return OrderedPair(a, b, position, axes, false);
}

// The shape of the core itself, in its own coordinates.
fn solid_at_origin(shape: Shape) -> Solid {
    return Solid(shape, vec3f(0.0), mat3x3f(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0)));
}

// A pair in order whose second shape is a ball or a capsule.
fn collide_round_in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    if b.core == CORE_POINT {
        return collide_ball(a, b.radius, position, reach);
    }
    if CAPSULES {
        let other = Solid(b, position, axes);
        if a.core == CORE_SMOOTH {
            return capsule_above_half_space(a, other, reach);
        }
        if a.core == CORE_SEGMENT {
            return collide_capsules(solid_at_origin(a), other, reach);
        }
        return collide_capsule(solid_at_origin(a), other, reach);
    }
    return no_contact();
}

// The contact points of a round pair with a separation of at most `reach`, in coordinates of a. There b has this position and these axes.
fn collide_round(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    let pair = in_order(a, b, position, axes);
    var manifold = collide_round_in_order(pair.a, pair.b, pair.position, pair.axes, reach);
    if pair.is_exchanged {
        exchange_shapes(&manifold, position, axes);
    }
    return manifold;
}
