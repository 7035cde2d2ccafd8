// requires rigid/frame/rows.wgsl

// The factors of the margins (docs/physics section 11.2): after a frame that holds, and after one that does not; the second word of
// the call is 1 after several repeats. After a frame that holds, bodies go back into a periodic box. `scales` has three words for
// each body after all factors: by how many periods its place in the scene is away from that in the box.

@group(0) @binding(22) var<storage, read_write> scales: array<f32>;

const MOST_MARGIN: f32 = 1e30;

// The part of its margin that the path of a body takes.
fn use_of(body: u32) -> f32 {
    return bodies[BODY_ROWS * body + 3u].w / bodies[BODY_ROWS * body + 5u].w;
}

fn take_into_box(body: u32) {
    if all(frame.period == vec3f(0.0)) {
        return;
    }
    let away = floor((place_of(body) - frame.box_start) * frame.per_period);
    bodies[BODY_ROWS * body] -= vec4f(frame.period * away, 0.0);
    let at = frame.bodies + 3u * body;
    scales[at] += away.x;
    scales[at + 1u] += away.y;
    scales[at + 2u] += away.z;
}

@compute @workgroup_size(THREADS)
fn calm(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies && has_mass(body) {
        let scale = scales[body];
        scales[body] = clamp(max(0.99 * scale, 1.25 * scale * use_of(body)), 1.0, MOST_MARGIN);
        take_into_box(body);
    }
}

@compute @workgroup_size(THREADS)
fn widen(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body >= frame.bodies || !has_mass(body) {
        return;
    }
    if use_of(body) > 1.0 {
        scales[body] = min(select(1.25, 2.5, call.biased == 1u) * use_of(body) * scales[body], MOST_MARGIN);
    }
}
