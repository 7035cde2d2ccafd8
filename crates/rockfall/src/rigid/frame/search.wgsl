// requires physics/quaternion.wgsl rigid/frame/places.wgsl rigid/frame/rows.wgsl rigid/frame/states.wgsl rigid/frame/turn.wgsl

// The search for the touch of a round pair along the paths of its bodies (docs/physics section 11.7).

const SEARCH_STEPS: u32 = 8u;
struct Search {
    // The geometry at the start.
    first: Place,
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

fn path_at(block: Block, time: f32, is_kicked: bool) -> Sight {
    if !is_kicked {
        return sight_at(block, time);
    }
    let a = kicked_state_at(block.a, time);
    let b = kicked_state_at(block.b, time);
    return Sight(a, b, b.place - a.place);
}

// Whether a point of a round pair may touch on the way, faster than `least`.
fn may_touch(block: Block, pair: u32, sight: Sight, place: Place, start: f32, least: f32) -> bool {
    if (face_at(pair).info & ROUND) == 0u {
        return false;
    }
    let rest = frame.h - start;
    let pull = max(-dot(field_of(block.b) - field_of(block.a), place.normal), 0.0);
    for (var k = 0u; k < MOST_POINTS && k < place.count; k++) {
        let spot = spot_in(sight, place, k);
        let gap = gap_of(spot, place.normal);
        let u = approach_at(sight, 0.5 * (spot.on_a + spot.on_b), place.normal);
        let late = late_of(u, rest, least_radius(block));
        let is_fast = u > least && u + pull * rest > length(frame.gravity) * frame.h;
        if gap > 0.0 && is_fast && gap - u * (rest + late) - 0.5 * pull * rest * rest <= 0.0 {
            return true;
        }
    }
    return false;
}

// The gap of a convex pair is convex along straight paths, so the steps come from below. On the path without the kick it ends at once where
// nothing touches that is faster than `least`.
fn search(block: Block, pair: u32, start: f32, is_kicked: bool, least: f32) -> Search {
    let rest = frame.h - start;
    let radius = least_radius(block);
    var found = Search(Place(), false, 0.0, 0.0, 3e38);
    var time = 0.0;
    for (var step = 0u; step < SEARCH_STEPS; step++) {
        let sight = path_at(block, start + time, is_kicked);
        let place = place_in(sight, pair);
        if step == 0u {
            found.first = place;
            if !is_kicked && !may_touch(block, pair, sight, place, start, least) {
                return found;
            }
        }
        var gap = 3e38;
        var speed = 0.0;
        for (var k = 0u; k < MOST_POINTS && k < place.count; k++) {
            let spot = spot_in(sight, place, k);
            if gap_of(spot, place.normal) < gap {
                gap = gap_of(spot, place.normal);
                speed = approach_at(sight, 0.5 * (spot.on_a + spot.on_b), place.normal);
            }
        }
        found.least = min(found.least, gap);
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
