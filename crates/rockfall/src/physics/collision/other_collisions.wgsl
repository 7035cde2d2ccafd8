// requires physics/collision/lone.wgsl physics/collision/plain.wgsl physics/round_pair.wgsl physics/pairs.wgsl

// The other pressed contacts of the bodies of a collision. They decide whether it is lone, and how large its weight is,
// which is its scale in the sweeps (docs/physics sections 3.5 and 3.7).

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

// Solves a collision that is lone or shares no body with another collision. `weight` is its inverse mass.
fn solve_by_itself(a: u32, b: u32, k: Plain, weight: f32, is_lone: bool) -> Solved {
    if is_lone {
        return solve_lone(a, b, 0u, Touch(k.n, k.overlap, 0.0, 0.0));
    }
    return Solved(k.n, 0.0, 0.0, (1.0 + restitution_of(a, b)) * k.approach / weight, 0.0);
}
