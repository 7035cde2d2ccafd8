// requires physics/quaternion.wgsl rigid/frame/places.wgsl rigid/frame/rows.wgsl rigid/frame/states.wgsl rigid/frame/turn.wgsl

// The spare gaps of round pairs before the biased pass (docs/physics section 11.7): a body that passes is not deflected.

struct Search {
    touches: bool,
    // Of the touch.
    time: f32,
    speed: f32,
    // The least gap on the way.
    least: f32,
}

// A body with its motion after the kick, on the parabola whose kick is in its velocity.
fn kicked_state_at(body: u32, time: f32) -> State {
    var state = State(place_of(body), turn_of(body), motion_of(body));
    let field = field_of(body);
    state.motion.velocity -= (frame.h - time) * field;
    state.place += time * state.motion.velocity - (0.5 * time * time) * field;
    let turn = time * state.motion.spin;
    if any(turn != vec3f(0.0)) {
        state.turn = unit_turn(multiply(rotation_by(turn), state.turn));
    }
    return state;
}

fn kicked_sight_at(block: Block, time: f32) -> Sight {
    let a = kicked_state_at(block.a, time);
    let b = kicked_state_at(block.b, time);
    return Sight(a, b, b.place - a.place);
}

// The touch of a pair, as `find.wgsl` searches for it, along the paths after the kick.
fn search(block: Block, pair: u32, start: f32) -> Search {
    let rest = frame.h - start;
    let radius = least_radius(block);
    var found = Search(false, 0.0, 0.0, 3e38);
    var time = 0.0;
    for (var step = 0u; step < SEARCH_STEPS; step++) {
        let sight = kicked_sight_at(block, start + time);
        let place = place_in(sight, pair);
        var gap = 3e38;
        var speed = 0.0;
        for (var k = 0u; k < MOST_POINTS && k < place.count; k++) {
            let spot = spot_in(sight, place, k);
            let own = gap_of(spot, place.normal);
            let u = approach_at(sight, 0.5 * (spot.on_a + spot.on_b), place.normal);
            found.least = min(found.least, own);
            if comes_before(own, u, gap, speed) {
                gap = own;
                speed = u;
            }
        }
        if gap < TOUCH * radius {
            found.touches = true;
            found.time = time;
            found.speed = speed;
            return found;
        }
        if speed <= 0.0 {
            break;
        }
        if time + gap / speed > rest + late_of(speed, rest, radius) {
            found.least = min(found.least, gap - speed * (rest - time));
            break;
        }
        time = min(time + gap / speed, rest);
    }
    return found;
}

@compute @workgroup_size(THREADS)
fn spare_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k >= frame.blocks {
        return;
    }
    let block = block_at(k);
    let start = max(clock_of(block.a), clock_of(block.b));
    let rest = frame.h - start;
    let a = motion_of(block.a);
    let b = motion_of(block.b);
    let apart = between(block.a, block.b);
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let face = face_at(pair);
        if (face.info & ROUND) == 0u {
            continue;
        }
        var found = Search(false, 0.0, 0.0, 3e38);
        var is_searched = false;
        for (var point = face.first; point < face.first + count_of(face); point++) {
            let row = contacts[2u * point];
            let u = dot(a.velocity + cross(a.spin, row.xyz) - b.velocity - cross(b.spin, row.xyz - apart), face.normal);
            var spare = 0.0;
            if row.w > 0.0 && u * rest > row.w {
                if !is_searched {
                    is_searched = true;
                    found = search(block, pair, start);
                }
                spare = select(max(found.least - row.w + u * rest, 0.0), 0.0, found.touches);
            }
            contacts[2u * point + 1u].w = spare;
        }
    }
}
