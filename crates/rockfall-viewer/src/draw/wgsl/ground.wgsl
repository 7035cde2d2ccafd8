// The sky behind the scene and the ground below it.

struct Ground {
    @location(0) colour: vec4f,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn sky(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let up = dot(normalize(view_ray(place.xy)), frame.vertical);
    return vec4f(mix(frame.horizon, frame.zenith, smoothstep(0.0, 0.7, up)), 1.0);
}

/// Light of the ground before a dark background. Shadows would not be visible on black.
const DARK_GROUND: vec3f = vec3f(0.016, 0.018, 0.020);
/// Colour of the grid and of shadows before a light background, and of the grid before a dark one.
const INK: vec3f = vec3f(0.10, 0.12, 0.16);
const LIGHT_INK: vec3f = vec3f(0.30, 0.32, 0.35);

/// The coordinates of a point along the ground.
fn along_ground(point: vec3f) -> vec2f {
    return vec2f(dot(point, frame.across), dot(point, cross(frame.across, frame.vertical)));
}

/// The ground is transparent except for its grid and the shadows on it. Both fade with the distance from the target of the
/// camera. The grid is darker than a light background and lighter than a dark one. Shadows are always darker.
@fragment
fn ground(@builtin(position) place: vec4f) -> Ground {
    let ray = view_ray(place.xy);
    let rise = dot(ray, frame.vertical);
    let distance = (frame.ground - dot(frame.eye, frame.vertical)) / rise;
    let point = frame.eye + distance * ray;
    // Before any fragment is discarded, because derivatives need all four pixels of a quad.
    let on_ground = along_ground(point);
    let width = fwidth(on_ground);
    if distance <= 0.0 || rise == 0.0 {
        discard;
    }
    let reach = length(on_ground - along_ground(frame.centre)) / frame.centre_distance;
    let fading = exp(-1.2 * reach * reach);
    let lines = 0.18 * grid_at(on_ground, width);
    let shade = 0.55 * (1.0 - sunlight(point, frame.vertical, TAPS));
    let brightness = dot(frame.horizon, vec3f(0.2126, 0.7152, 0.0722));
    let night = 1.0 - smoothstep(0.05, 0.25, brightness);
    let lit = mix(night * DARK_GROUND, mix(INK, LIGHT_INK, night), lines);
    let shadow = INK * min(1.5 * brightness, 1.0);
    let opacity = (1.0 - (1.0 - lines) * (1.0 - shade)) * fading;
    var ground: Ground;
    // The light of the ground adds to the background: it has no opacity of its own.
    ground.colour = vec4f(mix(lit, shadow, shade) * fading, opacity);
    ground.depth = depth_at(point);
    return ground;
}
