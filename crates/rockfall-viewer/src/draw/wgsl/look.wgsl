// Looks of objects (`@look`): patterns in the coordinates of the body, and glass.

const LOOK_USUAL: u32 = 0u;
const LOOK_PLAIN: u32 = 1u;
const LOOK_STRIPED: u32 = 2u;
const LOOK_WOOD: u32 = 3u;
const LOOK_STONE: u32 = 4u;
const LOOK_GLASS: u32 = 5u;

/// Returns the look of an object. The looks follow the bits of the capsules: four bits for each sphere, rod, box and polygon.
fn look_at(place: u32) -> u32 {
    if (frame.flags & LOOKS) == 0u {
        return LOOK_USUAL;
    }
    let word = (frame.spheres + 31u) / 32u + (frame.rods + 31u) / 32u + place / 8u;
    return (capsule_bits[word] >> (4u * (place % 8u))) & 15u;
}

/// Returns the look of a moving body. Shades of wood and stone would be taken for values of a scale.
fn body_look(place: u32) -> u32 {
    let look = look_at(place);
    let shaded = look == LOOK_WOOD || look == LOOK_STONE;
    return select(look, LOOK_PLAIN, shaded && frame.colour_by != BY_KIND && frame.colour_by != BY_BODY);
}

fn sphere_look(slot: u32) -> u32 {
    return body_look(insertion_index(slot));
}

fn box_look(number: u32) -> u32 {
    return look_at(frame.spheres + frame.rods + number);
}

fn polygon_look(number: u32) -> u32 {
    return box_look((frame.polygons_at - frame.boxes_at) / 12u + number);
}

/// Returns a hash of a point of the integer grid, from 0 to 1.
fn grid_hash(point: vec3i) -> f32 {
    let bits = vec3u(point);
    return hash((bits.x * 1597334677u) ^ (bits.y * 3812015801u) ^ (bits.z * 2798796415u));
}

/// Returns smooth noise from 0 to 1 with a period of about 1 unit (value noise: hashes at the points of a grid, interpolated).
fn noise(point: vec3f) -> f32 {
    let low = floor(point);
    let part = point - low;
    let weight = part * part * (3.0 - 2.0 * part);
    let at = vec3i(low);
    var sums: array<f32, 4>;
    for (var row = 0; row < 4; row++) {
        let corner = at + vec3i(0, row & 1, row >> 1u);
        sums[row] = mix(grid_hash(corner), grid_hash(corner + vec3i(1, 0, 0)), weight.x);
    }
    return mix(mix(sums[0], sums[1], weight.y), mix(sums[2], sums[3], weight.y), weight.z);
}

/// Returns how much of a detail of this size is shown, from 1 to 0 where it is as narrow as a pixel of `width`.
fn detail(width: f32, size: f32) -> f32 {
    return 1.0 - smoothstep(0.25 * size, 0.75 * size, width);
}

/// Returns the brightness of wood. The grain is along y, the rings are around that axis, about 2 per unit.
fn wood(point: vec3f, width: f32) -> f32 {
    let bent = noise(vec3f(0.9, 0.22, 0.9) * point + 7.0);
    let ring = fract(2.0 * length(point.xz) + 1.3 * bent);
    // Late wood is dark and ends abruptly.
    let late = smoothstep(0.1, 0.8, ring) * (1.0 - smoothstep(0.86, 1.0, ring));
    let fibre = noise(vec3f(16.0, 0.9, 16.0) * point) - 0.5;
    return 1.08 - 0.40 * mix(0.42, late, detail(width, 0.4)) - 0.24 * fibre * detail(width, 0.06);
}

/// Returns the product of an offset from a corner of the grid with the slope of the noise there, one of twelve directions.
fn rise(corner: vec3i, away: vec3f) -> f32 {
    let code = u32(15.99 * grid_hash(corner));
    let first = select(away.y, away.x, code < 8u);
    let second = select(select(away.z, away.x, code == 12u || code == 14u), away.y, code < 4u);
    return select(first, -first, (code & 1u) != 0u) + select(second, -second, (code & 2u) != 0u);
}

