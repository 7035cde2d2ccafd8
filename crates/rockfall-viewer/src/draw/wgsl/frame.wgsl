// Bindings of all shaders of the renderer: the uniform block, declared in Rust in `frame.rs`, and the buffers of the physics.

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
    coil_segments: u32,
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
    /// Period along each axis, 0 where the scene is not periodic.
    period: vec3f,
    /// First word of the table of parts of boxes of rigid bodies; 0 without any.
    rigid_parts_at: u32,
    /// Least corner of the box of a periodic scene.
    least: vec3f,
    /// Half the edge of the squares that stand for planes, in units.
    stage_size: f32,
    /// The point near which planes are shown.
    stage: vec3f,
    /// Unit vector upwards.
    vertical: vec3f,
    /// Unit vector along the ground, to the right as seen from the front.
    across: vec3f,
    kinds: array<vec4f, 8>,
    scale: array<vec4f, 9>,
}

const SHADOWS: u32 = 1u;
const OCCLUSION: u32 = 2u;
const CULL_HIDDEN: u32 = 4u;
const LOOKS: u32 = 8u;

/// Least radius of a shadow, in pixels of the shadow map. Of smaller spheres only some cast a shadow, of this radius. The
/// filter is wider, so the difference is not visible.
const LEAST_SHADOW: f32 = 2.0;

const BY_KIND: u32 = 0u;
const BY_SPEED: u32 = 1u;
const BY_BODY: u32 = 5u;
const BY_CONTACT_FORCE: u32 = 6u;
const BY_TENSION: u32 = 7u;

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
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> old_positions: array<vec4f>;
@group(0) @binding(5) var<storage, read> old_orientations: array<vec4f>;
@group(0) @binding(6) var<storage, read> values: array<f32>;
@group(0) @binding(7) var<storage, read> capsule_bits: array<u32>;
/// For each box, then for each polygon: 1 if it is drawn, 0 if only its edges are, 2 if only its edges and its shadow are.
@group(0) @binding(8) var<storage, read> drawn: array<u32>;

fn topology_float(at: u32) -> f32 {
    return bitcast<f32>(topology[at]);
}

fn topology_vector(at: u32) -> vec3f {
    return vec3f(topology_float(at), topology_float(at + 1u), topology_float(at + 2u));
}

/// Centre and radius of a sphere, as it is in the state.
fn ball_of_state(slot: u32) -> vec4f {
    let now = state[slot];
    if frame.blend >= 1.0 {
        return now;
    }
    return vec4f(mix(old_positions[slot].xyz, now.xyz, frame.blend), now.w);
}

/// Whole periods, for a number of them along each axis. The number along axes without a period does not matter.
fn periods(count: vec3f) -> vec3f {
    return select(vec3f(0.0), frame.period * count, frame.period > vec3f(0.0));
}

/// Centre and radius of a sphere: the image in the box of a periodic scene.
fn ball(slot: u32) -> vec4f {
    let own = ball_of_state(slot);
    return vec4f(own.xyz - periods(floor((own.xyz - frame.least) / max(frame.period, vec3f(1e-30)))), own.w);
}

/// Centre and radius of a sphere: the image next to a place.
fn ball_beside(slot: u32, place: vec3f) -> vec4f {
    let own = ball_of_state(slot);
    return vec4f(own.xyz - periods(round((own.xyz - place) / max(frame.period, vec3f(1e-30)))), own.w);
}

fn orientation(slot: u32) -> vec4f {
    let now = orientations[slot];
    if frame.blend >= 1.0 {
        return now;
    }
    // Along the shorter rotation.
    let old = old_orientations[slot];
    return normalize(mix(old * select(-1.0, 1.0, dot(old, now) >= 0.0), now, frame.blend));
}

fn insertion_index(slot: u32) -> u32 {
    if frame.insertion_indices_at == 0u {
        return slot;
    }
    return topology[frame.insertion_indices_at + slot];
}

const HULL_PART: u32 = 0x40000000u;

/// The box or hull of a rigid body that a sphere stands for: 0 for none, otherwise the first word of the box, or that of
/// the hull with HULL_PART.
fn box_word(slot: u32) -> u32 {
    if frame.rigid_parts_at == 0u {
        return 0u;
    }
    return topology[frame.rigid_parts_at + insertion_index(slot)];
}

fn is_fixed(slot: u32) -> bool {
    return state[frame.spheres + slot].w == 0.0;
}

/// Returns how polygon `number` is drawn. The words of the polygons follow those of the boxes.
fn polygon_drawn(number: u32) -> u32 {
    return drawn[(frame.polygons_at - frame.boxes_at) / 12u + number];
}

/// Returns bit `index` of the bits in `capsule_bits` that begin at word `at`.
fn capsule_bit(at: u32, index: u32) -> bool {
return ((capsule_bits[at + index / 32u] >> (index % 32u)) & 1u) != 0u;
}

/// Whether a sphere is an end of a capsule.
fn in_capsule(slot: u32) -> bool {
return capsule_bit(0u, insertion_index(slot));
}

/// Whether a rod is the middle of a capsule.
fn is_capsule(rod: u32) -> bool {
return capsule_bit((frame.spheres + 31u) / 32u, rod);
}

/// Rotates `v` from the world frame to the frame of a body with orientation `q`.
fn to_body(q: vec4f, v: vec3f) -> vec3f {
    let t = 2.0 * cross(v, q.xyz);
    return v + q.w * t + cross(t, q.xyz);
}

/// Returns the direction from the eye through a point of the picture, in pixels from the upper left corner. Its component along
/// `forward` is 1.
fn view_ray(place: vec2f) -> vec3f {
    let ndc = vec2f(2.0, -2.0) * place / frame.viewport + vec2f(-1.0, 1.0);
    return frame.forward + frame.tangent * (frame.aspect * ndc.x * frame.right + ndc.y * frame.up);
}

/// Returns the width of a pixel at distance 1.
fn pixel_width() -> f32 {
    return 2.0 * frame.tangent / frame.viewport.y;
}

fn depth_at(point: vec3f) -> f32 {
    return frame.near / dot(point - frame.eye, frame.forward);
}

/// Returns the position of a sample of a pixel relative to its centre (the standard positions of Vulkan, Metal and DX12).
fn sample_place(index: u32) -> vec2f {
    switch index {
        case 0u: { return vec2f(-0.125, -0.375); }
        case 1u: { return vec2f(0.375, -0.125); }
        case 2u: { return vec2f(-0.375, 0.125); }
        default: { return vec2f(0.125, 0.375); }
    }
}
