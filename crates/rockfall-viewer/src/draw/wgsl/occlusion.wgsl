// Ambient occlusion from the depths of the picture (scalable ambient obscurance, McGuire et al. 2012).

@group(1) @binding(0) var depths: texture_depth_multisampled_2d;

const SAMPLES: u32 = 14u;

/// The point that is visible in a pixel: its position relative to the eye, and its distance along `forward`, 0 for the sky.
struct Seen {
    place: vec3f,
    distance: f32,
}

fn seen_at(pixel: vec2i) -> Seen {
    let inside = clamp(pixel, vec2i(0), vec2i(frame.viewport) - 1);
    let depth = textureLoad(depths, inside, 0);
    if depth <= 0.0 {
        return Seen(vec3f(0.0), 0.0);
    }
    let distance = frame.near / depth;
    return Seen(distance * view_ray(vec2f(inside) + 0.5), distance);
}

/// Returns the difference to a neighbouring pixel on the side where the surface continues, not where another surface begins.
fn slope(here: Seen, before: Seen, after: Seen) -> vec3f {
    let back = abs(here.distance - before.distance);
    let on = abs(after.distance - here.distance);
    let use_back = after.distance == 0.0 || (before.distance > 0.0 && back < on);
    return select(after.place - here.place, here.place - before.place, use_back);
}

@fragment
fn occlusion(@builtin(position) place: vec4f) -> @location(0) f32 {
    let pixel = vec2i(place.xy);
    let here = seen_at(pixel);
    if here.distance == 0.0 {
        return 1.0;
    }
    let across = slope(here, seen_at(pixel - vec2i(1, 0)), seen_at(pixel + vec2i(1, 0)));
    let down = slope(here, seen_at(pixel - vec2i(0, 1)), seen_at(pixel + vec2i(0, 1)));
    let normal = normalize(cross(down, across));
    let pixel_size = here.distance * pixel_width();
    // As wide as the gaps between bodies, within limits in pixels so that the effect is visible.
    let reach = clamp(1.6 * frame.typical_radius, 6.0 * pixel_size, 0.08 * frame.viewport.y * pixel_size);
    // The spiral has a different rotation in each pixel of a block of 4 by 4 pixels; the last pass averages over the block.
    let turn = 6.2831853 / 16.0 * f32(((pixel.x & 3) * 4 + (pixel.y & 3) * 7) & 15);
    var dark = 0.0;
    for (var index = 0u; index < SAMPLES; index++) {
        let part = (f32(index) + 0.5) / f32(SAMPLES);
        let angle = turn + 2.3999632 * f32(index);
        let offset = part * reach / pixel_size * vec2f(cos(angle), sin(angle));
        let other = seen_at(pixel + vec2i(round(offset)));
        let apart = other.place - here.place;
        let square = dot(apart, apart);
        let near = max(reach * reach - square, 0.0) / (reach * reach);
        let high = max(dot(apart, normal) - 0.02 * reach, 0.0);
        dark += select(0.0, near * near * high * reach / (square + 0.02 * reach * reach), other.distance > 0.0);
    }
    return clamp(1.0 - 1.5 * dark / f32(SAMPLES), 0.0, 1.0);
}
