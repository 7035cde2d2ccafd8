// requires rigid/collide/manifold.wgsl

// Vertices of cores (docs/physics.md section 11.13). Hulls are not part of it yet.

// Half the edges with the signs of vertex k of a box.
fn vertex_of_box(extent: vec3f, k: u32) -> vec3f {
    return select(-extent, extent, (vec3u(k) & vec3u(1u, 2u, 4u)) != vec3u(0u));
}

fn vertex_of_core_face(shape: Shape, k: u32) -> vec3f {
    let u = shape.size.xy;
    let v = shape.size.zw * unit_sign(u.x * shape.size.w - u.y * shape.size.z);
    return vec3f(select(-u, u, k == 1u || k == 2u) + select(-v, v, k >= 2u), 0.0);
}

fn vertices_of_core(shape: Shape) -> u32 {
    switch shape.core {
        case CORE_FACE: {
            return 4u;
        }
        case CORE_BOX: {
            return 8u;
        }
        case CORE_SEGMENT: {
            return 2u;
        }
        default: {
            return 0u;
        }
    }
}

fn vertex_of_core(shape: Shape, k: u32) -> vec3f {
    switch shape.core {
        case CORE_FACE: {
            return vertex_of_core_face(shape, k);
        }
        case CORE_BOX: {
            return vertex_of_box(shape.size.xyz, k);
        }
        default: {
            return vec3f(0.0, select(-shape.size.x, shape.size.x, k == 1u), 0.0);
        }
    }
}
