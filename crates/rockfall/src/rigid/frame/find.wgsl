// requires rigid/frame/places.wgsl rigid/frame/rows.wgsl rigid/frame/scratch.wgsl rigid/frame/search.wgsl rigid/frame/states.wgsl

// The impacts of blocks that may have round pairs (docs/physics section 11.7): whether and when they are hit, and the geometry then.

fn hit_along_path(block: Block) -> Hit {
    var hit = Hit(false, 0.0, 0.0, true);
    let h = frame.h;
    let fall = length(frame.gravity) * h;
    let least = least_speed_of(block, fall);
    if least < 0.0 {
        return hit;
    }
    let start = max(clock_of(block.a), clock_of(block.b));
    let rest = h - start;
    let sight = sight_at(block, start);
    let field = field_of(block.b) - field_of(block.a);
    var first = 2.0 * h;
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let is_round = (face_at(pair).info & ROUND) != 0u;
        let place = place_in(sight, pair);
        let pull = -dot(field, place.normal);
        for (var k = 0u; k < MOST_POINTS && k < place.count; k++) {
            let spot = spot_in(sight, place, k);
            let gap = gap_of(spot, place.normal);
            let u = approach_at(sight, 0.5 * (spot.on_a + spot.on_b), place.normal);
            if u <= least || u + max(pull, 0.0) * rest <= fall {
                continue;
            }
            var time = 0.0;
            var speed = u;
            if gap <= 0.0 {
                time = select(-1.0, 0.0, u > fall);
            } else if !is_round {
                time = root_of(gap, u, pull, rest, fall, late_of(u, rest, least_radius(block)));
            } else if gap - u * (rest + late_of(u, rest, least_radius(block))) - 0.5 * max(pull, 0.0) * rest * rest > 0.0 {
                time = -1.0;
            } else {
                let found = search(block, pair, start, false);
                speed = found.speed;
                time = select(-1.0, found.time, found.touches && speed > fall);
            }
            if time < 0.0 {
                continue;
            }
            if (block.info & SEAMS) != 0u {
                find_hidden(block, sight_at(block, start + time));
                if is_hidden(block, pair) {
                    continue;
                }
            }
            hit.found = true;
            first = min(first, time);
            hit.depth = max(hit.depth, (speed + 0.5 * abs(pull) * h) * h);
            hit.waits &= gap > -2.0 * u * h;
        }
    }
    hit.time = min(start + first, LAST * h);
    return hit;
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
    let hit = hit_along_path(block);
    loads[hit_row(k)] = vec4f(f32(hit.found), hit.time, hit.depth, f32(hit.waits) + 2.0 * max(strikes, 0.0));
    if !hit.found {
        return;
    }
    let sight = sight_at(block, hit.time);
    find_hidden(block, sight);
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let place = place_in(sight, pair);
        let count = select(place.count, 0u, is_hidden(block, pair));
        for (var k = 0u; k < MOST_POINTS && k < room_of(face_at(pair)); k++) {
            // Those that are not there are far.
            var row = vec4f(0.0, 0.0, 0.0, 3e38);
            if k < count {
                let spot = spot_in(sight, place, k);
                row = vec4f(0.5 * (spot.on_a + spot.on_b), gap_of(spot, place.normal));
            }
            loads[met_row(place.first + k)] = row;
            loads[met_row(place.first + k) + 1u] = vec4f(place.normal, 0.0);
        }
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
