// requires model/objects.wgsl model/order.wgsl model/step.wgsl physics/fine.wgsl physics/geometry.wgsl physics/round_pair.wgsl

// Which contacts of spheres and rods other parts of their chains cover (docs/physics section 2.13).

// Up to this part of its length from a sphere, a rod covers the contact of the sphere with another rod only if the rods touch.
const NEAR_END: f32 = 1e-4;
// The cosine of 0.01 rad. A chain that bends by less is straight.
const STRAIGHT: f32 = 0.99995;
// Factor on a squared radius. A sphere as thick as its rod is inside of it, whatever is rounded.
const INSIDE_ROD: f32 = 1.000001;

// A sphere, or a rod with the parameter of the contact.
struct ChainPart {
    id: u32,
    at: f32,
}

fn is_rod(id: u32) -> bool {
    return (id >= step.spheres) & (id - step.spheres < step.rods);
}

// The vector from the centre of a sphere to another one or to the point of a rod.
fn to_part(sphere: u32, part: ChainPart) -> vec3f {
    if part.id < step.spheres {
        return between(sphere, part.id);
    }
    let ends = rod_ends(part.id - step.spheres);
    return between(sphere, ends.x) + part.at * between(ends.x, ends.y);
}

// Whether two spheres or rods may touch (docs/physics section 1.3).
fn may_touch(part: u32, other: u32) -> bool {
    let tags = topology[step.tags_at + part] ^ topology[step.tags_at + other];
    if ((tags & GROUP_MASK) != 0u) | (inverse_mass_at(part, 0.5) + inverse_mass_at(other, 0.5) <= 0.0) {
        return false;
    }
    if (part < step.spheres) & (other < step.spheres) {
        return !joined(part, bonded_partner(part), other);
    }
    let one = ends_of(part);
    let two = ends_of(other);
    return !(any(one == two) | any(one == two.yx));
}

// The end spheres of a rod; a sphere twice.
fn ends_of(id: u32) -> vec2u {
    if id < step.spheres {
        return vec2u(id);
    }
    return rod_ends(id - step.spheres);
}

// Whether the contact point of a sphere is inside a rod that ends in it. `n` points from the sphere to the other part.
fn sphere_is_inside(sphere: u32, rod: u32, other: ChainPart, n: vec3f) -> bool {
    let ends = rod_ends(rod);
    let axis = between(ends.x, ends.y);
    let squared = dot(axis, axis);
    if squared <= TINY {
        return false;
    }
    // From the middle, towards the sphere: the same parameter and the same limit as in `touch_sphere_rod`.
    let place = dot(axis, to_part(ends.x, other)) / squared - 0.5;
    let towards = select(place, -place, sphere == ends.x);
    let along = dot(n, axis);
    let own = state[position_at(sphere)].w;
    let radius = rod_radius(rod);
    if (towards > 0.5 + AT_END) | (own * own * (1.0 - along * along / squared) > INSIDE_ROD * radius * radius) {
        return false;
    }
    // Last, because it reads most.
    if !may_touch(step.spheres + rod, other.id) {
        return false;
    }
    if (other.id < step.spheres) | (towards < 0.5 - NEAR_END) {
        return true;
    }
    let bar = other.id - step.spheres;
    let first = bar_of(min(rod, bar));
    return touch_rods(first, bar_from(max(rod, bar), first.ends.x)).overlap > 0.0;
}

// The unit vector from an end of a rod along it.
fn along_rod(rod: u32, end: u32) -> vec3f {
    let axis = between(end, other_end(rod, end));
    let squared = dot(axis, axis);
    return select(axis / sqrt(squared), vec3f(0.0), squared <= TINY);
}

// Whether the chain goes on straight at an end of a rod, and the other part is beside the next rod.
fn is_beyond_bend(rod: u32, end: u32, next: u32, other: ChainPart) -> bool {
    if next == rod {
        return false;
    }
    let own = along_rod(rod, end);
    let their = along_rod(next, end);
    if -dot(own, their) < STRAIGHT {
        return false;
    }
    let side = dot(to_part(end, other), own - their);
    return ((side < 0.0) | ((side == 0.0) & (next < rod))) && may_touch(step.spheres + next, other.id);
}

// Whether the sphere at one end of a rod, or another rod that ends there, covers a contact of the rod.
fn is_covered_at(end: u32, own: ChainPart, other: ChainPart) -> bool {
    let rod = own.id - step.spheres;
    let axis = between(end, other_end(rod, end));
    let part = select(1.0 - own.at, own.at, end == rod_ends(rod).x);
    let radius = state[position_at(end)].w;
    if radius * radius > part * part * dot(axis, axis) + rod_radius(rod) * rod_radius(rod) {
        if may_touch(end, other.id) {
            return true;
        }
    }
    let rods = rods_of(end);
    for (var k = 0u; k < rods.y; k++) {
        if is_beyond_bend(rod, end, index_of(topology[rods.x + k]), other) {
            return true;
        }
    }
    return false;
}

// Whether its chain covers a contact on the side `own`. `n` points from it to the other side.
fn is_covered_on(own: ChainPart, other: ChainPart, n: vec3f) -> bool {
    if is_rod(own.id) {
        let ends = rod_ends(own.id - step.spheres);
        for (var k = 0u; k < 2u; k++) {
            if is_covered_at(select(ends.x, ends.y, k == 1u), own, other) {
                return true;
            }
        }
        return false;
    }
    let rods = rods_of(own.id);
    for (var k = 0u; k < rods.y; k++) {
        if sphere_is_inside(own.id, index_of(topology[rods.x + k]), other, n) {
            return true;
        }
    }
    return false;
}

// Whether the contact of two spheres or rods is covered. `n` points from a to b. false for pairs with boxes and polygons.
fn is_covered(a: u32, b: u32, found: Touch) -> bool {
    if !RODS | (max(a, b) >= step.spheres + step.rods) | !(found.overlap > 0.0) {
        return false;
    }
    for (var side = 0u; side < 2u; side++) {
        let is_b = side == 1u;
        let own = ChainPart(select(a, b, is_b), select(found.a, found.b, is_b));
        let other = ChainPart(select(b, a, is_b), select(found.b, found.a, is_b));
        if is_covered_on(own, other, select(found.n, -found.n, is_b)) {
            return true;
        }
    }
    return false;
}

// A contact, unless its chain covers it. `n` points from a to b.
fn uncovered(a: u32, b: u32, found: Touch) -> Touch {
    if is_covered(a, b, found) {
        return no_touch();
    }
    return found;
}

// Contact of a mover with another object, from the one that was added first.
fn contact_with(own: Own, id: u32, feature: u32) -> Touch {
    let pair = ordered(own.id, id);
    return uncovered(pair.x, pair.y, touch_with(own, id, feature));
}

// Contact of two objects. `a` must be a mover.
fn touch(a: u32, b: u32, feature: u32) -> Touch {
    return contact_with(own_of(a), b, feature);
}
