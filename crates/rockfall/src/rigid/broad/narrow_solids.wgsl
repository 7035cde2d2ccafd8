// requires rigid/broad/narrow.wgsl rigid/collide/polyhedra.wgsl

// Manifolds of any two of face, box and hull, but for those of two boxes without radii that are not left.

fn is_own_pair(a: Shape, b: Shape, is_left: bool) -> bool {
    let are_boxes = a.core == CORE_BOX && b.core == CORE_BOX && a.radius + b.radius <= 0.0;
    return min(a.core, b.core) > CORE_SMOOTH && max(a.core, b.core) < CORE_SEGMENT && (is_left || !are_boxes);
}

fn collide_in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    let own = Solid(a, vec3f(0.0), mat3x3f(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), vec3f(0.0, 0.0, 1.0)));
    return collide_solids(own, Solid(b, position, axes), reach);
}