/// Returns smooth noise around 0 with a period of about 1 unit and without the blocks of `noise` (gradient noise, Perlin 2002).
fn gradient_noise(point: vec3f) -> f32 {
    let low = floor(point);
    let part = point - low;
    let weight = part * part * part * (part * (part * 6.0 - 15.0) + 10.0);
    let at = vec3i(low);
    var sums: array<f32, 4>;
    for (var row = 0; row < 4; row++) {
        let corner = vec3i(0, row & 1, row >> 1u);
        let away = part - vec3f(corner);
        sums[row] = mix(rise(at + corner, away), rise(at + corner + vec3i(1, 0, 0), away - vec3f(1.0, 0.0, 0.0)), weight.x);
    }
    return mix(mix(sums[0], sums[1], weight.y), mix(sums[2], sums[3], weight.y), weight.z);
}

/// A rotation that takes no axis near another, so that no two octaves of noise have the same grid.
const TILT: mat3x3f = mat3x3f(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6);

/// Returns the brightness of stone: noise of several sizes, and dark grains.
fn stone(point: vec3f, width: f32) -> f32 {
    var sum = 0.0;
    var size = 1.0;
    var place = TILT * (1.6 * point);
    for (var octave = 0; octave < 4; octave++) {
        sum += 0.36 * size * gradient_noise(place) * detail(width, size / 1.6);
        size *= 0.55;
        place = TILT * (place / 0.55 + 13.0);
    }
    let grains = smoothstep(0.30, 0.50, gradient_noise(TILT * (12.0 * point))) * detail(width, 0.08);
    return 0.97 + sum - 0.34 * grains;
}

/// Returns the brightness of a look at a point in the coordinates of the body.
fn shade_of(look: u32, point: vec3f, width: f32) -> f32 {
    switch look {
        case LOOK_WOOD: { return wood(point, width); }
        case LOOK_STONE: { return stone(point, width); }
        default: { return 1.0; }
    }
}

/// Returns the weight of the second tone of stripes across y, each a unit wide.
fn stripes(along: f32, width: f32) -> f32 {
    let wave = abs(fract(0.5 * along) - 0.5) * 2.0 - 0.5;
    return mix(smoothstep(-0.5 * width, 0.5 * width, wave), 0.5, smoothstep(0.3, 1.0, width));
}

/// Offset of the pattern of a body, so that no two look alike.
fn pattern_offset(number: u32) -> vec3f {
    return vec3f(0.7, 0.0, 0.4) + 5.0 * vec3f(0.0, hash(number), hash(number + 7919u));
}

/// Returns the light of glass with its opacity. `edge` is the coverage of an edge, from 0 to 1. `view` is the unit vector
/// towards the eye.
fn glass(colour: vec3f, normal: vec3f, view: vec3f, edge: f32) -> vec4f {
    let facing = abs(dot(normal, view));
    let graze = pow(1.0 - facing, 3.0);
    let opacity = mix(mix(0.07, 0.55, graze), 0.80, edge);
    let sky = mix(frame.horizon, frame.zenith, smoothstep(-0.3, 0.7, dot(reflect(-view, normal), frame.vertical)));
    let body = mix(mix(0.78 * colour, sky, 0.35 * graze), 0.38 * colour, edge);
    let half_way = normalize(view + frame.light);
    let gloss = 0.7 * pow(abs(dot(normal, half_way)), 160.0) * (1.0 - edge);
    return vec4f(body * opacity + gloss, min(opacity + gloss, 1.0));
}

/// Returns the coverage of the edge of a round body of glass, which bends the light most at its outline.
fn glass_rim(normal: vec3f, ray: vec3f) -> f32 {
    let facing = clamp(-dot(normal, ray), 0.0, 1.0);
    return 0.8 * (1.0 - smoothstep(0.05, 0.5, facing));
}

/// Whether a pixel of the shadow map lets the light through glass. A fifth of them do not.
fn is_lit_through(look: u32, place: vec4f) -> bool {
    let pixel = vec2u(place.xy);
    return look == LOOK_GLASS && (pixel.x + 2u * pixel.y) % 5u != 0u;
}
