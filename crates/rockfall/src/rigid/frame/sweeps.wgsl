// requires rigid/frame/rows.wgsl

// The rows of a block (docs/physics section 11.8).

const SWEEPS: u32 = 2u;
const LAST_CHANGE: f32 = 1e-3;
const PUSH_OUT: f32 = 3.0;

// Both bodies of a block while it is solved.
struct Sides {
    a: Motion,
    b: Motion,
    mass_a: Mass,
    mass_b: Mass,
    // x_b - x_a.
    apart: vec3f,
}

// What a normal row does.
struct Rule {
    biased: bool,
    // m_s, r, i_s.
    soft: vec3f,
    // h_r.
    time: f32,
}

// How an impulse of 1 along a direction turns both bodies: its moments, and the changes of the spins.
struct Along {
    turn_a: vec3f,
    turn_b: vec3f,
    response_a: vec3f,
    response_b: vec3f,
}

// The normal row of a point: N becomes kept N - (gain v_n + bias) / K_n, but not negative.
struct Press {
    along: Along,
    inverse: f32,
    kept: f32,
    gain: f32,
    bias: f32,
}

// The friction row of a point.
struct Grip {
    one: Along,
    two: Along,
    // Inverse of K_t: xx, yy, xy.
    inverse: vec3f,
    // 1 / k_max.
    slip: f32,
}

// A point while its block is solved: N, T_1, T_2, kappa, and its rows.
struct Contact {
    kept: vec4f,
    press: Press,
    grip: Grip,
}

// The directions of the rows of a pair.
struct Axes {
    normal: vec3f,
    one: vec3f,
    two: vec3f,
    friction: f32,
    belt: vec2f,
}

fn axes_of(face: Face) -> Axes {
    return Axes(face.normal, tangent_one(face.normal), tangent_two(face.normal), face.friction, face.belt);
}

fn along_of(sides: ptr<function, Sides>, arm: vec3f, direction: vec3f) -> Along {
    let turn_a = cross(arm, direction);
    let turn_b = cross(arm - (*sides).apart, direction);
    return Along(turn_a, turn_b, respond((*sides).mass_a, turn_a), respond((*sides).mass_b, turn_b));
}

fn inverse_masses(sides: ptr<function, Sides>) -> f32 {
    return (*sides).mass_a.inverse + (*sides).mass_b.inverse;
}

// What two directions have in common in K, without the masses.
fn coupling(one: Along, two: Along) -> f32 {
    return dot(one.turn_a, two.response_a) + dot(one.turn_b, two.response_b);
}

// Velocity of b relative to a at a point, along a direction.
fn speed_along(sides: ptr<function, Sides>, direction: vec3f, along: Along) -> f32 {
    let straight = dot(direction, (*sides).b.velocity - (*sides).a.velocity);
    return straight + (dot(along.turn_b, (*sides).b.spin) - dot(along.turn_a, (*sides).a.spin));
}

fn push(sides: ptr<function, Sides>, direction: vec3f, along: Along, impulse: f32) {
    (*sides).a.velocity -= ((*sides).mass_a.inverse * impulse) * direction;
    (*sides).a.spin -= impulse * along.response_a;
    (*sides).b.velocity += ((*sides).mass_b.inverse * impulse) * direction;
    (*sides).b.spin += impulse * along.response_b;
}

// Whether a point has a normal row in this pass.
fn is_live(rule: Rule, gap: f32, normal: f32) -> bool {
    return rule.biased | (gap <= 0.0) | (normal > 0.0);
}

fn press_of(sides: ptr<function, Sides>, place: vec4f, spare: f32, live: bool, axes: Axes, rule: Rule) -> Press {
    let along = along_of(sides, place.xyz, axes.normal);
    let inverse = 1.0 / (inverse_masses(sides) + coupling(along, along));
    var press = Press(along, select(0.0, inverse, live), 1.0, 1.0, 0.0);
    if rule.biased & (place.w <= 0.0) {
        press.kept = 1.0 - rule.soft.z;
        press.gain = rule.soft.x;
        press.bias = max(rule.soft.y * place.w, -PUSH_OUT);
    } else if rule.biased {
        press.bias = (place.w + max(spare, 0.0)) / rule.time;
    }
    return press;
}

