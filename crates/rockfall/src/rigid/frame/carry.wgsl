// requires rigid/frame/rows.wgsl rigid/frame/times.wgsl rigid/frame/reflect.wgsl rigid/frame/warm_start.wgsl
// requires physics/quaternion.wgsl rigid/frame/belt.wgsl

// Impacts of a block; blocks that wait; rows of clocked blocks (docs/physics section 11.7).

// Reflects a block that is hit. Returns whether it was reflected.
fn strike_block(k: u32) -> bool {
    let block = block_at(k);
    let hit = hit_of(k, block);
    if !hit.found {
        return false;
    }
    let reflected = reflect(block, hit, 1.0, 1.0);
    if !reflected.acted {
        return false;
    }
    if has_mass(block.a) {
        put_after(block.a, reflected.a, hit.time);
    }
    if has_mass(block.b) {
        put_after(block.b, reflected.b, hit.time);
    }
    return true;
}

// After the rounds: whether a block waits, and its rows if a body has a clock.
fn carry_block(k: u32, any_reflected: bool) {
    let block = block_at(k);
    var waits = false;
    if any_reflected {
        let hit = hit_of(k, block);
        waits = hit.found && hit.waits;
    }
    let start = max(clock_of(block.a), clock_of(block.b));
    let at = BLOCK_ROWS * k + 1u;
    if waits != ((block.info & WAITS) != 0u) {
        blocks[at].y = block.info ^ WAITS;
    }
    if !waits && start == 0.0 {
        return;
    }
    let sight = sight_at(block, start);
    let apart = between(block.a, block.b);
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let old = face_at(pair);
        let old_one = tangent_one(old.normal);
        let old_two = tangent_two(old.normal);
        let normal = turned_vector(sight.a.turn, inner_normal(pair));
        let one = tangent_one(normal);
        let two = tangent_two(normal);
        if start > 0.0 {
            pairs[PAIR_ROWS * pair] = bitcast<vec4u>(vec4f(normal, old.friction));
            pairs[PAIR_ROWS * pair + 1u] = vec4u(bitcast<vec2u>(belt_in(sight, pair, normal)), old.first, old.info);
        }
        for (var point = old.first; point < old.first + count_of(old); point++) {
            var kept = contacts[2u * point + 1u];
            if start > 0.0 {
                let place_a = on_a(sight, point);
                let place_b = on_b(sight, point);
                let back = apart + (place_b - sight.apart);
                var middle = 0.5 * (place_a + back);
                if !has_mass(block.a) {
                    middle = back;
                } else if !has_mass(block.b) {
                    middle = place_a;
                }
                let rub = kept.y * old_one + kept.z * old_two;
                kept = vec4f(kept.x, dot(rub, one), dot(rub, two), 0.0);
                contacts[2u * point] = vec4f(middle, dot(place_b - place_a, normal));
            }
            contacts[2u * point + 1u] = select(kept, vec4f(0.0), waits);
        }
    }
    if start > 0.0 {
        blocks[at].z = bitcast<u32>(frame.h - start);
    }
    put_load(k, block);
}
