// Surfaces that are ray-cast: what their shaders have in common.

struct Surface {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
    @builtin(sample_mask) covered: u32,
}

/// Outside of the picture.
const NOWHERE: vec4f = vec4f(2.0, 2.0, 2.0, 1.0);

/// Square of the distance of a ray through the eye from a point at `offset` of it, and the place of the nearest point.
fn approach(offset: vec3f, direction: vec3f) -> vec2f {
    let along = dot(offset, direction);
    let aside = offset - along * direction;
    return vec2f(dot(aside, aside), along);
}

/// Any unit vector that is perpendicular to a unit vector, and steady (Duff et al. 2017).
fn aside_of(n: vec3f) -> vec3f {
    let side = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (side + n.z);
    return vec3f(1.0 + side * n.x * n.x * a, side * n.x * n.y * a, -side * n.x);
}
