// Which spheres are worth drawing: those in the picture, far ones in a cheaper way, and those that the sun sees. Where
// spheres are smaller than a third of a pixel, some stand for all of them.

struct Draw {
    vertices: u32,
    instances: atomic<u32>,
    first_vertex: u32,
    first_instance: u32,
}

/// Slots of spheres: near ones, far ones, those with a shadow; each with room for all.
@group(0) @binding(9) var<storage, read_write> lists: array<u32>;
@group(0) @binding(10) var<storage, read_write> draws: array<Draw, 3>;

const NEAR: u32 = 1u;
const FAR: u32 = 2u;
const SHADOW: u32 = 4u;

/// In pixels: smaller spheres are drawn as discs.
const FAR_RADIUS: f32 = 2.0;
/// In pixels: of smaller spheres some are drawn, as if they were this large.
const LEAST_RADIUS: f32 = 0.35;

var<workgroup> counts: array<atomic<u32>, 3>;
var<workgroup> firsts: array<u32, 3>;

/// Whether a sphere of this radius in pixels is among those that are drawn.
fn stands(slot: u32, radius: f32) -> bool {
    let part = radius / LEAST_RADIUS;
    return part >= 1.0 || hash(user_of(slot)) < part * part;
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
    return select(0u, FAR, stands(slot, radius));
}

fn in_light(slot: u32, ball: vec4f) -> u32 {
    let place = frame.light_projection * vec4f(ball.xyz, 1.0);
    let texels = ball.w / frame.light_texel;
    let room = 1.0 + 2.0 * texels / frame.light_size;
    let seen = (frame.flags & SHADOWS) != 0u && all(abs(place.xy) < vec2f(room)) && stands(slot, texels);
    return select(0u, SHADOW, seen);
}

@compute @workgroup_size(256)
fn cull(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = 256u * (group.x + group.y * groups.x) + local;
    var wanted = 0u;
    if slot < frame.spheres && !in_capsule(slot) {
        let ball = ball(slot);
        wanted = in_picture(slot, ball) | in_light(slot, ball);
    }
    var places: array<u32, 3>;
    for (var list = 0u; list < 3u; list++) {
        if (wanted & (1u << list)) != 0u {
            places[list] = atomicAdd(&counts[list], 1u);
        }
    }
    workgroupBarrier();
    if local < 3u {
        firsts[local] = atomicAdd(&draws[local].instances, atomicLoad(&counts[local]));
    }
    workgroupBarrier();
    for (var list = 0u; list < 3u; list++) {
        if (wanted & (1u << list)) != 0u {
            lists[list * frame.spheres + firsts[list] + places[list]] = slot;
        }
    }
}
