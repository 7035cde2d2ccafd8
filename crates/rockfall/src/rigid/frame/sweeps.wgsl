// requires rigid/frame/rows.wgsl

// The rows of a block (docs/physics.md section 11.8).

const SWEEPS: u32 = 4u;
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

// A point while its block is solved.
struct Contact {
    arm: vec3f,
    gap: f32,
    normal: f32,
    tangent: vec2f,
    spare: f32,
    // 1 / K_n; 0 as long as the rest is not formed. Most points of a frame never act.
    inverse_normal: f32,
    // Inverse of K_t: xx, yy, xy.
    inverse_tangent: vec3f,
    // 1 / k_max.
    inverse_slip: f32,
    // It has a normal row in this pass.
    live: bool,
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

fn contact_at(k: u32, rule: Rule) -> Contact {
    let one = contacts[2u * k];
    let two = contacts[2u * k + 1u];
    let live = rule.biased | (one.w <= 0.0) | (two.x > 0.0);
    return Contact(one.xyz, one.w, two.x, two.yz, two.w, 0.0, vec3f(0.0), 0.0, live);
}

fn put_contact(k: u32, contact: Contact) {
    contacts[2u * k + 1u] = vec4f(contact.normal, contact.tangent, contact.spare);
}

// K for two directions, of one side.
fn coupling(mass: Mass, arm: vec3f, one: vec3f, two: vec3f) -> f32 {
    return dot(cross(arm, one), respond(mass, cross(arm, two)));
}

fn coupling_of_sides(sides: ptr<function, Sides>, arm: vec3f, one: vec3f, two: vec3f) -> f32 {
    return coupling((*sides).mass_a, arm, one, two) + coupling((*sides).mass_b, arm - (*sides).apart, one, two);
}

fn form(contact: ptr<function, Contact>, sides: ptr<function, Sides>, axes: Axes) {
    let arm = (*contact).arm;
    let mass = (*sides).mass_a.inverse + (*sides).mass_b.inverse;
    (*contact).inverse_normal = 1.0 / (mass + coupling_of_sides(sides, arm, axes.normal, axes.normal));
    let k_one = mass + coupling_of_sides(sides, arm, axes.one, axes.one);
    let k_two = mass + coupling_of_sides(sides, arm, axes.two, axes.two);
    let k_both = coupling_of_sides(sides, arm, axes.one, axes.two);
    let apart = 0.5 * (k_one - k_two);
    (*contact).inverse_tangent = vec3f(k_two, k_one, -k_both) / (k_one * k_two - k_both * k_both);
    (*contact).inverse_slip = 1.0 / (0.5 * (k_one + k_two) + sqrt(apart * apart + k_both * k_both));
}

// Velocity of b relative to a at a point.
fn opening(sides: ptr<function, Sides>, arm: vec3f) -> vec3f {
    let a = (*sides).a;
    let b = (*sides).b;
    return b.velocity + cross(b.spin, arm - (*sides).apart) - a.velocity - cross(a.spin, arm);
}

fn push(sides: ptr<function, Sides>, arm: vec3f, impulse: vec3f) {
    (*sides).a.velocity -= (*sides).mass_a.inverse * impulse;
    (*sides).a.spin -= respond((*sides).mass_a, cross(arm, impulse));
    (*sides).b.velocity += (*sides).mass_b.inverse * impulse;
    (*sides).b.spin += respond((*sides).mass_b, cross(arm - (*sides).apart, impulse));
}

// A normal row. Returns the change of the impulse.
fn normal_row(contact: ptr<function, Contact>, sides: ptr<function, Sides>, axes: Axes, rule: Rule) -> f32 {
    if !(*contact).live {
        return 0.0;
    }
    let speed = dot(opening(sides, (*contact).arm), axes.normal);
    let gap = (*contact).gap;
    let old = (*contact).normal;
    var wanted = speed;
    var kept = 1.0;
    if rule.biased & (gap <= 0.0) {
        wanted = rule.soft.x * speed + max(rule.soft.y * gap, -PUSH_OUT);
        kept = 1.0 - rule.soft.z;
    } else if rule.biased {
        wanted = speed + (gap + max((*contact).spare, 0.0)) / rule.time;
    }
    if (old == 0.0) & (wanted >= 0.0) {
        return 0.0;
    }
    if (*contact).inverse_normal == 0.0 {
        form(contact, sides, axes);
    }
    let normal = max(kept * old - wanted * (*contact).inverse_normal, 0.0);
    (*contact).normal = normal;
    push(sides, (*contact).arm, (normal - old) * axes.normal);
    return abs(normal - old);
}

// A friction row. Returns the change of the impulse.
fn friction_row(contact: ptr<function, Contact>, sides: ptr<function, Sides>, axes: Axes) -> f32 {
    let old = (*contact).tangent;
    if !(((*contact).normal > 0.0) | any(old != vec2f(0.0))) {
        return 0.0;
    }
    if (*contact).inverse_normal == 0.0 {
        form(contact, sides, axes);
    }
    let open = opening(sides, (*contact).arm);
    let slip = vec2f(dot(open, axes.one), dot(open, axes.two)) + axes.belt;
    let bound = axes.friction * (*contact).normal;
    let k = (*contact).inverse_tangent;
    var next = old - vec2f(k.x * slip.x + k.z * slip.y, k.z * slip.x + k.y * slip.y);
    if length(next) > bound {
        next = old - (*contact).inverse_slip * slip;
        let size = length(next);
        if size > bound {
            next *= bound / size;
        }
    }
    let change = next - old;
    (*contact).tangent = next;
    push(sides, (*contact).arm, change.x * axes.one + change.y * axes.two);
    return length(change);
}

// Sweeps over a block with one pair: its points stay in registers. Returns whether an impulse has changed.
fn sweep_pair(face: Face, sides: ptr<function, Sides>, rule: Rule) -> bool {
    let axes = axes_of(face);
    let count = count_of(face);
    let first = face.first;
    if count == 0u {
        return false;
    }
    var one = contact_at(first, rule);
    var two = one;
    var three = one;
    var four = one;
    if count > 1u {
        two = contact_at(first + 1u, rule);
    }
    if count > 2u {
        three = contact_at(first + 2u, rule);
    }
    if count > 3u {
        four = contact_at(first + 3u, rule);
    }
    var acted = false;
    for (var sweep = 0u; sweep < SWEEPS; sweep++) {
        var change = normal_row(&one, sides, axes, rule);
        var largest = one.normal;
        if count > 1u {
            change = max(change, normal_row(&two, sides, axes, rule));
            largest = max(largest, two.normal);
        }
        if count > 2u {
            change = max(change, normal_row(&three, sides, axes, rule));
            largest = max(largest, three.normal);
        }
        if count > 3u {
            change = max(change, normal_row(&four, sides, axes, rule));
            largest = max(largest, four.normal);
        }
        change = max(change, friction_row(&one, sides, axes));
        if count > 1u {
            change = max(change, friction_row(&two, sides, axes));
        }
        if count > 2u {
            change = max(change, friction_row(&three, sides, axes));
        }
        if count > 3u {
            change = max(change, friction_row(&four, sides, axes));
        }
        acted |= change > 0.0;
        if change <= LAST_CHANGE * largest {
            break;
        }
    }
    if !acted {
        return false;
    }
    put_contact(first, one);
    if count > 1u {
        put_contact(first + 1u, two);
    }
    if count > 2u {
        put_contact(first + 2u, three);
    }
    if count > 3u {
        put_contact(first + 3u, four);
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
                contacts[2u * k + 1u].w = select(-1.0, 0.0, contact_at(k, rule).live);
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
            for (var row = 0u; row < 2u; row++) {
                for (var pair = chunk; pair < next; pair++) {
                    let face = face_at(pair);
                    let axes = axes_of(face);
                    for (var k = face.first; k < face.first + count_of(face); k++) {
                        var contact = contact_at(k, rule);
                        contact.live = rule.biased | (contact.spare >= 0.0);
                        var moved = 0.0;
                        if row == 0u {
                            moved = normal_row(&contact, sides, axes, rule);
                            largest = max(largest, contact.normal);
                        } else {
                            moved = friction_row(&contact, sides, axes);
                        }
                        if moved > 0.0 {
                            put_contact(k, contact);
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
