// From light to a picture: the last pass.

@group(1) @binding(0) var light: texture_2d<f32>;

@vertex
fn whole_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u((index << 1u) & 2u, index & 2u)) * 2.0 - 1.0, 0.0, 1.0);
}

/// Linear light to the curve of sRGB (IEC 61966-2-1).
fn encoded(linear: vec3f) -> vec3f {
    let low = 12.92 * linear;
    let high = 1.055 * pow(max(linear, vec3f(0.0)), vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, linear <= vec3f(0.0031308));
}

/// 1 where the target encodes by itself.
override ENCODES: bool = false;

@fragment
fn finish(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let colour = textureLoad(light, vec2u(place.xy), 0).rgb;
    let shown = clamp(colour, vec3f(0.0), vec3f(1.0));
    if ENCODES {
        return vec4f(shown, 1.0);
    }
    return vec4f(encoded(shown), 1.0);
}
