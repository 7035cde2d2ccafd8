// Selects the spheres to draw: near and far spheres in the picture, and spheres in the shadow map. Of spheres with a radius
// below about a third of a pixel only a random subset is drawn, enlarged to that radius. In large scenes `cull` selects the
// spheres that were visible in the last frame, and `uncover` those of the others that these do not hide.

struct Draw {
    vertices: u32,
    instances: atomic<u32>,
    first_vertex: u32,
    first_instance: u32,
}

const LISTS: u32 = 5u;

/// Memory slots of the spheres in each list: near, far, in the shadow map, and near and far spheres that were hidden in the
/// last frame. Each list has room for all spheres.
@group(0) @binding(9) var<storage, read_write> lists: array<u32>;
@group(0) @binding(10) var<storage, read_write> draws: array<Draw, LISTS>;
/// 1 for every sphere that was visible in the last frame.
@group(0) @binding(11) var<storage, read_write> visible: array<u32>;
/// The depth pyramid: the farthest depth of blocks of 2 by 2 pixels on level 0, 4 by 4 on level 1, ...
@group(1) @binding(0) var farthest: texture_2d<f32>;

const NEAR: u32 = 1u;
const FAR: u32 = 2u;
const SHADOW: u32 = 4u;
/// Shift from the bit of a list to that of the list of the second pass.
const SECOND: u32 = 3u;

/// Radius in pixels below which spheres are drawn as discs.
const FAR_RADIUS: f32 = 2.0;
/// Least radius in pixels of a drawn sphere. Of smaller spheres only some are drawn, with this radius.
const LEAST_RADIUS: f32 = 0.35;

var<workgroup> counts: array<atomic<u32>, LISTS>;
var<workgroup> firsts: array<u32, LISTS>;

/// Whether a sphere is in the random subset that is drawn; `radius` and `least` are in pixels. The subset has a fraction
/// (radius / least)² of the spheres, so that discs of radius `least` cover the same area.
fn is_sampled(slot: u32, radius: f32, least: f32) -> bool {
    let part = radius / least;
    return part >= 1.0 || hash(insertion_index(slot)) < part * part;
}

fn in_picture(slot: u32, ball: vec4f) -> u32 {
    let offset = ball.xyz - frame.eye;
    let ahead = dot(offset, frame.forward);
    let slopes = frame.tangent * vec2f(frame.aspect, 1.0);
    let aside = abs(vec2f(dot(offset, frame.right), dot(offset, frame.up)));
    let room = slopes * ahead + ball.w * sqrt(1.0 + slopes * slopes);
    if ahead + ball.w < frame.near || any(aside > room) {
        return 0u;
    }
    let radius = ball.w / (max(ahead, frame.near) * pixel_width());
    if radius >= FAR_RADIUS {
        return NEAR;
    }
    return select(0u, FAR, is_sampled(slot, radius, LEAST_RADIUS));
}

fn in_light(slot: u32, ball: vec4f) -> u32 {
    let place = frame.light_projection * vec4f(ball.xyz, 1.0);
    let texels = ball.w / frame.light_texel;
    let room = 1.0 + 2.0 * texels / frame.light_size;
    let in_map = (frame.flags & SHADOWS) != 0u && all(abs(place.xy) < vec2f(room)) && is_sampled(slot, texels, LEAST_SHADOW);
    return select(0u, SHADOW, in_map);
}

/// Whether the whole of a sphere lies behind what has been drawn.
fn is_hidden(ball: vec4f) -> bool {
    let offset = ball.xyz - frame.eye;
    let ahead = dot(offset, frame.forward);
    let front = ahead - ball.w;
    if front <= frame.near {
        return false;
    }
    let aside = vec2f(dot(offset, frame.right), -dot(offset, frame.up));
    let slope = aside / ahead;
    let centre = 0.5 * frame.viewport + slope / pixel_width();
    // The outline is an ellipse, longer the farther it is from the middle of the picture. One pixel is added for the edges.
    let reach = ball.w * sqrt(1.0 + dot(slope, slope)) / (front * pixel_width()) + 1.0;
    let low = max((centre - reach) * 0.5, vec2f(0.0));
    let high = max((centre + reach) * 0.5, vec2f(0.0));
    // The level on which at most two blocks along each axis contain the outline.
    let level = min(u32(ceil(log2(max(max(high.x - low.x, high.y - low.y), 1.0)))), textureNumLevels(farthest) - 1u);
    let last = textureDimensions(farthest, level) - 1u;
    let first_block = min(vec2u(low) >> vec2u(level), last);
    let last_block = min(vec2u(high) >> vec2u(level), last);
    var depth = 1.0;
    for (var y = first_block.y; y <= last_block.y; y++) {
        for (var x = first_block.x; x <= last_block.x; x++) {
            depth = min(depth, textureLoad(farthest, vec2u(x, y), level).r);
        }
    }
    return frame.near / front < depth;
}

fn slot_of_thread(group: vec3u, groups: vec3u, local: u32) -> u32 {
    return 256u * (group.x + group.y * groups.x) + local;
}

/// Appends a sphere to the lists whose bits are set in `wanted`.
fn append(slot: u32, wanted: u32, local: u32) {
    var places: array<u32, LISTS>;
    for (var list = 0u; list < LISTS; list++) {
        if (wanted & (1u << list)) != 0u {
            places[list] = atomicAdd(&counts[list], 1u);
        }
    }
    workgroupBarrier();
    if local < LISTS {
        firsts[local] = atomicAdd(&draws[local].instances, atomicLoad(&counts[local]));
    }
    workgroupBarrier();
    for (var list = 0u; list < LISTS; list++) {
        if (wanted & (1u << list)) != 0u {
            lists[list * frame.spheres + firsts[list] + places[list]] = slot;
        }
    }
}

@compute @workgroup_size(256)
fn cull(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = slot_of_thread(group, groups, local);
    var wanted = 0u;
    if slot < frame.spheres && !in_capsule(slot) && box_word(slot) == 0u {
        let ball = ball(slot);
        wanted = in_light(slot, ball);
        if (frame.flags & CULL_HIDDEN) == 0u || visible[slot] != 0u {
            wanted |= in_picture(slot, ball);
        }
    }
    append(slot, wanted, local);
}

@compute @workgroup_size(256)
fn uncover(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = slot_of_thread(group, groups, local);
    var wanted = 0u;
    if slot < frame.spheres && !in_capsule(slot) && box_word(slot) == 0u {
        let ball = ball(slot);
        wanted = in_picture(slot, ball) << SECOND;
        if wanted != 0u && is_hidden(ball) {
            wanted = 0u;
        }
        let was_visible = visible[slot] != 0u;
        visible[slot] = select(0u, 1u, wanted != 0u);
        if was_visible {
        // It was drawn in the first pass.
            wanted = 0u;
        }
    }
    append(slot, wanted, local);
}
