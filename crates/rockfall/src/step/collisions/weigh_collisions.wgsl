// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/collision_state.wgsl model/step.wgsl physics/collision.wgsl
// requires physics/collision/other_collisions.wgsl physics/collision/couplings.wgsl physics/collision/impulses.wgsl
// requires physics/chain.wgsl physics/collision/plain.wgsl physics/collision/lone.wgsl physics/contact.wgsl physics/geometry.wgsl physics/pairs.wgsl
// requires step/collisions/has_changes.wgsl step/collisions/record_of.wgsl step/collisions/records.wgsl
// requires step/collisions/rows.wgsl step/collisions/report_clusters.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read> collision_indices: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read_write> collisions: array<vec4u>;
@group(0) @binding(7) var<storage, read_write> status: StatusAtomic;

// Whether an entry of a row is collision k, seen from either side.
fn is_same(k: Record, row: u32, entry: u32) -> bool {
    let id = entry_id(entry);
    let is_pair = ((row == k.a_id) & (id == k.b_id)) | ((row == k.b_id) & (id == k.a_id));
    return is_pair & (entry_feature(entry) == k.feature);
}

// Whether the entry is a contact of the sphere itself with a static object, and its normal is perpendicular to n.
fn is_across(sphere: u32, entry: u32, n: vec3f) -> bool {
    if entry_id(entry) < step.spheres + step.rods {
        return false;
    }
    return abs(dot(touch_static(sphere, entry_id(entry), state[position_at(sphere)]).n, n)) <= PERPENDICULAR;
}

// The other pressed contacts of a body of collision k. The body is a moving sphere with the rods that end in it, or the
// capsule of that sphere. The sphere does not belong to a network. `is_single` says that it does not belong to a capsule.
fn company_of(k: Record, sphere: u32, is_single: bool) -> OtherContacts {
    var company = no_company();
    let rods = rods_of(sphere);
    for (var r = 0u; r < 1u + 2u * rods.y; r++) {
        let row = row_of(sphere, rods, r);
        if row != NONE {
            add_row(k, sphere, row, is_single, &company);
        }
    }
    return company;
}

fn add_row(k: Record, sphere: u32, row: u32, is_single: bool, company: ptr<function, OtherContacts>) {
    let count = count_of(row);
    let first = first_of(row);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_OVERLAPS, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let slot = slot_at(first, begin + firstTrailingBit(rest));
            let entry = entry_at(slot);
            if is_same(k, row, entry) {
                continue;
            }
            if (entry & ENTRY_COLLIDES) != 0u {
                (*company).others += 1u;
                (*company).weight += abs(dot(record_at(record_of(slot)).n, k.n));
            }
            if (*company).is_undisturbed {
                (*company).is_undisturbed = (row == sphere) & is_single & is_across(sphere, entry, k.n);
            }
        }
    }
}

// What the bodies of a collision add to its weight. `weigh_bodies` calls `weight_of_end` in one place, for both ends of both sides:
// software drivers compile a copy of a function for each call, and the contacts of a sphere take long to compile.
struct Weight {
    // The scale of the impulse in the sweeps (docs/physics section 3.7).
    weight: f32,
    // Projected, on networks.
    inverse_mass: f32,
    is_undisturbed: bool,
    others: u32,
    // Whether a body is a network. The sweeps compute its changes of velocity.
    is_swept: bool,
}

fn weigh_bodies(k: Record, r: u32) -> Weight {
    var sum = Weight(0.0, 0.0, true, 0u, false);
    for (var side = 0u; side < 2u; side++) {
        let half = side_of_record(k, side);
        // A sphere has one end, and both ends of a capsule have the same rows.
        let ends = select(u32(half.kind != STATIC), 2u, (half.kind == ROD) && !is_of_network(half));
        for (var end = 0u; end < ends; end++) {
            let one = weight_of_end(k, half, end, network_weight(r, 2u * side + end));
            sum.weight += one.weight;
            sum.inverse_mass += one.inverse_mass;
            sum.is_undisturbed &= one.is_undisturbed;
            sum.others += one.others;
            sum.is_swept |= one.is_swept;
        }
    }
    return sum;
}

fn is_of_network(rod: ContactSide) -> bool {
    return network_of_rod(rod.id - step.spheres) != NO_NETWORK;
}

// What one end of a side adds. `of_network` is the `network_weight` of the end.
fn weight_of_end(k: Record, half: ContactSide, end: u32, of_network: vec3f) -> Weight {
    if (half.kind == ROD) && is_of_network(half) {
        return weight_of_network(of_network);
    }
    let one = side_end(half, end);
    let w = inverse_mass(one.sphere);
    if half.kind != CAPSULE {
        if w <= 0.0 {
            return Weight(0.0, 0.0, true, 0u, false);
        }
        if network_of(one.sphere) != NO_NETWORK {
            return weight_of_network(of_network);
        }
    }
    let company = company_of(k, one.sphere, half.kind != CAPSULE);
    var inverse_mass = one.share * one.share * w;
    var weight = company.weight * inverse_mass;
    if half.kind == CAPSULE {
        inverse_mass = response(half, side_motion(half), k.n).y;
        weight = f32(1u + company.others) * inverse_mass;
    }
    return Weight(weight, inverse_mass, company.is_undisturbed, company.others, false);
}

