// requires rigid/frame/rows.wgsl rigid/frame/turn.wgsl rigid/frame/times.wgsl rigid/frame/reflect.wgsl physics/quaternion.wgsl

// Impacts of left-over blocks (docs/physics section 11.7): all are found, then reflected with copies of their bodies, and each body
// takes the mean of its copies. Rows of a copy: of a and of b each changes of x, v, L, and the rotation; beside them whether the block is
// hit, tau and delta, and whether it was reflected.

fn copies_of(k: u32) -> u32 {
    return LOAD_ROWS * frame.blocks + COPY_ROWS * (k - frame.left_over);
}

fn find_copies(k: u32) {
    let hit = hit_of(k, block_at(k));
    let at = copies_of(k);
    loads[at].w = f32(hit.found);
    loads[at + 1u].w = hit.time;
    loads[at + 2u].w = hit.depth;
    loads[at + 4u].w = 0.0;
}

// The number of hit left-over blocks of a body, beside omega_0.
fn count_hits(body: u32) {
    if share_of(body) == 0.0 {
        return;
    }
    var hits = 0.0;
    for (var entry = lists[body]; entry < lists[body + 1u]; entry++) {
        let k = lists[frame.bodies + 1u + entry] >> 1u;
        if k >= frame.left_over {
            hits += loads[copies_of(k)].w;
        }
    }
    bodies[BODY_ROWS * body + 8u].w = hits;
}

fn put_copy(at: u32, body: u32, after: After) {
    let before = turn_of(body);
    var turn = multiply(after.turn, vec4f(-before.xyz, before.w));
    turn = select(turn, -turn, turn.w < 0.0);
    loads[at] = vec4f(after.place - place_of(body), loads[at].w);
    loads[at + 1u] = vec4f(after.velocity - motion_of(body).velocity, loads[at + 1u].w);
    loads[at + 2u] = vec4f(after.momentum - momentum_of(body), loads[at + 2u].w);
    loads[at + 3u] = turn;
}

fn strike_copies(k: u32) -> bool {
    let at = copies_of(k);
    if loads[at].w == 0.0 {
        return false;
    }
    let block = block_at(k);
    let hit = Hit(true, loads[at + 1u].w, loads[at + 2u].w, false);
    let share_a = select(1.0, bodies[BODY_ROWS * block.a + 8u].w, has_mass(block.a));
    let share_b = select(1.0, bodies[BODY_ROWS * block.b + 8u].w, has_mass(block.b));
    let reflected = reflect(block, hit, share_a, share_b);
    if !reflected.acted {
        return false;
    }
    put_copy(at, block.a, reflected.a);
    put_copy(at + 4u, block.b, reflected.b);
    loads[at + 4u].w = 1.0;
    return true;
}

fn take_impacts(body: u32) {
    let share = bodies[BODY_ROWS * body + 8u].w;
    if !has_mass(body) || share_of(body) == 0.0 || share == 0.0 {
        return;
    }
    var after = After(place_of(body), turn_of(body), motion_of(body).velocity, momentum_of(body));
    var clock = clock_of(body);
    var acted = false;
    for (var entry = lists[body]; entry < lists[body + 1u]; entry++) {
        let own = lists[frame.bodies + 1u + entry];
        if (own >> 1u) < frame.left_over {
            continue;
        }
        let copies = copies_of(own >> 1u);
        if loads[copies + 4u].w == 0.0 {
            continue;
        }
        let at = copies + 4u * (own & 1u);
        after.place += (1.0 / share) * loads[at].xyz;
        after.velocity += (1.0 / share) * loads[at + 1u].xyz;
        after.momentum += (1.0 / share) * loads[at + 2u].xyz;
        after.turn = unit_turn(multiply(vec4f((1.0 / share) * loads[at + 3u].xyz, 1.0), after.turn));
        clock = max(clock, loads[copies + 1u].w);
        acted = true;
    }
    if acted {
        put_after(body, after, clock);
    }
}
