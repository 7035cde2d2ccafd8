// The last pass: multiplies light by openness and encodes it as the final picture.

@group(1) @binding(0) var light: texture_2d<f32>;
@group(1) @binding(1) var openness: texture_2d<f32>;
@group(1) @binding(2) var depths: texture_depth_multisampled_2d;

/// Encodes linear light as sRGB (IEC 61966-2-1).
fn encoded(linear: vec3f) -> vec3f {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(0.0)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

/// Returns the openness to the sky, averaged over neighbouring pixels of the same surface.
fn open_sky(pixel: vec2i) -> f32 {
    let here = textureLoad(depths, pixel, 0);
    var sum = 0.0;
    var weight = 0.0;
    for (var index = 0; index < 16; index++) {
        let other = clamp(pixel + vec2i(index % 4 - 2, index / 4 - 2), vec2i(0), vec2i(frame.viewport) - 1);
        let depth = textureLoad(depths, other, 0);
        // Depths that differ by more than 3 % belong to another body.
        let alike = select(0.0, 1.0, abs(depth - here) < 0.03 * here);
        sum += alike * textureLoad(openness, other, 0).r;
        weight += alike;
    }
    return select(1.0, sum / weight, weight > 0.0);
}

/// Whether the target texture encodes linear light as sRGB by itself.
override ENCODES: bool = false;

@fragment
fn finish(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let pixel = vec2i(place.xy);
    var colour = textureLoad(light, pixel, 0).rgb;
    if (frame.flags & OCCLUSION) != 0u {
        colour *= open_sky(pixel);
    }
    let shown = clamp(colour, vec3f(0.0), vec3f(1.0));
    if ENCODES {
        return vec4f(shown, 1.0);
    }
    return vec4f(encoded(shown), 1.0);
}