fn weight_of_network(of_network: vec3f) -> Weight {
    return Weight(of_network.x, of_network.z, false, u32(max(of_network.y, 1.0)) - 1u, true);
}

// Stores a collision whose impulse is known.
fn put_solved(r: u32, solved: Solved, state_: f32) {
    let k = collisions[row_at(r, 1u)];
    let at = bitcast<vec2u>(vec2f(solved.a, solved.b));
    collisions[row_at(r, 1u)] = vec4u(k.xy, at.x, at.y);
    collisions[row_at(r, 2u)] = bitcast<vec4u>(vec4f(solved.n, 0.0));
    collisions[row_at(r, 3u)] = bitcast<vec4u>(vec4f(solved.impulse, solved.impulse, 0.0, state_));
}

// Stores a collision that is left to the sweeps.
fn put_swept(r: u32, inverse: f32) {
    collisions[row_at(r, 3u)] = bitcast<vec4u>(vec4f(0.0, 0.0, inverse, SHARED));
    note_cluster();
}

// The other pressed contacts of a sphere without rods. Also stores the coupling of each of its collisions with collision k.
// `side` is 1 for A, -1 for B.
fn plain_company_with_couplings(k: Record, number: u32, sphere: u32, side: f32) -> OtherContacts {
    var company = no_company();
    let own = state[position_at(sphere)];
    let velocity = state[velocity_at(sphere)];
    if velocity.w <= 0.0 {
        return company;
    }
    let count = count_of(sphere);
    let first = first_of(sphere);
    for (var begin = 0u; begin < count; begin += ENTRIES_PER_MASK) {
        for (var rest = entries_with(ENTRY_OVERLAPS, first, begin, count); rest != 0u; rest &= rest - 1u) {
            let slot = slot_at(first, begin + firstTrailingBit(rest));
            let entry = entry_at(slot);
            let collides = (entry & ENTRY_COLLIDES) != 0u;
            var along = 0.0;
            var is_own = false;
            if collides {
                let r = record_of(slot);
                let together = dot(record_at(r).n, k.n);
                is_own = r == number;
                put_coupling(r, number, side * velocity.w * part_on(sphere, sphere, r) * together);
                along = abs(together);
            }
            if !is_own {
                let is_static = entry_id(entry) >= step.spheres;
                company.others += u32(collides);
                company.weight += along;
                company.is_undisturbed &= is_static;
                if company.is_undisturbed {
                    company.is_undisturbed = is_across(sphere, entry, k.n);
                }
            }
        }
    }
    return company;
}

fn weigh_plain(r: u32) {
    let k = record_at(r);
    begin_couplings();
    let one = plain_company_with_couplings(k, r, k.a_id, 1.0);
    var two = no_company();
    var weight = one.weight * inverse_mass(k.a_id);
    if k.b_id < step.spheres {
        two = plain_company_with_couplings(k, r, k.b_id, -1.0);
        weight += two.weight * inverse_mass(k.b_id);
    }
    let is_lone = one.is_undisturbed & two.is_undisturbed;
    if !is_lone & (one.others + two.others > 0u) {
        put_swept(r, 1.0 / weight);
        put_couplings(r, false);
        return;
    }
    // Solved on its own, in the same way as in a step that does not list its collisions.
    let solved = solve_by_itself(k.a_id, k.b_id, plain_contact(k.a_id, k.b_id), weight, is_lone);
    put_solved(r, solved, select(SINGLE, solved.tau, is_lone));
}

fn weigh(r: u32) {
    let k = record_at(r);
    begin_couplings();
    let sum = weigh_bodies(k, r);
    if sum.is_undisturbed {
        let solved = solve_lone(k.a_id, k.b_id, k.feature, touch(k.a_id, k.b_id, k.feature));
        put_solved(r, solved, solved.tau);
        return;
    }
    // A contact that rods keep from moving along n gets no impulse (docs/physics section 3.4).
    let a = side_of_record(k, 0u);
    let b = side_of_record(k, 1u);
    let unprojected = approach_of(a, b, side_motion(a), side_motion(b), k.n).inverse_mass;
    let inverse = select(0.0, 1.0 / sum.weight, sum.inverse_mass > RIGID * unprojected);
    let is_only = sum.others == 0u;
    if !is_only | sum.is_swept {
        put_swept(r, inverse);
        find_couplings(k, r, is_only);
    } else {
        let impulse = (1.0 + restitution_of(k.a_id, k.b_id)) * k.approach * inverse;
        put_solved(r, Solved(k.n, k.a, k.b, impulse, 0.0), SINGLE);
    }
}

// An inverse mass below this fraction of the value before the projection is a rounding error.
const RIGID: f32 = 1e-6;

@compute @workgroup_size(64)
fn weigh_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if !has_changes() {
        return;
    }
    let records = listed_records();
    for (var r = linear_thread(group, groups, local); r < records; r += groups.x * groups.y * WORKGROUP) {
        if RODS {
            weigh(r);
        } else {
            weigh_plain(r);
        }
    }
}
