// Colours and patterns of bodies.

/// PCG hash (Jarzynski and Olano 2020), from 0 to 1.
fn hash(index: u32) -> f32 {
    let state = index * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return f32(((word >> 22u) ^ word) & 0xffffu) / 65535.0;
}

/// Colour of the bodies behind force chains, and of those beside springs that are coloured by their tension.
const PALE: vec3f = vec3f(0.62, 0.64, 0.66);

/// Whether bodies are pale, because colours show forces between them.
fn is_pale() -> bool {
    return frame.colour_by == BY_CONTACT_FORCE || frame.colour_by == BY_TENSION;
}

fn value_of(slot: u32) -> f32 {
    if frame.colour_by == BY_SPEED {
        return length(state[frame.spheres + slot].xyz);
    }
    return values[slot];
}

/// Returns the colour of a value on the scale.
fn scale_colour(value: f32) -> vec3f {
    let place = 8.0 * clamp((value - frame.range.x) / max(frame.range.y - frame.range.x, 1e-30), 0.0, 1.0);
    let stop = min(u32(place), 7u);
    return mix(frame.scale[stop].rgb, frame.scale[stop + 1u].rgb, place - f32(stop));
}

/// Returns the colour in `values` at a place, and 1 if there is one. A value is 1 + 65536 red + 256 green + blue in sRGB.
fn colour_at(place: u32) -> vec4f {
    let value = values[place];
    if (frame.colour_by != BY_KIND && frame.colour_by != BY_BODY) || value < 1.0 {
        return vec4f(0.0);
    }
    let bits = u32(value) - 1u;
    let encoded = vec3f(vec3u(bits >> 16u, (bits >> 8u) & 255u, bits & 255u)) / 255.0;
    let linear = select(pow((encoded + 0.055) / 1.055, vec3f(2.4)), encoded / 12.92, encoded <= vec3f(0.04045));
    return vec4f(linear, 1.0);
}

/// Returns the colour that was given to a sphere, and 1 if there is one.
fn own_colour(slot: u32) -> vec4f {
    return colour_at(slot);
}

/// Returns the colour that was given to an object, or else that of its kind. The colours follow the values of the spheres: those of
/// rods, springs, boxes and polygons.
fn object_colour(kind: u32, number: u32) -> vec3f {
    var place = frame.spheres + number;
    if kind == KIND_SPRING {
        place += frame.rods;
    } else if kind == KIND_BOX {
        place += frame.rods + frame.springs;
    } else if kind == KIND_POLYGON {
        place += frame.rods + frame.springs + (frame.polygons_at - frame.boxes_at) / 12u;
    }
    if kind == KIND_SPRING && frame.colour_by == BY_TENSION {
        return scale_colour(values[place]);
    }
    let own = colour_at(place);
    return select(frame.kinds[kind].rgb, own.rgb, own.a > 0.0);
}

/// Returns the colour of a tether, whose tension follows those of the springs.
fn tether_colour(number: u32) -> vec3f {
    if frame.colour_by != BY_TENSION {
        return frame.kinds[KIND_TETHER].rgb;
    }
    return scale_colour(values[frame.spheres + frame.rods + frame.springs + number]);
}

/// Returns one of many colours that are easy to tell apart for successive numbers.
fn distinct_colour(number: u32) -> vec3f {
    let hue = 6.2831853 * fract(0.61803399 * f32(number % 65536u));
    let tone = 0.30 + 0.22 * cos(hue - vec3f(0.0, 2.0943951, 4.1887902));
    return tone * (0.75 + 0.5 * hash(number));
}

/// Whether a body is coloured by a value on the scale.
fn is_on_scale() -> bool {
    return frame.colour_by != BY_KIND && frame.colour_by != BY_BODY && !is_pale();
}

fn sphere_colour(slot: u32) -> vec3f {
    if is_on_scale() {
        return scale_colour(value_of(slot));
    }
    let own = own_colour(slot);
    if own.a > 0.0 {
        return own.rgb;
    }
    if is_pale() {
        return select(PALE, 0.6 * PALE, is_fixed(slot));
    }
    if frame.colour_by == BY_BODY && !is_fixed(slot) {
        return distinct_colour(insertion_index(slot));
    }
    if is_fixed(slot) {
        return frame.kinds[KIND_FIXED].rgb;
    }
    // The brightness varies, so that neighbours can be told apart.
    return frame.kinds[KIND_SPHERE].rgb * (0.86 + 0.28 * hash(insertion_index(slot)));
}

/// Returns the second tone of a body's pattern.
fn second_tone(colour: vec3f) -> vec3f {
    if is_on_scale() {
        return 0.62 * colour;
    }
    if is_pale() {
        return 0.9 * colour;
    }
    return mix(colour, vec3f(0.93, 0.90, 0.84), 0.82);
}

/// Returns the second tone of a sphere. Of a few bodies the pattern shows how each one turns; in a crowd it is fainter, so that it
/// does not cover the shapes. A fixed sphere has none, and neither have most looks.
fn sphere_tone(slot: u32, look: u32, colour: vec3f) -> vec3f {
    if look == LOOK_STRIPED {
        return second_tone(colour);
    }
    if look != LOOK_USUAL || is_fixed(slot) {
        return colour;
    }
    let crowd = smoothstep(5.0, 9.0, log2(f32(frame.spheres)));
    return mix(second_tone(colour), colour, 0.7 * crowd);
}

/// Returns the weight of the second tone in the pattern of a beach ball: six sectors of alternating tones around the body's y
/// axis, and a cap at each pole. `width` is the width of a pixel on the unit sphere.
fn beach_ball(n: vec3f, width: f32) -> f32 {
    let ring = length(n.xz);
    let angle = atan2(n.z, n.x);
    // Distance from the edge of a sector. The factor `ring` keeps the blur even from the equator to the poles.
    let sector = sin(3.0 * angle) / 3.0 * ring;
    let stripes = smoothstep(-width, width, sector);
    let cap = smoothstep(0.30 + width, 0.30 - width, ring);
    let upper = select(0.0, 1.0, n.y > 0.0);
    // Far away, where a sector is no wider than a pixel, both tones are mixed.
    return mix(mix(stripes, upper, cap), 0.5, smoothstep(0.1, 0.5, width));
}
