// requires rigid/frame/places.wgsl rigid/frame/rows.wgsl rigid/frame/scratch.wgsl rigid/frame/states.wgsl

// The impacts of blocks that may have round pairs (docs/physics section 11.7): whether and when they are hit, and the geometry then.

// What the points of a pair do along the paths of its bodies from their clock `start` on. The time is that since then. A touch of a round
// pair is searched for: the gap of a convex pair is convex along straight paths, so the steps come from below. Closest points are long
// code, which compilers copy to each call, so `find_block` has two.
fn hit_of_pair(block: Block, pair: u32, start: f32, least: f32) -> Hit {
    var hit = Hit(false, 2.0 * frame.h, 0.0, true);
    let h = frame.h;
    let fall = length(frame.gravity) * h;
    let rest = h - start;
    let radius = least_radius(block);
    let is_round = (face_at(pair).info & ROUND) != 0u;
    var is_searched = false;
    var time = 0.0;
    var pull = 0.0;
    for (var step = 0u; step < SEARCH_STEPS; step++) {
        let sight = sight_at(block, start + time);
        let place = place_in(sight, pair);
        if step == 0u {
            pull = -dot(field_of(block.b) - field_of(block.a), place.normal);
        }
        var gap = 3e38;
        var speed = 0.0;
        for (var k = 0u; k < MOST_POINTS && k < place.count; k++) {
            let spot = spot_in(sight, place, k);
            let own = gap_of(spot, place.normal);
            let u = approach_at(sight, 0.5 * (spot.on_a + spot.on_b), place.normal);
            if comes_before(own, u, gap, speed) {
                gap = own;
                speed = u;
            }
            if step > 0u || u <= least || u + max(pull, 0.0) * rest <= fall {
                continue;
            }
            let late = late_of(u, rest, radius);
            if own > 0.0 && is_round {
                is_searched |= own - u * (rest + late) - 0.5 * max(pull, 0.0) * rest * rest <= 0.0;
                continue;
            }
            var when = select(-1.0, 0.0, u > fall);
            if own > 0.0 {
                when = root_of(own, u, pull, rest, fall, late);
            }
            if when >= 0.0 {
                hit = Hit(true, min(hit.time, when), max(hit.depth, (u + 0.5 * abs(pull) * h) * h), hit.waits && own > -2.0 * u * h);
            }
        }
        let touches = gap < TOUCH * radius;
        if is_searched && touches && speed > fall {
            hit = Hit(true, min(hit.time, time), max(hit.depth, (speed + 0.5 * abs(pull) * h) * h), hit.waits);
        }
        if !is_searched || touches || speed <= 0.0 || time + gap / speed > rest + late_of(speed, rest, radius) {
            break;
        }
        time = min(time + gap / speed, rest);
    }
    return hit;
}

// Finds which places of balls are hidden in a pose. At a hit, the geometry of all points is stored, too.
fn look(block: Block, sight: Sight, is_hit: bool) {
    forget_places();
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let hides = may_hide(block, pair);
        if !hides && !is_hit {
            continue;
        }
        let place = place_in(sight, pair);
        if hides {
            see_place(block, pair, sight, place);
        }
        if is_hit {
            store_met(pair, sight, place);
        }
    }
    hide_places(block);
}

// Points that are not there are far.
fn store_met(pair: u32, sight: Sight, place: Place) {
    for (var k = 0u; k < MOST_POINTS && k < room_of(face_at(pair)); k++) {
        var row = vec4f(0.0, 0.0, 0.0, 3e38);
        if k < place.count {
            let spot = spot_in(sight, place, k);
            row = vec4f(0.5 * (spot.on_a + spot.on_b), gap_of(spot, place.normal));
        }
        loads[met_row(place.first + k)] = row;
        loads[met_row(place.first + k) + 1u] = vec4f(place.normal, 0.0);
    }
}

fn store_hidden(block: Block) {
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let face = face_at(pair);
        for (var k = 0u; k < MOST_POINTS && k < room_of(face) && is_hidden(block, pair); k++) {
            loads[met_row(face.first + k)] = vec4f(0.0, 0.0, 0.0, 3e38);
        }
    }
}

// Reflections of both bodies in the substep; -1 if a body has left-over blocks, whose copies change it, too.
fn strikes_of(block: Block) -> f32 {
    if share_of(block.a) != 0.0 || share_of(block.b) != 0.0 {
        return -1.0;
    }
    return bodies[BODY_ROWS * block.a + 8u].w + bodies[BODY_ROWS * block.b + 8u].w;
}

// With 1 in `call.biased`, what was found before stands unless a body was reflected since then.
fn find_block(k: u32) {
    let block = block_at(k);
    let strikes = strikes_of(block);
    if call.biased == 1u && strikes >= 0.0 && floor(0.5 * loads[hit_row(k)].w) == strikes {
        return;
    }
    let least = least_speed_of(block, length(frame.gravity) * frame.h);
    let start = max(clock_of(block.a), clock_of(block.b));
    let end = block.first_pair + block.pairs;
    var hit = Hit(false, 2.0 * frame.h, 0.0, true);
    // After the pairs comes the pose at the hit.
    for (var pair = select(block.first_pair, end, least < 0.0); pair <= end; pair++) {
        var own = hit;
        var time = min(start + hit.time, LAST * frame.h);
        if pair < end {
            own = hit_of_pair(block, pair, start, least);
            time = start + own.time;
        }
        if !own.found {
            continue;
        }
        let has_rivals = pair < end && may_hide(block, pair);
        if pair == end || has_rivals {
            look(block, sight_at(block, time), pair == end);
        }
        if pair < end && !(has_rivals && is_hidden(block, pair)) {
            hit = Hit(true, min(hit.time, own.time), max(hit.depth, own.depth), hit.waits && own.waits);
        }
    }
    hit.time = min(start + hit.time, LAST * frame.h);
    loads[hit_row(k)] = vec4f(f32(hit.found), hit.time, hit.depth, f32(hit.waits) + 2.0 * max(strikes, 0.0));
    if hit.found {
        store_hidden(block);
    }
}

@compute @workgroup_size(THREADS)
fn find_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = colour_start(call.colour) + thread_of(group, groups, local);
    if k < colour_start(call.colour + 1u) {
        find_block(k);
    }
}

@compute @workgroup_size(THREADS)
fn find_all_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks {
        find_block(k);
    }
}
