// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/geometry.wgsl physics/passage.wgsl
// requires physics/period.wgsl physics/smooth.wgsl physics/walls.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> y2: array<vec4f>;
@group(0) @binding(4) var<storage, read> y3: array<vec4f>;
@group(0) @binding(5) var<storage, read> y4: array<vec4f>;
@group(0) @binding(6) var<storage, read> topology: array<u32>;
@group(0) @binding(7) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// The way of a sphere in the step.
fn way_in_step(i: u32) -> vec3f {
    let now = state[position_at(i)].xyz;
    if LATE_TURN {
        return now - y3[position_at(i)].xyz;
    }
    if VERLET {
        return step.dt * y4[velocity_at(i)].xyz;
    }
    if HALF_STEP {
        return step.dt * state[velocity_at(i)].xyz;
    }
    // Stage state 3 is half a step ahead of the start, at the velocity of stage state 2.
    return (now - y3[position_at(i)].xyz) + 0.5 * step.dt * y2[velocity_at(i)].xyz;
}

// Whether the sphere belongs to this process, where several share a scene.
fn is_own(i: u32) -> bool {
    if step.own_at == 0u {
        return true;
    }
    let index = insertion_index(i);
    return ((topology[step.own_at + index / 32u] >> (index % 32u)) & 1u) != 0u;
}

// From the corner of a wall to a point.
fn from_corner(face: Polygon, point: vec3f) -> vec3f {
    if PERIODIC {
        let to_middle = middle_of_polygon(face);
        return nearest_image(point - face.corner - to_middle) + to_middle;
    }
    return point - face.corner;
}

// Whether a sphere has passed a polygon on its way. A moving wall is where it is at the end of the step.
fn has_passed(now: vec3f, way: vec3f, id: u32) -> bool {
    let face = polygon(id - step.spheres - step.rods - step.boxes);
    if is_round(face) {
        return false;
    }
    var along = way;
    if WALLS {
        along -= step.dt * velocity_of_wall(wall_of(id), now);
    }
    let after = from_corner(face, now);
    let before = after - along;
    let n = cross(face.left, face.right);
    let heights = vec2f(dot(n, before), dot(n, after));
    if ((heights.x < 0.0) == (heights.y < 0.0)) | (!is_triangle(face) & (heights.x < 0.0)) {
        return false;
    }
    if is_plane(face) {
        return true;
    }
    let place = before + (heights.x / (heights.x - heights.y)) * along;
    let nn = dot(n, n);
    let left = dot(cross(place, face.right), n) / nn;
    let right = dot(cross(face.left, place), n) / nn;
    let farthest = select(max(left, right), left + right, is_triangle(face));
    return (min(left, right) >= -OUTLINE_SLACK) & (farthest <= 1.0 + OUTLINE_SLACK);
}

fn passes_a_wall(i: u32) -> bool {
    let now = state[position_at(i)].xyz;
    let way = way_in_step(i);
    let count = count_of(i);
    let first = first_of(i);
    for (var e = 0u; e < count; e++) {
        let id = entry_id(entry_at(slot_at(first, e)));
        if id >= step.spheres + step.rods + step.boxes {
            if has_passed(now, way, id) {
                return true;
            }
        }
    }
    return false;
}

@compute @workgroup_size(256)
fn find_passages(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = wide_thread(group, groups, local);
    if (i >= step.spheres) | (atomicLoad(&status.rejected) != 0u) {
        return;
    }
    // In most steps nothing is fast or deep, and no more is read.
    let deepest = bitcast<f32>(status.last_max_overlap);
    if (atomicLoad(&status.counters[0].fast) == 0u) & !is_deep(deepest, step.least_radius) {
        return;
    }
    let radius = state[position_at(i)].w;
    let velocity = state[velocity_at(i)];
    if (velocity.w <= 0.0) | !(is_fast(radius, velocity) | is_deep(deepest, radius)) {
        return;
    }
    if is_own(i) {
        if passes_a_wall(i) {
            atomicAdd(&status.counters[0].passages, 1u);
            atomicMax(&status.counters[0].passing, ~insertion_index(i));
        }
    }
}
