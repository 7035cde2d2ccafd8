// requires physics/quaternion.wgsl rigid/collide/ball.wgsl rigid/frame/colliders.wgsl rigid/frame/rows.wgsl

// Points of flat pairs on a static shape that another static shape of the same body covers: the sides of tiles in a floor
// (docs/physics section 11.4). A pair may lose all points. If all pairs would, the one nearest to its surface keeps them.

// Thickness of the skin of static shapes, as a share of the width of the moving body.
const SKIN: f32 = 0.5e-3;

// Flag of a pair while its block is looked at: the moving body is inside the static shape, which covers nothing then.
const INSIDE: u32 = 0x00200000u;

fn back_turn(q: vec4f) -> vec4f {
    return vec4f(-q.xyz, q.w);
}

// Whether a shape of the body without mass, other than its own one, is within the skin of a place on the body.
fn is_covered(block: Block, side: u32, own: u32, place: vec3f, skin: f32) -> bool {
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let sides = pairs[PAIR_ROWS * pair + 3u].xy;
        let other = select(sides.x, sides.y, side == 1u);
        if other != own && (pairs[PAIR_ROWS * pair + 1u].w & INSIDE) == 0u {
            let seen = turned_vector(back_turn(turn_of_collider(other)), place - place_of_collider(other));
            if collide_ball(shape_of_collider(other), skin, seen, 0.0).count > 0u {
                return true;
            }
        }
    }
    return false;
}

// The least separation of the points of a pair, on the normal from the static body in its coordinates.
fn least_gap(block: Block, side: u32, first: u32, count: u32, normal: vec3f) -> f32 {
    let still = select(block.a, block.b, side == 1u);
    let loose = select(block.b, block.a, side == 1u);
    var least = 1e38;
    for (var point = first; point < first + count; point++) {
        let place = bitcast<vec3f>(points[POINT_ROWS * point + side].xyz);
        let far = bitcast<vec3f>(points[POINT_ROWS * point + 1u - side].xyz);
        let seen = turned_vector(back_turn(turn_of(still)), place_of(loose) + turned_vector(turn_of(loose), far) - place_of(still));
        least = min(least, dot(seen - place, normal));
    }
    return least;
}

// The normal of a pair from the static body to the other one, in coordinates of the static body.
fn outward_normal(block: Block, side: u32, pair: u32) -> vec3f {
    let normal = bitcast<vec3f>(pairs[PAIR_ROWS * pair + 2u].xyz);
    if side == 0u {
        return normal;
    }
    return -turned_vector(back_turn(turn_of(block.b)), turned_vector(turn_of(block.a), normal));
}

// Marks the pairs whose static shape has the moving body inside.
fn mark_inside(block: Block, side: u32, width: f32) {
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let face = face_at(pair);
        if least_gap(block, side, face.first, count_of(face), outward_normal(block, side, pair)) < -0.5 * width {
            pairs[PAIR_ROWS * pair + 1u].w |= INSIDE;
        }
    }
}

fn expose_block(k: u32) {
    let block = block_at(k);
    if (block.info & FIXED) == 0u || block.pairs < 2u {
        return;
    }
    let side = select(0u, 1u, has_mass(block.a));
    let width = constants[CONSTANT_ROWS * select(block.b, block.a, side == 1u) + 1u].w;
    let skin = SKIN * width;
    mark_inside(block, side, width);
    var left = 0u;
    // The pair nearest to its surface.
    var nearest = block.first_pair;
    var points_of_nearest = 0u;
    var depth = 0.0;
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        let face = face_at(pair);
        let count = count_of(face);
        left += select(0u, count, (face.info & ROUND) != 0u);
        if (face.info & ROUND) != 0u || count == 0u {
            continue;
        }
        let sides = pairs[PAIR_ROWS * pair + 3u].xy;
        let own = select(sides.x, sides.y, side == 1u);
        let normal = outward_normal(block, side, pair);
        var middle = vec3f(0.0);
        for (var point = face.first; point < face.first + count; point++) {
            middle += bitcast<vec3f>(points[POINT_ROWS * point + side].xyz);
        }
        middle /= f32(count);
        let gap = abs(least_gap(block, side, face.first, count, normal));
        if points_of_nearest == 0u || gap < depth {
            nearest = pair;
            points_of_nearest = count;
            depth = gap;
        }
        var kept = 0u;
        for (var point = face.first; point < face.first + count; point++) {
            let place = bitcast<vec3f>(points[POINT_ROWS * point + side].xyz);
            let inward = middle - place;
            let size = length(inward);
            let most = 3.0 * skin;
            let probe = place + 2.0 * skin * normal + select(inward, inward * (most / size), size > most);
            if !is_covered(block, side, own, probe, skin) {
                points[POINT_ROWS * (face.first + kept)] = points[POINT_ROWS * point];
                points[POINT_ROWS * (face.first + kept) + 1u] = points[POINT_ROWS * point + 1u];
                kept++;
            }
        }
        pairs[PAIR_ROWS * pair + 1u].w = (face.info & ~0xffu) | kept;
        left += kept;
    }
    if left == 0u {
        // No point has been moved.
        pairs[PAIR_ROWS * nearest + 1u].w |= points_of_nearest;
    }
    for (var pair = block.first_pair; pair < block.first_pair + block.pairs; pair++) {
        pairs[PAIR_ROWS * pair + 1u].w &= ~INSIDE;
    }
}

@compute @workgroup_size(THREADS)
fn expose(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    let k = thread_of(group, groups, local);
    if k < frame.blocks {
        expose_block(k);
    }
}
