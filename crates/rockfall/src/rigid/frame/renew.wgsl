// requires rigid/frame/places.wgsl rigid/frame/rows.wgsl rigid/frame/scratch.wgsl rigid/frame/states.wgsl rigid/frame/belt.wgsl

// The geometry of the blocks in the present pose, and after impacts at the clocks of their bodies, with round pairs found anew
// (docs/physics sections 11.4 and 11.7).

// A round pair stores its points. Their impulses follow the ids; the only point of a pair is the same.
fn renew_points(pair: u32, sight: Sight, place: Place, count: u32) {
    let face = face_at(pair);
    let back_a = vec4f(-sight.a.turn.xyz, sight.a.turn.w);
    let back_b = vec4f(-sight.b.turn.xyz, sight.b.turn.w);
    let before = count_of(face);
    let room = room_of(face);
    let is_only = count == 1u && before == 1u;
    let first = face.first;
    let one = contacts[2u * first + 1u];
    let one_id = points[POINT_ROWS * first].w;
    // A pair with room for one point has no second one.
    let second = select(first, first + 1u, room > 1u);
    let two = contacts[2u * second + 1u];
    let two_id = points[POINT_ROWS * second].w;
    var spots = array<Spot, 2>(spot_in(sight, place, 0u), spot_in(sight, place, select(0u, 1u, count > 1u)));
    for (var k = 0u; k < 2u && k < room; k++) {
        var kept = vec4f(0.0);
        if k < count {
            let spot = spots[k];
            if before > 0u && (is_only || one_id == spot.id) {
                kept = one;
            } else if before > 1u && two_id == spot.id {
                kept = two;
            }
            points[POINT_ROWS * (first + k)] = vec4u(bitcast<vec3u>(turned_vector(back_a, spot.on_a)), spot.id);
            let struck = points[POINT_ROWS * (first + k) + 1u].w;
            points[POINT_ROWS * (first + k) + 1u] = vec4u(bitcast<vec3u>(turned_vector(back_b, spot.on_b - sight.apart)), struck);
        }
        contacts[2u * (first + k) + 1u] = kept;
    }
    pairs[PAIR_ROWS * pair + 1u].w = (face.info & ~0xffu) | count;
    let inner = turned_vector(back_a, place.normal);
    pairs[PAIR_ROWS * pair + 2u] = vec4u(bitcast<vec3u>(inner), pairs[PAIR_ROWS * pair + 2u].w);
}

fn renew_pair(block: Block, pair: u32, sight: Sight, place: Place, start: f32) {
    let old = face_at(pair);
    let old_one = tangent_one(old.normal);
    let old_two = tangent_two(old.normal);
    if is_hidden(block, pair) {
        // It keeps its impulse for the one that hides it, in the room of its row.
        let kept = contacts[2u * old.first + 1u];
        let whole = vec4f(kept.y * old_one + kept.z * old_two, kept.x);
        contacts[2u * old.first] = select(vec4f(0.0), whole, count_of(old) > 0u);
        renew_points(pair, sight, place, 0u);
    } else if (old.info & ROUND) != 0u {
        renew_points(pair, sight, place, place.count);
    }
    let one = tangent_one(place.normal);
    let two = tangent_two(place.normal);
    pairs[PAIR_ROWS * pair] = bitcast<vec4u>(vec4f(place.normal, old.friction));
    let now = pairs[PAIR_ROWS * pair + 1u];
    pairs[PAIR_ROWS * pair + 1u] = vec4u(bitcast<vec2u>(belt_in(sight, pair, place.normal)), now.zw);
    let apart = between(block.a, block.b);
    for (var k = 0u; k < MOST_POINTS && k < (now.w & 0xffu); k++) {
        let point = old.first + k;
        let spot = spot_in(sight, place, k);
        let kept = contacts[2u * point + 1u];
        let rub = kept.y * old_one + kept.z * old_two;
        var middle = 0.5 * (spot.on_a + spot.on_b);
        if start > 0.0 {
            // With the displacement of the centre alone.
            let carried = apart + (spot.on_b - sight.apart);
            middle = 0.5 * (spot.on_a + carried);
            if !has_mass(block.a) {
                middle = carried;
            } else if !has_mass(block.b) {
                middle = spot.on_a;
            }
        }
        contacts[2u * point] = vec4f(middle, gap_of(spot, place.normal));
        contacts[2u * point + 1u] = vec4f(kept.x, dot(rub, one), dot(rub, two), 0.0);
    }
}

fn renew_block(k: u32, start: f32) {
    let block = block_at(k);
    let sight = sight_at(block, start);
    forget_places();
    // First it is found which places are hidden. Both rounds share the long code of closest points.
    for (var round = select(1u, 0u, (block.info & SEAMS) != 0u); round < 2u; round++) {
        if round == 1u {
            hide_places(block);
        }
        for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
            if round == 0u && !may_hide(block, pair) {
                continue;
            }
            let place = place_in(sight, pair);
            if round == 0u {
                see_place(block, pair, sight, place);
            } else {
                renew_pair(block, pair, sight, place, start);
            }
        }
    }
    for (var k = 0u; k < MOST_HIDDEN && k < block.pairs && hidden_pairs != 0u; k++) {
        let own = face_at(block.first_pair + k).first;
        let gift = contacts[2u * own];
        // The biased pass may have left it friction alone.
        if is_hidden(block, block.first_pair + k) && any(gift != vec4f(0.0)) {
            let to = face_at(block.first_pair + hidden_by[k]);
            let along = vec2f(dot(gift.xyz, tangent_one(to.normal)), dot(gift.xyz, tangent_two(to.normal)));
            contacts[2u * to.first + 1u] += vec4f(gift.w, along, 0.0);
        }
    }
    blocks[BLOCK_ROWS * k + 1u].z = bitcast<u32>(frame.h - start);
}

@compute @workgroup_size(THREADS)
fn refresh_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks {
        renew_block(k, 0.0);
    }
}

// The rows of blocks with a clock.
@compute @workgroup_size(THREADS)
fn carry_round(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks {
        let block = block_at(k);
        let start = max(clock_of(block.a), clock_of(block.b));
        if start > 0.0 {
            renew_block(k, start);
        }
    }
}
