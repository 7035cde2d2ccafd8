// requires model/counters.wgsl model/objects.wgsl model/one_state.wgsl model/step.wgsl physics/wall_bounds.wgsl physics/walls.wgsl

// Not read. Functions that the kernel shares with others name it.
@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> topology: array<u32>;
@group(0) @binding(4) var<storage, read> poses: array<vec4f>;
@group(0) @binding(5) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(6) var<storage, read_write> status: StatusAtomic;

fn put_vector(at: u32, v: vec3f) {
    let bits = bitcast<vec3u>(v);
    topology[at] = bits.x;
    topology[at + 1u] = bits.y;
    topology[at + 2u] = bits.z;
}

// Half steps from the start of the step to the time of the pass.
fn half_steps_of_pass() -> u32 {
    return min(2u, (pass_.index + 1u) / 2u);
}

@compute @workgroup_size(64)
fn move_walls(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let wall = linear_thread(group, groups, local);
    let count = step.boxes + step.polygons;
    if wall >= count {
        return;
    }
    let record = wall_record(wall);
    let body = topology[record + 3u];
    if body == 0u {
        return;
    }
    // There are no checks of bounds.
    let row = min(2u * (status.steps - step.pose_step) + half_steps_of_pass(), max(step.pose_rows, 1u) - 1u);
    let pose = (row * step.bodies + body - 1u) * (POSE_FLOATS / 4u);
    // The rows of R - 1.
    let x = poses[pose].xyz;
    let y = poses[pose + 1u].xyz;
    let z = poses[pose + 2u].xyz;
    let point = poses[pose + 3u].xyz;
    let shift = poses[pose + 4u].xyz;

    let is_box = wall < step.boxes;
    let polygon_words = (wall - step.boxes) * POLYGON_WORDS;
    let place = select(step.polygons_at + polygon_words, step.boxes_at + wall * BOX_WORDS, is_box);
    let written = step.walls_at + count * WALL_WORDS + select(step.boxes * BOX_WORDS + polygon_words, wall * BOX_WORDS, is_box);
    let lever = vector_at(written) - point;
    let corner = vector_at(written) + (vec3f(dot(x, lever), dot(y, lever), dot(z, lever)) + shift);
    put_vector(place, corner);
    for (var e = 0u; e < select(2u, 3u, is_box); e++) {
        let edge = vector_at(written + 3u + 3u * e);
        put_vector(place + 3u + 3u * e, edge + vec3f(dot(x, edge), dot(y, edge), dot(z, edge)));
    }
    let spin = poses[pose + 7u].xyz;
    let around = cross(spin, corner - (point + shift));
    put_vector(record, poses[pose + 5u].xyz + around);
    put_vector(record + 4u, spin);
    put_vector(record + 8u, poses[pose + 6u].xyz + cross(spin, around));

    // In a rejected step, a request would keep the device from repeating it.
    if (pass_.index > 0u) && !was_rejected_before(ESCAPED_ON_WALLS + pass_.index - 1u, 0u) {
        let id = step.spheres + step.rods + wall;
        let reach = reach_of(id);
        let ratio = escape_of_wall(reach, aabbs[id], 0.0);
        if ratio > 0.0 {
            report_escape(ratio, ESCAPED_ON_WALLS + pass_.index - 1u);
        }
        if pass_.index == 3u {
            if escape_of_wall(reach, aabbs[id], step.list_interval) > 0.0 {
                atomicOr(&status.rebuild, REBUILD_REQUESTED);
            }
        }
    }
}
