// requires laws/chosen.wgsl model/objects.wgsl model/order.wgsl model/step.wgsl physics/chain.wgsl
// requires physics/laws/history.wgsl physics/pairs.wgsl physics/rigid.wgsl physics/rigid_parts.wgsl

// Tangential springs that overlapping spheres of a rigid body share (docs/physics section 4.11).

// Two spheres of a rigid body are neighbours if their centres are nearer than this part of the sum of their radii.
const NEIGHBOURS_WITHIN: f32 = 0.99;

// What a contact has of the tangential spring that it shares with contacts of neighbours.
struct SpringShare {
    // Tangential stiffness per that of a contact alone.
    stiffness: f32,
    // The tangential stiffness of the group per that in the last step, while the group unloads; otherwise 1.
    unloading: f32,
    // The contact has neighbours.
    is_shared: bool,
}

// An object, and the spheres of its rigid body.
struct Members {
    id: u32,
    // Number of members, and that of the object among them.
    count: u32,
    own: u32,
    // First words of the members and of their places.
    members: u32,
    places: u32,
}

fn members_of(id: u32) -> Members {
    if (id >= step.spheres) || (body_of_sphere(id) == NO_RIGID) {
        return Members(id, 1u, 0u, 0u, 0u);
    }
    let record = rigid_record(body_of_sphere(id));
    var found = Members(id, topology[record + 13u], 0u, topology[record + 12u], topology[record + 11u] + SHAPE_WORDS);
    while (found.own + 1u < found.count) && (topology[found.members + found.own] != insertion_index(id)) {
        found.own++;
    }
    return found;
}

// The id of a member that is the object itself or overlaps it, or NONE.
fn overlapped(group: Members, k: u32) -> u32 {
    if k == group.own {
        return group.id;
    }
    let apart = vector_at(group.places + 3u * k) - vector_at(group.places + 3u * group.own);
    let radii = group.members + group.count;
    let most = NEIGHBOURS_WITHIN * (float_at(radii + k) + float_at(radii + group.own));
    if dot(apart, apart) >= most * most {
        return NONE;
    }
    return id_of(topology[group.members + k]);
}

// Sums over the contacts of neighbours with the same object, or with neighbours of it, that had a spring in the last step.
struct Neighbours {
    // Forces in the last step and now.
    force: vec2f,
    // What their shares have lost since, and the sum of this times the displacement.
    lost: f32,
    brought: vec3f,
}

// `totals` are the forces of the group in the last step and now.
fn neighbours(of_a: Members, of_b: Members, feature: u32, totals: vec2f) -> Neighbours {
    var sums = Neighbours(vec2f(0.0), 0.0, vec3f(0.0));
    for (var k = 0u; k < of_a.count; k++) {
        let one = overlapped(of_a, k);
        for (var l = 0u; (l < of_b.count) & (one != NONE); l++) {
            let other = overlapped(of_b, l);
            if (other == NONE) | ((k == of_a.own) & (l == of_b.own)) {
                continue;
            }
            let pair = ordered(one, other);
            let spring = spring_of(pair.x, pair.y, feature);
            if !(spring.overlap > 0.0) {
                continue;
            }
            let force = vec2f(law_relative_force(spring.overlap), law_relative_force(touch(pair.x, pair.y, feature).overlap));
            let lost = max(0.0, force.x / totals.x - force.y / totals.y);
            sums.force += force;
            sums.lost += lost;
            sums.brought += select(-lost, lost, pair.x == one) * spring.shift;
        }
    }
    return sums;
}

// The share of a contact with this overlap. `spring` is its own one before the step; it gets what the share brings along.
fn share_in_group(a: u32, b: u32, feature: u32, overlap: f32, spring: ptr<function, Spring>) -> SpringShare {
    if law_relative_force(1.0) == 0.0 {
        return SpringShare(1.0, 1.0, false);
    }
    let of_a = members_of(a);
    let of_b = members_of(b);
    if (of_a.count * of_b.count == 1u) || (cohesion_of(a, b) != 0.0) {
        return SpringShare(1.0, 1.0, false);
    }
    let force = vec2f(law_relative_force((*spring).overlap), law_relative_force(overlap));
    let others = neighbours(of_a, of_b, feature, vec2f(1.0)).force;
    if others.x == 0.0 {
        return SpringShare(1.0, 1.0, false);
    }
    let totals = force + others;
    let sums = neighbours(of_a, of_b, feature, totals);
    let part = force.y / totals.y;
    let before = force.x / totals.x;
    if (part > before) & (sums.lost > 0.0) {
        (*spring).shift = (before * (*spring).shift + (part - before) / sums.lost * sums.brought) / part;
    }
    let unloading = law_stiffness_by_force(min(1.0, totals.y / totals.x));
    return SpringShare(part / law_stiffness_by_force(part), unloading, true);
}
