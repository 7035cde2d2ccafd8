// Lighting of surfaces.

@group(1) @binding(0) var shadows: texture_depth_2d;
@group(1) @binding(1) var nearer: sampler_comparison;

/// Number of samples of the shadow filter.
const TAPS: u32 = 16u;

/// Returns the visible fraction of the sun at a point, from 0 to 1 (percentage-closer filtering, Reeves et al. 1987, on a Vogel
/// spiral).
fn sunlight(point: vec3f, normal: vec3f, taps: u32) -> f32 {
    if (frame.flags & SHADOWS) == 0u {
        return 1.0;
    }
    // The point is moved away from the surface, more at grazing light, so that the surface does not shade itself.
    let graze = 1.0 - max(dot(normal, frame.light), 0.0);
    let place = frame.light_projection * vec4f(point + frame.light_texel * (1.5 + 3.0 * graze) * normal, 1.0);
    let middle = vec2f(0.5, -0.5) * place.xy + 0.5;
    let depth = min(place.z, 1.0);
    let spread = 2.2 / f32(textureDimensions(shadows).x);
    var seen = 0.0;
    for (var tap = 0u; tap < taps; tap++) {
        let radius = spread * sqrt(f32(tap) + 0.5);
        let angle = 2.3999632 * f32(tap);
        seen += textureSampleCompareLevel(shadows, nearer, middle + radius * vec2f(cos(angle), sin(angle)), depth);
    }
    // Everything outside the map is lit.
    let edge = max(abs(place.x), abs(place.y));
    return mix(seen / f32(taps), 1.0, smoothstep(0.9, 1.0, edge));
}

/// Gloss of most surfaces.
const GLOSS: f32 = 0.08;

/// Returns the gloss of a look.
fn gloss_of(look: u32) -> f32 {
    return select(GLOSS, 0.0, look == LOOK_STONE);
}

/// Returns the light that a surface reflects: from the whole sky, with more from above, and from the sun. `view` is the unit
/// vector towards the eye.
fn lit(colour: vec3f, point: vec3f, normal: vec3f, view: vec3f, gloss: f32) -> vec3f {
    return lit_roughly(colour, point, normal, view, gloss, TAPS);
}

/// Returns the same with this number of samples of the shadow filter.
fn lit_roughly(colour: vec3f, point: vec3f, normal: vec3f, view: vec3f, gloss: f32, taps: u32) -> vec3f {
    let sky = mix(vec3f(0.25, 0.245, 0.24), vec3f(0.43, 0.46, 0.50), 0.5 + 0.5 * dot(normal, frame.vertical));
    let towards = dot(normal, frame.light);
    var sun = 0.0;
    if towards > 0.0 {
        sun = sunlight(point, normal, taps);
    }
    let half_way = normalize(view + frame.light);
    let shine = gloss * pow(max(dot(normal, half_way), 0.0), 40.0) * sun;
    let rim = 0.625 * gloss * pow(1.0 - max(dot(normal, view), 0.0), 3.0);
    return colour * (sky + max(towards, 0.0) * sun * vec3f(0.82, 0.79, 0.73)) + vec3f(shine + rim);
}
