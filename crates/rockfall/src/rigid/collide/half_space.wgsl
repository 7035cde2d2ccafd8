// requires rigid/collide/manifold.wgsl rigid/collide/reduce.wgsl rigid/collide/solid.wgsl

// A half-space against what has vertices (docs/physics section 11.13).

fn collide_half_space(a: Shape, b: Solid, reach: f32) -> Manifold {
    let most = reach + a.radius + b.shape.radius;
    var candidates: Candidates;
    candidates.count = 0u;
    // Other smooth walls are touched by balls only.
    let count = select(0u, vertices_of_core(b.shape), a.more == HALF_SPACE);
    for (var number = 0u; number < MOST_CANDIDATES && number < count; number++) {
        let vertex = vertex_of(b, number);
        if vertex.y <= most {
            candidates.places[candidates.count] = vec4f(vertex.x, 0.0, vertex.z, vertex.y);
            candidates.ids[candidates.count] = id_of_vertex(number);
            candidates.count++;
        }
    }
    return reduced(&candidates, vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), vec2f(a.radius, b.shape.radius));
}
