// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl physics/collision/plain.wgsl
// requires physics/collision/lone.wgsl physics/contact.wgsl physics/geometry.wgsl physics/pairs.wgsl

// The other pressed contacts of the bodies of a collision. They decide whether it is lone, and how large its weight is,
// which is its scale in the sweeps (docs/physics.md sections 3.5 and 3.7).

// Normals are perpendicular when the absolute cosine of their angle is at most this. Contacts of a sphere with static
// objects do not influence a collision whose normal is perpendicular to theirs.
const PERPENDICULAR: f32 = 0.001;

struct OtherContacts {
    // Whether no other pressed contact of the body influences the collision.
    is_undisturbed: bool,
    // Number of other collisions on the body.
    others: u32,
    // Sum of |n . n'| over the collisions on a sphere, this one included.
    weight: f32,
}

fn no_company() -> OtherContacts {
    return OtherContacts(true, 0u, 1.0);
}

// The other pressed contacts of a sphere without rods, for its collision of normal n with object `other`.
fn plain_company(sphere: u32, other: u32, n: vec3f) -> OtherContacts {
    var company = no_company();
    let velocity = state[velocity_at(sphere)];
    if velocity.w <= 0.0 {
        return company;
    }
    let own = state[position_at(sphere)];
    let count = count_of(sphere);
    let first = first_of(sphere);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
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

fn add_company(sphere: u32, own: vec4f, velocity: vec4f, other: LoadedEntry, n: vec3f, company: ptr<function, OtherContacts>) {
    let is_static = entry_id(other.entry) >= step.spheres + step.rods;
    let collides = (other.entry & ENTRY_COLLIDES) != 0u;
    (*company).is_undisturbed &= is_static;
    (*company).others += u32(collides);
    if collides | is_static {
        let along = abs(dot(n, plain_with(sphere, own, velocity, other).n));
        (*company).is_undisturbed &= along <= PERPENDICULAR;
        (*company).weight += select(0.0, along, collides);
    }
}

// The solution of a collision between two spheres without rods, or of such a sphere with a static object.
struct PlainSolution {
    solved: Solved,
    // Whether the collision is not lone and shares a body with another collision.
    is_shared: bool,
}

fn solve_plain(a: u32, b: u32) -> PlainSolution {
    let k = plain_contact(a, b);
    let one = plain_company(a, b, k.n);
    var two = no_company();
    var weight = one.weight * inverse_mass(a);
    if b < step.spheres {
        two = plain_company(b, a, k.n);
        weight += two.weight * inverse_mass(b);
    }
    let is_lone = one.is_undisturbed & two.is_undisturbed;
    let is_shared = !is_lone & (one.others + two.others > 0u);
    return PlainSolution(solve_by_itself(a, b, k, weight, is_lone), is_shared);
}

// Solves a collision that is lone or shares no body with another collision. `weight` is its inverse mass.
fn solve_by_itself(a: u32, b: u32, k: Plain, weight: f32, is_lone: bool) -> Solved {
    if is_lone {
        return solve_lone(a, b, 0u, Touch(k.n, k.overlap, 0.0, 0.0));
    }
    return Solved(k.n, 0.0, 0.0, (1.0 + restitution_of(a, b)) * k.approach / weight, 0.0);
}
