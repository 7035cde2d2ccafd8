// requires rigid/frame/rows.wgsl rigid/frame/follow.wgsl rigid/frame/warm_start.wgsl

// The kick of a substep (docs/physics section 11.9) and the warm start of the body.

fn kick_body(body: u32) {
    if !has_mass(body) {
        return;
    }
    follow(body);
    let at = BODY_ROWS * body;
    let own = CONSTANT_ROWS * body;
    let mass = mass_of(body);
    let velocity = bodies[at + 2u].xyz + frame.h * constants[own + 2u].xyz;
    let momentum = bodies[at + 6u].xyz + frame.h * constants[own + 3u].xyz;
    let spin = respond(mass, momentum);
    bodies[at + 6u] = vec4f(momentum, bodies[at + 6u].w);
    bodies[at + 7u] = vec4f(velocity, bodies[at + 7u].w);
    bodies[at + 8u] = vec4f(spin, 0.0);
    put_motion(body, gathered(body, mass, Motion(velocity, spin)));
}

@compute @workgroup_size(THREADS)
fn kick(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies {
        kick_body(body);
    }
}
