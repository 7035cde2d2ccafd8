// requires rigid/broad/narrow.wgsl rigid/collide/box_box.wgsl rigid/collide/half_space.wgsl

// Manifolds of two boxes without radii, and of half-spaces with boxes, faces and hulls. A pair of boxes that the general pair must decide is
// marked as left.

fn is_own_pair(a: Shape, b: Shape, is_left: bool) -> bool {
    let most = max(a.core, b.core);
    let are_boxes = a.core == CORE_BOX && b.core == CORE_BOX && a.radius + b.radius <= 0.0;
    return are_boxes || (min(a.core, b.core) == CORE_SMOOTH && most > CORE_SMOOTH && most < CORE_SEGMENT);
}

fn collide_in_order(a: Shape, b: Shape, position: vec3f, axes: mat3x3f, reach: f32) -> Manifold {
    if a.core == CORE_SMOOTH {
        return collide_half_space(a, Solid(b, position, axes), reach);
    }
    return collide_boxes(a.size.xyz, b.size.xyz, position, axes, reach);
}