fn grip_of(sides: ptr<function, Sides>, arm: vec3f, axes: Axes) -> Grip {
    let one = along_of(sides, arm, axes.one);
    let two = along_of(sides, arm, axes.two);
    let mass = inverse_masses(sides);
    let k_one = mass + coupling(one, one);
    let k_two = mass + coupling(two, two);
    let k_both = coupling(one, two);
    let apart = 0.5 * (k_one - k_two);
    let inverse = vec3f(k_two, k_one, -k_both) / (k_one * k_two - k_both * k_both);
    return Grip(one, two, inverse, 1.0 / (0.5 * (k_one + k_two) + sqrt(apart * apart + k_both * k_both)));
}

// A normal row. Returns the new impulse.
fn normal_row(sides: ptr<function, Sides>, press: Press, axes: Axes, old: f32) -> f32 {
    let speed = speed_along(sides, axes.normal, press.along);
    let next = max(press.kept * old - (press.gain * speed + press.bias) * press.inverse, 0.0);
    push(sides, axes.normal, press.along, next - old);
    return next;
}

// A friction row. Returns the new impulse.
fn friction_row(sides: ptr<function, Sides>, grip: Grip, axes: Axes, normal: f32, old: vec2f) -> vec2f {
    if !((normal > 0.0) | any(old != vec2f(0.0))) {
        return old;
    }
    let slip = vec2f(speed_along(sides, axes.one, grip.one), speed_along(sides, axes.two, grip.two)) + axes.belt;
    let bound = axes.friction * normal;
    let k = grip.inverse;
    var next = old - vec2f(k.x * slip.x + k.z * slip.y, k.z * slip.x + k.y * slip.y);
    if length(next) > bound {
        next = old - grip.slip * slip;
        let size = length(next);
        if size > bound {
            next *= bound / size;
        }
    }
    push(sides, axes.one, grip.one, next.x - old.x);
    push(sides, axes.two, grip.two, next.y - old.y);
    return next;
}

fn contact_at(sides: ptr<function, Sides>, k: u32, axes: Axes, rule: Rule) -> Contact {
    let place = contacts[2u * k];
    let kept = contacts[2u * k + 1u];
    let press = press_of(sides, place, kept.w, is_live(rule, place.w, kept.x), axes, rule);
    var grip: Grip;
    if !rule.biased {
        grip = grip_of(sides, place.xyz, axes);
    }
    return Contact(kept, press, grip);
}

// The normal row of a point, and its friction row. Both return the change of the impulse.
fn press_point(sides: ptr<function, Sides>, contact: ptr<function, Contact>, axes: Axes) -> f32 {
    let old = (*contact).kept.x;
    (*contact).kept.x = normal_row(sides, (*contact).press, axes, old);
    return abs((*contact).kept.x - old);
}

fn grip_point(sides: ptr<function, Sides>, contact: ptr<function, Contact>, axes: Axes) -> f32 {
    let old = (*contact).kept.yz;
    let next = friction_row(sides, (*contact).grip, axes, (*contact).kept.x, old);
    (*contact).kept.y = next.x;
    (*contact).kept.z = next.y;
    return length(next - old);
}

