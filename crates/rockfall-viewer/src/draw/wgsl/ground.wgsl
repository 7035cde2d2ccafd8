// The sky behind the scene and the ground below it.

struct Ground {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn sky(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let up = normalize(view_ray(place.xy)).y;
    return vec4f(mix(frame.horizon, frame.zenith, smoothstep(0.0, 0.7, up)), 1.0);
}

/// The ground is transparent except for its grid and the shadows on it. Both fade with the distance from the target of the
/// camera.
@fragment
fn ground(@builtin(position) place: vec4f) -> Ground {
    let ray = view_ray(place.xy);
    let distance = (frame.ground - frame.eye.y) / ray.y;
    let point = frame.eye + distance * ray;
    // Before any fragment is discarded, because derivatives need all four pixels of a quad.
    let width = fwidth(point.xz);
    if distance <= 0.0 || ray.y == 0.0 {
        discard;
    }
    let reach = length(point.xz - frame.centre.xz) / frame.centre_distance;
    let fading = exp(-1.2 * reach * reach);
    let lines = 0.18 * grid_at(point.xz, width);
    let shade = 0.55 * (1.0 - sunlight(point, vec3f(0.0, 1.0, 0.0)));
    let dark = (1.0 - (1.0 - lines) * (1.0 - shade)) * fading;
    var ground: Ground;
    ground.colour = vec4f(vec3f(0.10, 0.12, 0.16) * dark, dark);
    ground.depth = depth_at(point);
    return ground;
}
