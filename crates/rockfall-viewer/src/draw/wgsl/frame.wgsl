// What every shader of the renderer sees: the frame, and the physics' buffers. `frame.rs` has the Rust side.

struct Frame {
    view_projection: mat4x4f,
    light_projection: mat4x4f,
    eye: vec3f,
    near: f32,
    right: vec3f,
    tangent: f32,
    up: vec3f,
    aspect: f32,
    forward: vec3f,
    blend: f32,
    light: vec3f,
    light_texel: f32,
    light_right: vec3f,
    light_depth: f32,
    light_up: vec3f,
    cell: f32,
    centre: vec3f,
    centre_distance: f32,
    horizon: vec3f,
    ground: f32,
    zenith: vec3f,
    typical_radius: f32,
    viewport: vec2f,
    range: vec2f,
    cell_fade: f32,
    coil_pieces: u32,
    coil_sides: u32,
    flags: u32,
    spheres: u32,
    rods: u32,
    springs: u32,
    tethers: u32,
    rods_at: u32,
    springs_at: u32,
    tethers_at: u32,
    boxes_at: u32,
    polygons_at: u32,
    insertion_indices_at: u32,
    colour_by: u32,
    light_size: f32,
    kinds: array<vec4f, 8>,
    scale: array<vec4f, 9>,
}

const SHADOWS: u32 = 1u;
const OCCLUSION: u32 = 2u;
const COVERING: u32 = 4u;

/// In pixels of the shadow map: of smaller spheres some cast a shadow, as if they were this large. The filter blurs more.
const LEAST_SHADOW: f32 = 2.0;

const BY_KIND: u32 = 0u;
const BY_SPEED: u32 = 1u;

const KIND_SPHERE: u32 = 0u;
const KIND_FIXED: u32 = 1u;
const KIND_ROD: u32 = 2u;
const KIND_CAPSULE: u32 = 3u;
const KIND_SPRING: u32 = 4u;
const KIND_TETHER: u32 = 5u;
const KIND_BOX: u32 = 6u;
const KIND_POLYGON: u32 = 7u;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> state: array<vec4f>;
@group(0) @binding(2) var<storage, read> orientations: array<vec4f>;
@group(0) @binding(3) var<storage, read> words: array<u32>;
@group(0) @binding(4) var<storage, read> old_positions: array<vec4f>;
@group(0) @binding(5) var<storage, read> old_orientations: array<vec4f>;
@group(0) @binding(6) var<storage, read> values: array<f32>;
@group(0) @binding(7) var<storage, read> marks: array<u32>;
/// How opaque each box is.
@group(0) @binding(8) var<storage, read> opacities: array<f32>;

fn word_float(at: u32) -> f32 {
    return bitcast<f32>(words[at]);
}

fn word_vector(at: u32) -> vec3f {
    return vec3f(word_float(at), word_float(at + 1u), word_float(at + 2u));
}

/// Centre and radius.
fn ball(slot: u32) -> vec4f {
    let now = state[slot];
    if frame.blend >= 1.0 {
        return now;
    }
    return vec4f(mix(old_positions[slot].xyz, now.xyz, frame.blend), now.w);
}

fn orientation(slot: u32) -> vec4f {
    let now = orientations[slot];
    if frame.blend >= 1.0 {
        return now;
    }
    // The short way round.
    let old = old_orientations[slot];
    return normalize(mix(old * select(-1.0, 1.0, dot(old, now) >= 0.0), now, frame.blend));
}

fn insertion_index(slot: u32) -> u32 {
    if frame.insertion_indices_at == 0u {
        return slot;
    }
    return words[frame.insertion_indices_at + slot];
}

fn is_fixed(slot: u32) -> bool {
    return state[frame.spheres + slot].w == 0.0;
}

/// The mark of an object: bit k of `marks`, from word `at` on.
fn marked(at: u32, index: u32) -> bool {
    return ((marks[at + index / 32u] >> (index % 32u)) & 1u) != 0u;
}

/// Spheres that are the end of a capsule, in order of addition.
fn in_capsule(slot: u32) -> bool {
    return marked(0u, insertion_index(slot));
}

/// Rods that are the middle of a capsule.
fn is_capsule(rod: u32) -> bool {
    return marked((frame.spheres + 31u) / 32u, rod);
}

/// v in the frame of a body with this orientation.
fn to_body(q: vec4f, v: vec3f) -> vec3f {
    let t = 2.0 * cross(v, q.xyz);
    return v + q.w * t + cross(t, q.xyz);
}

/// Direction from the eye through a place in the picture, in pixels from its upper left corner; 1 along `forward`.
fn view_ray(place: vec2f) -> vec3f {
    let ndc = vec2f(2.0, -2.0) * place / frame.viewport + vec2f(-1.0, 1.0);
    return frame.forward + frame.tangent * (frame.aspect * ndc.x * frame.right + ndc.y * frame.up);
}

/// Width of a pixel at distance 1.
fn pixel_width() -> f32 {
    return 2.0 * frame.tangent / frame.viewport.y;
}

fn depth_at(point: vec3f) -> f32 {
    return frame.near / dot(point - frame.eye, frame.forward);
}

/// Where the four samples of a pixel lie (the standard places of Vulkan, Metal and DX12), from its centre.
fn sample_place(index: u32) -> vec2f {
    switch index {
        case 0u: { return vec2f(-0.125, -0.375); }
        case 1u: { return vec2f(0.375, -0.125); }
        case 2u: { return vec2f(-0.375, 0.125); }
        default: { return vec2f(0.125, 0.375); }
    }
}
