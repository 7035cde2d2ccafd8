// requires rigid/broad/search.wgsl rigid/frame/rows.wgsl rigid/frame/turn.wgsl

// The start of a frame: margins (docs/physics section 11.2), and what counts from 0. `Bodies::load` is the twin. The
// inertia is formed anew, so that it is the same after loading.

fn margin_of(body: u32, motion: Motion) -> f32 {
    let reach = (length(motion.velocity) + turning_speed(body, motion.spin)) * search.dt;
    if body == 0u {
        return 0.0;
    }
    if !has_mass(body) {
        return 1.001 * reach;
    }
    let fall = length(frame.gravity) * search.dt * search.dt;
    return scales[body] * max(0.02 * bodies[BODY_ROWS * body + 6u].w, reach + fall);
}

@compute @workgroup_size(THREADS)
fn open(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body >= frame.bodies {
        return;
    }
    let at = BODY_ROWS * body;
    let motion = motion_of(body);
    bodies[at].w = 0.0;
    bodies[at + 3u].w = 0.0;
    var mass = mass_of(body);
    if has_mass(body) {
        mass = mass_in(top_of(body), turn_of(body), mass.inverse);
    }
    bodies[at + 4u] = vec4f(mass.diagonal, 0.0);
    bodies[at + 5u] = vec4f(mass.beside, margin_of(body, motion));
    bodies[at + 7u] = vec4f(motion.velocity, 0.0);
    bodies[at + 8u] = vec4f(motion.spin, constants[CONSTANT_ROWS * body + 3u].w);
}
