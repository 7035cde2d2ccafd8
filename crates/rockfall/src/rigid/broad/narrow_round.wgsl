// requires rigid/broad/narrow.wgsl rigid/collide/ball.wgsl rigid/collide/capsule.wgsl rigid/collide/half_space.wgsl

// Manifolds of pairs with a ball or a capsule.

fn is_own_pair(a: Shape, b: Shape, is_left: bool) -> bool {
    return max(a.core, b.core) >= CORE_SEGMENT;
}

fn collide_in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    if b.core == CORE_POINT {
        return collide_ball(a, b.radius, position, reach);
    }
    if CAPSULES {
        let other = Solid(b, position, axes);
        if a.core == CORE_SMOOTH {
            return collide_half_space(a, other, reach);
        }
        let own = Solid(a, vec3f(0.0), mat3x3f(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0)));
        if a.core == CORE_SEGMENT {
            return collide_capsules(own, other, reach);
        }
        return collide_capsule(own, other, reach);
    }
    return no_contact();
}
