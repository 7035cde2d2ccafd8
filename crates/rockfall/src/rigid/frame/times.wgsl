// requires rigid/frame/rows.wgsl rigid/frame/states.wgsl rigid/frame/turn.wgsl physics/quaternion.wgsl

// The times of contact of blocks without round pairs, and the geometry at them (docs/physics section 11.7). `known.wgsl` has the same
// functions for blocks with round pairs.

fn hit_of(k: u32, block: Block) -> Hit {
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
        let face = face_at(pair);
        let normal = turned_vector(sight.a.turn, inner_normal(pair));
        let pull = -dot(field, normal);
        for (var point = face.first; point < face.first + count_of(face); point++) {
            let place_a = on_a(sight, point);
            let place_b = on_b(sight, point);
            let gap = dot(place_b - place_a, normal);
            let u = approach_at(sight, 0.5 * (place_a + place_b), normal);
            if u <= least || u + max(pull, 0.0) * rest <= fall {
                continue;
            }
            var time = 0.0;
            if gap <= 0.0 {
                if u <= fall {
                    continue;
                }
            } else {
                time = root_of(gap, u, pull, rest, fall, late_of(u, rest, least_radius(block)));
                if time < 0.0 {
                    continue;
                }
            }
            hit.found = true;
            first = min(first, time);
            hit.depth = max(hit.depth, (u + 0.5 * abs(pull) * h) * h);
            hit.waits &= gap > -2.0 * u * h;
        }
    }
    hit.time = min(start + first, LAST * h);
    return hit;
}

// At an impact: the normal of a pair, how many points it may have, and of a point the common place from the centre of a, and the gap.
fn normal_met(sight: Sight, pair: u32, first: u32) -> vec3f {
    return turned_vector(sight.a.turn, inner_normal(pair));
}

fn count_met(face: Face) -> u32 {
    return count_of(face);
}

fn met(sight: Sight, normal: vec3f, point: u32) -> vec4f {
    let place_a = on_a(sight, point);
    let place_b = on_b(sight, point);
    return vec4f(0.5 * (place_a + place_b), dot(place_b - place_a, normal));
}
