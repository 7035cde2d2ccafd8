// requires physics/quaternion.wgsl rigid/collide/round.wgsl rigid/frame/colliders.wgsl rigid/frame/rows.wgsl rigid/frame/scratch.wgsl
// requires rigid/frame/states.wgsl

// The geometry of pairs in a pose of their bodies, with the closest points of round pairs found anew (docs/physics section 11.4).

// Balls of a block may touch several static shapes.
// Pairs of a block that may hide each other: the first ones.
const MOST_HIDDEN: u32 = 32u;
// Normals that differ by less than 0.01 rad are one.
const SAME_NORMAL: f32 = 0.99995;

// Where the points of a pair are.
struct Place {
    normal: vec3f,
    count: u32,
    // First point in memory.
    first: u32,
    // Closest points found anew: at most two. Otherwise the points are those in memory.
    is_anew: bool,
    a_one: vec3f,
    a_two: vec3f,
    b_one: vec3f,
    b_two: vec3f,
    ids: vec2u,
}

// The places of a point on both bodies, from the centre of a.
struct Spot {
    on_a: vec3f,
    on_b: vec3f,
    id: u32,
}

fn columns_of(turn: vec4f) -> mat3x3f {
    return mat3x3f(
        turned_vector(turn, vec3f(1.0, 0.0, 0.0)), turned_vector(turn, vec3f(0.0, 1.0, 0.0)), turned_vector(turn, vec3f(0.0, 0.0, 1.0)));
}

fn place_in(sight: Sight, pair: u32) -> Place {
    let face = face_at(pair);
    var place = Place();
    place.first = face.first;
    if (face.info & ROUND) != 0u {
        let sides = pairs[PAIR_ROWS * pair + 3u].xy;
        // Relative to the centre of a, so that nothing is lost far from the origin.
        let turn = multiply(sight.a.turn, turn_of_collider(sides.x));
        let origin = turned_vector(sight.a.turn, place_of_collider(sides.x));
        let other_turn = multiply(sight.b.turn, turn_of_collider(sides.y));
        let other = sight.apart + turned_vector(sight.b.turn, place_of_collider(sides.y));
        let back = vec4f(-turn.xyz, turn.w);
        let found = collide_round(
            shape_of_collider(sides.x), shape_of_collider(sides.y), turned_vector(back, other - origin),
            columns_of(multiply(back, other_turn)), 3e38);
        if found.count > 0u {
            place.is_anew = true;
            place.count = min(found.count, room_of(face));
            place.normal = turned_vector(turn, found.normal);
            place.a_one = origin + turned_vector(turn, found.on_a[0]);
            place.a_two = origin + turned_vector(turn, found.on_a[1]);
            place.b_one = origin + turned_vector(turn, found.on_b[0]);
            place.b_two = origin + turned_vector(turn, found.on_b[1]);
            place.ids = vec2u(found.ids[0], found.ids[1]);
            return place;
        }
    }
    place.normal = turned_vector(sight.a.turn, inner_normal(pair));
    place.count = count_of(face);
    return place;
}

fn spot_in(sight: Sight, place: Place, k: u32) -> Spot {
    if place.is_anew {
        let second = k == 1u;
        return Spot(
            select(place.a_one, place.a_two, second), select(place.b_one, place.b_two, second), select(place.ids.x, place.ids.y, second));
    }
    let point = place.first + k;
    return Spot(on_a(sight, point), on_b(sight, point), points[POINT_ROWS * point].w);
}

fn gap_of(spot: Spot, normal: vec3f) -> f32 {
    return dot(spot.on_b - spot.on_a, normal);
}

// Of each pair of a block: the unit vector from the centre of its ball to the shape, and the distance; the ball and its radius; which pair
// hides it. Pairs that are hidden are bits.
var<private> seen_places: array<vec4f, MOST_HIDDEN>;
var<private> seen_balls: array<u32, MOST_HIDDEN>;
var<private> hidden_by: array<u32, MOST_HIDDEN>;
var<private> hidden_pairs: u32;

fn ball_radius(ball: u32) -> f32 {
    return shape_of_collider(ball).radius;
}

// Pairs whose places of balls are in `seen_places`, as bits.
var<private> seen_pairs: u32;

fn forget_places() {
    seen_pairs = 0u;
    hidden_pairs = 0u;
}

// Whether a pair of a ball with mass may be hidden: one of the first pairs of a block with several static shapes. Static balls are no part
// of a surface.
fn may_hide(block: Block, pair: u32) -> bool {
    if (block.info & SEAMS) == 0u || pair - block.first_pair >= MOST_HIDDEN {
        return false;
    }
    let sides = pairs[PAIR_ROWS * pair + 3u].xy;
    let a_is_ball = shape_of_collider(sides.x).core == CORE_POINT;
    let b_is_ball = shape_of_collider(sides.y).core == CORE_POINT;
    return a_is_ball != b_is_ball && has_mass(select(block.b, block.a, a_is_ball));
}

// Takes note of the place of a pair that may be hidden.
fn see_place(block: Block, pair: u32, sight: Sight, place: Place) {
    if place.count != 1u {
        return;
    }
    let k = pair - block.first_pair;
    let sides = pairs[PAIR_ROWS * pair + 3u].xy;
    let a_is_ball = shape_of_collider(sides.x).core == CORE_POINT;
    let ball = select(sides.y, sides.x, a_is_ball);
    let distance = gap_of(spot_in(sight, place, 0u), place.normal) + ball_radius(ball);
    seen_places[k] = vec4f(select(-place.normal, place.normal, a_is_ball), distance);
    seen_balls[k] = ball;
    seen_pairs |= 1u << k;
}

// Which of the places that were seen are hidden by nearer places of the same ball.
fn hide_places(block: Block) {
    let count = min(block.pairs, MOST_HIDDEN);
    var waiting = seen_pairs;
    let all = waiting;
    for (var rank = 0u; rank < MOST_HIDDEN && waiting != 0u; rank++) {
        var next = MOST_HIDDEN;
        for (var k = 0u; k < MOST_HIDDEN && k < count; k++) {
            if ((waiting >> k) & 1u) == 1u && (next == MOST_HIDDEN || seen_places[k].w < seen_places[next].w) {
                next = k;
            }
        }
        let own = seen_places[next];
        let slack = 1e-5 * ball_radius(seen_balls[next]);
        var by = MOST_HIDDEN;
        for (var k = 0u; k < MOST_HIDDEN && k < count; k++) {
            // Those before it that are not hidden.
            if (((all & ~(waiting | hidden_pairs)) >> k) & 1u) == 0u || seen_balls[k] != seen_balls[next] {
                continue;
            }
            let cosine = dot(own.xyz, seen_places[k].xyz);
            let hides = own.w * cosine >= seen_places[k].w - slack || cosine >= SAME_NORMAL;
            if hides && (by == MOST_HIDDEN || seen_places[k].w < seen_places[by].w) {
                by = k;
            }
        }
        waiting &= ~(1u << next);
        if by < MOST_HIDDEN {
            hidden_pairs |= 1u << next;
            hidden_by[next] = by;
        }
    }
}

// Whether the last search has found that a pair of its block is hidden.
fn is_hidden(block: Block, pair: u32) -> bool {
    let k = pair - block.first_pair;
    return k < MOST_HIDDEN && ((hidden_pairs >> k) & 1u) == 1u;
}
