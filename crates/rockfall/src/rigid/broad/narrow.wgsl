// requires rigid/broad/search.wgsl rigid/frame/colliders.wgsl rigid/frame/rows.wgsl rigid/collide/manifold.wgsl rigid/collide/exchange.wgsl
// requires physics/quaternion.wgsl

// The manifolds of the candidates (docs/physics section 11.3). A kernel takes the candidates for which its `is_own_pair` is true.

// Contacts of a pair with a reach of both margins, in coordinates of collider a.
fn manifold_of(a: u32, b: u32) -> Manifold {
    let body_a = body_of_collider(a);
    let body_b = body_of_collider(b);
    let outer_a = turn_of(body_a);
    let outer_b = turn_of(body_b);
    // Relative to body a, so that nothing is lost far from the origin.
    let beside = turned_vector(outer_b, place_of_collider(b)) - turned_vector(outer_a, place_of_collider(a));
    let offset = between(body_a, body_b) + beside;
    let turn_a = multiply(outer_a, turn_of_collider(a));
    let back = vec4f(-turn_a.xyz, turn_a.w);
    let turn = multiply(back, multiply(outer_b, turn_of_collider(b)));
    let reach = bodies[BODY_ROWS * body_a + 5u].w + bodies[BODY_ROWS * body_b + 5u].w;
    return collide(shape_of_collider(a), shape_of_collider(b), turned_vector(back, offset), turn, reach);
}

// The number of points, the room for points, and flags.
fn info_of(a: u32, b: u32, count: u32) -> u32 {
    let cores = vec2u(shape_of_collider(a).core, shape_of_collider(b).core);
    let balls = cores == vec2u(CORE_POINT);
    let is_round = any(cores >= vec2u(CORE_SEGMENT));
    // A capsule may come to lie with its second end.
    let room = select(count, max(count, 2u), is_round && !any(balls));
    // A ball with mass that touches something else.
    let may_be_hidden = balls.x != balls.y && has_mass(body_of_collider(select(b, a, balls.x)));
    let moves = (marks_of_collider(a).z | marks_of_collider(b).z) != 0u;
    return count | (room << 8u) | select(0u, ROUND, is_round) | select(0u, BELT, moves)
        | select(0u, BALL, may_be_hidden);
}

// Writes a manifold with its places in coordinates of the bodies.
fn put_found(k: u32, a: u32, b: u32, manifold: ptr<function, Manifold>) {
    let body_a = body_of_collider(a);
    let body_b = body_of_collider(b);
    let rank = atomicAdd(&owned[select(body_a, body_b, has_mass(body_b))], 1u);
    if k >= search.found {
        return;
    }
    let at = FOUND_ROWS * k;
    let count = min((*manifold).count, MOST_POINTS);
    let place = place_of_collider(a);
    let turn = turn_of_collider(a);
    let outer_a = turn_of(body_a);
    let outer_b = turn_of(body_b);
    let back = vec4f(-outer_b.xyz, outer_b.w);
    let apart = between(body_a, body_b);
    found[at] = vec4u(a, b, body_a, body_b);
    found[at + 1u] = vec4u(bitcast<vec3u>(turned_vector(turn, (*manifold).normal)), info_of(a, b, count));
    for (var point = 0u; point < count; point++) {
        let on_a = place + turned_vector(turn, (*manifold).on_a[point]);
        let seen = place + turned_vector(turn, (*manifold).on_b[point]);
        let on_b = turned_vector(back, turned_vector(outer_a, seen) - apart);
        found[at + 2u + 2u * point] = vec4u(bitcast<vec3u>(on_a), (*manifold).ids[point]);
        found[at + 3u + 2u * point] = vec4u(bitcast<vec3u>(on_b), rank);
    }
}

@compute @workgroup_size(THREADS)
fn narrow(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    var manifold = no_contact();
    var pair = vec2u(0u);
    if k < min(atomicLoad(&counts[0]), search.candidates) {
        let candidate = candidates[k];
        pair = candidate & vec2u(~LEFT);
        if is_own_pair(shape_of_collider(pair.x), shape_of_collider(pair.y), (candidate.x & LEFT) != 0u) {
            manifold = manifold_of(pair.x, pair.y);
        }
        // The general pair decides.
        if SOLIDS & (manifold.count > MOST_POINTS) {
            candidates[k].x = candidate.x | LEFT;
        }
    }
    let touches = manifold.count > 0u && manifold.count <= MOST_POINTS;
    // As in `pair_up`: no barrier here.
    if touches {
        put_found(atomicAdd(&counts[1], 1u), pair.x, pair.y, &manifold);
    }
}
