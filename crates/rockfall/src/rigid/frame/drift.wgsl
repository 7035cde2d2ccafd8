// requires rigid/frame/rows.wgsl rigid/frame/follow.wgsl rigid/frame/halt.wgsl rigid/frame/turn.wgsl physics/quaternion.wgsl

// The drift of a substep (docs/physics section 11.9).

fn drift_body(body: u32) {
    let at = BODY_ROWS * body;
    let place = bodies[at].xyz;
    let before = bodies[at + 1u];
    let motion = motion_of(body);
    let h = frame.h;
    if !has_mass(body) {
        let turn = h * motion.spin;
        bodies[at] = vec4f(place + h * motion.velocity, 0.0);
        if any(turn != vec3f(0.0)) {
            bodies[at + 1u] = unit_turn(multiply(rotation_by(turn), before));
        }
        return;
    }
    let radius = bodies[at + 6u].w;
    // Without springs it is constant in a frame.
    let acceleration = constants[CONSTANT_ROWS * body + 2u];
    let size = length(acceleration.xyz);
    let changed = length(motion.velocity - bodies[at + 7u].xyz) + radius * length(motion.spin - bodies[at + 8u].xyz);
    var share = 1.0;
    if changed > 0.0 {
        share = max(1.0 - changed / (0.25 * size * h), 0.0);
    }
    if size == 0.0 || acceleration.w != 0.0 {
        share = 0.0;
    }
    follow(body);
    let momentum = bodies[at + 6u].xyz;
    let top = top_of(body);
    let there = place + (h * motion.velocity - 0.5 * share * h * h * acceleration.xyz);
    let q = freely_turned(top, before, momentum, h);
    let path = bodies[at + 3u].w + h * (length(motion.velocity) + turning_speed(body, motion.spin));
    if !fits(body, there, q) {
        bodies[at].w = 0.0;
        bodies[at + 3u].w = path;
        halt(body);
        return;
    }
    let mass = mass_in(top, q, bodies[at + 2u].w);
    let spin = respond(mass, momentum);
    bodies[at] = vec4f(there, 0.0);
    bodies[at + 1u] = q;
    bodies[at + 3u] = vec4f(spin, path);
    bodies[at + 4u] = vec4f(mass.diagonal, bodies[at + 4u].w);
    bodies[at + 5u] = vec4f(mass.beside, bodies[at + 5u].w);
    bodies[at + 8u] = vec4f(spin, 0.0);
}

@compute @workgroup_size(THREADS)
fn drift(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let body = thread_of(group, groups, local);
    if body < frame.bodies {
        drift_body(body);
    }
}
