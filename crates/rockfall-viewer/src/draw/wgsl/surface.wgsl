// Common parts of the shaders of ray-cast surfaces.

struct Surface {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
    @builtin(sample_mask) covered: u32,
}

/// A position outside the picture.
const NOWHERE: vec4f = vec4f(2.0, 2.0, 2.0, 1.0);

/// Returns the squared distance between a ray through the eye and a point at `offset` from the eye, and the position along
/// the ray of the nearest point.
fn approach(offset: vec3f, direction: vec3f) -> vec2f {
    let along = dot(offset, direction);
    let aside = offset - along * direction;
    return vec2f(dot(aside, aside), along);
}

/// Returns a unit vector that is perpendicular to the unit vector `n` (Duff et al. 2017).
fn aside_of(n: vec3f) -> vec3f {
    let side = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (side + n.z);
    return vec3f(1.0 + side * n.x * n.x * a, side * n.x * n.y * a, -side * n.x);
}
