// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision/plain.wgsl
// requires physics/collision/lone.wgsl physics/contact.wgsl physics/geometry.wgsl

// What else touches the bodies of a collision: whether it is lone, and how much its impulse has to be held back
// (docs/physics.md sections 3.3 and 3.5).

// Contacts of a body with static objects that are this near to perpendicular do not disturb each other.
const PERPENDICULAR: f32 = 0.001;

struct Company {
    // Nothing else presses the body.
    is_alone: bool,
    // Other collisions of the body.
    others: u32,
    // Sum of |n . n'| over the collisions of a sphere, this one included.
    weight: f32,
}

fn no_company() -> Company {
    return Company(true, 0u, 1.0);
}

// Adds the contacts of a sphere without rods, that with `other` left out, to the company of a collision of normal n there.
fn plain_company(sphere: u32, other: u32, n: vec3f) -> Company {
    var company = no_company();
    let velocity = state[velocity_at(sphere)];
    if velocity.w <= 0.0 {
        return company;
    }
    let own = state[position_at(sphere)];
    let count = count_of(sphere);
    let first = first_of(sphere);
    for (var begin = 0u; begin < count; begin += LOOK) {
        var rest = entries_with(ENTRY_OVERLAPS, first, begin, count);
        var now = meet(first, begin, rest);
        while rest != 0u {
            rest &= rest - 1u;
            let ahead = meet(first, begin, rest);
            if entry_id(now.entry) != other {
                add_company(sphere, own, velocity, now, n, &company);
            }
            now = ahead;
        }
    }
    return company;
}

fn add_company(sphere: u32, own: vec4f, velocity: vec4f, other: Met, n: vec3f, company: ptr<function, Company>) {
    let is_static = entry_id(other.entry) >= step.spheres + step.rods;
    let collides = (other.entry & ENTRY_COLLIDES) != 0u;
    (*company).is_alone &= is_static;
    (*company).others += u32(collides);
    if collides | is_static {
        let along = abs(dot(n, plain_with(sphere, own, velocity, other).n));
        (*company).is_alone &= along <= PERPENDICULAR;
        (*company).weight += select(0.0, along, collides);
    }
}

// The impulse of a collision between spheres without rods, or of one with a static object.
struct Plainly {
    solved: Solved,
    // Whether another collision shares a body with it and it is not lone.
    is_shared: bool,
}

fn solve_plain(a: u32, b: u32) -> Plainly {
    let k = plain_contact(a, b);
    let one = plain_company(a, b, k.n);
    var two = no_company();
    var weight = one.weight * inverse_mass(a);
    if b < step.spheres {
        two = plain_company(b, a, k.n);
        weight += two.weight * inverse_mass(b);
    }
    let is_lone = one.is_alone & two.is_alone;
    let is_shared = !is_lone & (one.others + two.others > 0u);
    return Plainly(solve_by_itself(a, b, k, weight, is_lone), is_shared);
}

// The impulse of a collision that shares no body with another; `weight` is the inverse mass that it meets.
fn solve_by_itself(a: u32, b: u32, k: Plain, weight: f32, is_lone: bool) -> Solved {
    if is_lone {
        return solve_lone(a, b, 0u, Touch(k.n, k.overlap, 0.0, 0.0));
    }
    return Solved(k.n, 0.0, 0.0, (1.0 + step.restitution) * k.approach / weight, 0.0);
}
