// requires rigid/frame/rows.wgsl

// The factors of the margins (docs/physics section 11.2): after a frame that holds, and after one that does not; the second word of
// the call is 1 after several repeats.

@group(0) @binding(22) var<storage, read_write> scales: array<f32>;

const MOST_MARGIN: f32 = 1e30;

// The part of its margin that the path of a body takes.
fn use_of(body: u32) -> f32 {
    return bodies[BODY_ROWS * body + 3u].w / bodies[BODY_ROWS * body + 5u].w;
}

@compute @workgroup_size(THREADS)
fn calm(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies && has_mass(body) {
        let scale = scales[body];
        scales[body] = clamp(max(0.99 * scale, 1.25 * scale * use_of(body)), 1.0, MOST_MARGIN);
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