// Sweeps over a block with one pair: its points stay in registers. Returns whether an impulse has changed.
fn sweep_pair(face: Face, sides: ptr<function, Sides>, rule: Rule) -> bool {
    let axes = axes_of(face);
    let count = count_of(face);
    let first = face.first;
    if count == 0u {
        return false;
    }
    var one = contact_at(sides, first, axes, rule);
    var two = one;
    var three = one;
    var four = one;
    if count > 1u {
        two = contact_at(sides, first + 1u, axes, rule);
    }
    if count > 2u {
        three = contact_at(sides, first + 2u, axes, rule);
    }
    if count > 3u {
        four = contact_at(sides, first + 3u, axes, rule);
    }
    var acted = false;
    for (var sweep = 0u; sweep < SWEEPS; sweep++) {
        var change = press_point(sides, &one, axes);
        var largest = one.kept.x;
        if count > 1u {
            change = max(change, press_point(sides, &two, axes));
            largest = max(largest, two.kept.x);
        }
        if count > 2u {
            change = max(change, press_point(sides, &three, axes));
            largest = max(largest, three.kept.x);
        }
        if count > 3u {
            change = max(change, press_point(sides, &four, axes));
            largest = max(largest, four.kept.x);
        }
        if !rule.biased {
            change = max(change, grip_point(sides, &one, axes));
            if count > 1u {
                change = max(change, grip_point(sides, &two, axes));
            }
            if count > 2u {
                change = max(change, grip_point(sides, &three, axes));
            }
            if count > 3u {
                change = max(change, grip_point(sides, &four, axes));
            }
        }
        acted |= change > 0.0;
        if change <= LAST_CHANGE * largest {
            break;
        }
    }
    if !acted {
        return false;
    }
    contacts[2u * first + 1u] = one.kept;
    if count > 1u {
        contacts[2u * first + 3u] = two.kept;
    }
    if count > 2u {
        contacts[2u * first + 5u] = three.kept;
    }
    if count > 3u {
        contacts[2u * first + 7u] = four.kept;
    }
    return true;
}

// Sweeps over a block with several pairs, whose points stay in memory. Points without a normal row in the relax pass are marked by a
// negative kappa, which is 0 for all points after a refresh.
fn sweep_pairs(block: Block, sides: ptr<function, Sides>, rule: Rule) -> bool {
    let end = block.first_pair + block.pairs;
    if !rule.biased {
        for (var pair = block.first_pair; pair < end; pair++) {
            let face = face_at(pair);
            for (var k = face.first; k < face.first + count_of(face); k++) {
                contacts[2u * k + 1u].w = select(-1.0, 0.0, is_live(rule, contacts[2u * k].w, contacts[2u * k + 1u].x));
            }
        }
    }
    var acted = false;
    for (var sweep = 0u; sweep < SWEEPS; sweep++) {
        var change = 0.0;
        var largest = 0.0;
        var chunk = block.first_pair;
        while chunk < end {
            var next = chunk + 1u;
            while next < end && (face_at(next).info & OPENS) == 0u {
                next++;
            }
            // No friction in the biased pass.
            for (var row = 0u; row < select(2u, 1u, rule.biased); row++) {
                for (var pair = chunk; pair < next; pair++) {
                    let face = face_at(pair);
                    let axes = axes_of(face);
                    for (var k = face.first; k < face.first + count_of(face); k++) {
                        let place = contacts[2u * k];
                        var kept = contacts[2u * k + 1u];
                        let old = kept.xyz;
                        if row == 0u {
                            let live = rule.biased | (kept.w >= 0.0);
                            kept.x = normal_row(sides, press_of(sides, place, kept.w, live, axes, rule), axes, old.x);
                            largest = max(largest, kept.x);
                        } else {
                            let next = friction_row(sides, grip_of(sides, place.xyz, axes), axes, old.x, old.yz);
                            kept.y = next.x;
                            kept.z = next.y;
                        }
                        let moved = length(kept.xyz - old);
                        if moved > 0.0 {
                            contacts[2u * k + 1u] = kept;
                            change = max(change, moved);
                        }
                    }
                }
            }
            chunk = next;
        }
        acted |= change > 0.0;
        if change <= LAST_CHANGE * largest {
            break;
        }
    }
    return acted;
}

fn rule_of(block: Block, biased: bool) -> Rule {
    return Rule(biased, frame.soft[(block.info & FIXED) / FIXED].xyz, block.time);
}

// Solves a block. Returns whether an impulse has changed.
fn sweep_block(block: Block, sides: ptr<function, Sides>, biased: bool) -> bool {
    let rule = rule_of(block, biased);
    if (block.info & WAITS) != 0u {
        return false;
    }
    if block.pairs == 1u {
        return sweep_pair(face_at(block.first_pair), sides, rule);
    }
    return sweep_pairs(block, sides, rule);
}
