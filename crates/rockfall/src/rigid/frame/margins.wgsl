// requires rigid/frame/rows.wgsl rigid/frame/report.wgsl

// The factors of the margins (docs/physics.md section 11.2): after a frame that holds, after one that does not, and for all bodies after
// several repeats.

@group(0) @binding(22) var<storage, read_write> scales: array<f32>;

const MOST_MARGIN: f32 = 1e30;

@compute @workgroup_size(THREADS)
fn calm(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies && has_mass(body) {
        scales[body] = max(0.99 * scales[body], 1.0);
    }
}

@compute @workgroup_size(THREADS)
fn widen(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body >= frame.bodies || !has_mass(body) {
        return;
    }
    let path = bodies[BODY_ROWS * body + 3u].w;
    let margin = bodies[BODY_ROWS * body + 5u].w;
    if path > margin {
        scales[body] = min(1.25 * (path / margin) * scales[body], MOST_MARGIN);
        atomicMax(&report[6], bitcast<u32>(scales[body]));
    }
}

@compute @workgroup_size(THREADS)
fn widen_all(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies && has_mass(body) {
        scales[body] = max(scales[body], bitcast<f32>(atomicLoad(&report[6])));
    }
}
