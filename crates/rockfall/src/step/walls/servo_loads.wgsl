// requires model/entries.wgsl model/lists.wgsl model/one_state.wgsl model/order.wgsl model/step.wgsl physics/chain.wgsl
// requires physics/collision/hidden_crossing.wgsl physics/contact.wgsl physics/forces/due.wgsl physics/forces/sphere_push.wgsl
// requires laws/chosen.wgsl physics/geometry.wgsl physics/round_pair.wgsl physics/laws/before.wgsl
// requires physics/laws/contact.wgsl physics/laws/jkr.wgsl physics/laws/stiffness.wgsl physics/pairs.wgsl
// requires physics/rigid_side.wgsl physics/seams_of_list.wgsl physics/surface.wgsl physics/surfaces_of_list.wgsl
// requires physics/walls.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
@group(0) @binding(4) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(5) var<storage, read_write> histories: array<vec4u>;
@group(0) @binding(6) var<storage, read> servos: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> contributions: array<vec2f>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

// Vectors of the record of a servo (model/servo.rs).
const SERVO_ROWS: u32 = 4u;

// The servo that a wall follows, NONE for none.
fn servo_of(wall: u32) -> u32 {
    let body = body_of(wall);
    for (var servo = 0u; servo < u32(servos[3].y); servo++) {
        if u32(servos[servo * SERVO_ROWS + 2u].w) == body {
            return servo;
        }
    }
    return NONE;
}

// Stiffness and damping of a contact: along the normal, then in the tangent plane.
struct Pliancy {
    stiffness: vec2f,
    damping: vec2f,
}

// The law of sections 4.3 to 4.6. `force` is that on the mover.
fn thesis_pliancy(a_side: Side, b_side: Side, found: Touch, force: vec3f) -> Pliancy {
    let n = found.n;
    let mass = 1.0 / (a_side.inverse_mass + b_side.inverse_mass);
    let apart = b_side.velocity - a_side.velocity - cross(a_side.spin, (a_side.radius - found.overlap) * n);
    let slip = length(apart - dot(apart, n) * n);
    let friction = length(force - dot(force, n) * n);
    return Pliancy(
        vec2f(step.contact_force * mass, 0.0),
        vec2f(step.contact_damping * mass, select(0.0, friction / slip, slip > 0.0)),
    );
}

// A law with history.
fn law_pliancy(a_side: Side, b_side: Side, found: Touch, a: u32, b: u32) -> Pliancy {
    let mass = 1.0 / (a_side.inverse_mass + b_side.inverse_mass);
    let radius = a_side.radius;
    let constants = law_constants_of(a, b);
    var cohesion = 0.0;
    if COHESION {
        cohesion = cohesion_of(a, b);
    }
    let depth = bond_at(cohesion, radius, found.overlap).depth;
    let approach = dot(a_side.velocity - b_side.velocity, found.n);
    let contact = LawContact(a, b, constants, radius, mass, depth, approach, 0.0);
    let answer = law_answer(contact);
    let normal = law_slopes(contact);
    return Pliancy(vec2f(normal.x, answer.stiff.tangential), vec2f(normal.y, answer.dashpot));
}

// What the contact of a mover with a wall of a servo contributes to its force and its stiffness.
fn contribution(mover: u32, wall: u32, feature: u32, servo: u32) -> vec2f {
    let nothing = vec2f(0.0);
    var found = touch(mover, wall, feature);
    if !(found.overlap > 0.0) {
        if !COHESION {
            return nothing;
        }
        found = neck(mover, wall, feature, found);
        if found.overlap == NO_CONTACT_LINE {
            return nothing;
        }
    }
    let a_side = in_body(side_of(mover, found.a), mover, found.a, found);
    let b_side = second_side(mover, wall, found);
    if a_side.inverse_mass <= 0.0 {
        return nothing;
    }
    var force = vec3f(0.0);
    var pliancy = Pliancy(vec2f(0.0), vec2f(0.0));
    if LAW == LAW_THESIS {
        if CONTINUOUS & (mover < step.spheres) {
            if began_within_step(mover, state[position_at(mover)], wall, 0.0) {
                return nothing;
            }
        }
        force = contact_force(a_side, b_side, found, mover, wall).force;
        pliancy = thesis_pliancy(a_side, b_side, found, force);
    } else {
        force = law_force(a_side, b_side, found, mover, wall, spring_before(mover, wall, feature, found)).contact.force;
        pliancy = law_pliancy(a_side, b_side, found, mover, wall);
    }
    if all(force == vec3f(0.0)) {
        return nothing;
    }
    let at = servo * SERVO_ROWS;
    var way = servos[at + 1u].xyz;
    if servos[at + 3u].x != 0.0 {
        let moving = wall_of(wall);
        let place = moving.corner + lever_on_wall(moving, contact_point(mover, found.a, found.overlap, found.n));
        way = cross(way, place - servos[at + 2u].xyz);
    }
    let along = dot(way, found.n);
    let across = way - along * found.n;
    let stiff = pliancy.stiffness + pliancy.damping / step.dt;
    return vec2f(dot(force, way), dot(stiff, vec2f(along * along, dot(across, across))));
}

// Which of the entries from `begin` on, up to ENTRIES_PER_MASK, have no contact because another shape of their surface has it.
fn hidden_from(mover: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    if mover < step.spheres {
        return hidden_entries(mover, state[position_at(mover)], first, begin, count);
    }
    if RODS {
        return hidden_edges(bar_of(mover - step.spheres), first, begin, count);
    }
    return 0u;
}

// Adds the contacts of a mover with walls of servos. `statics` is the first entry that is a box or a polygon.
fn add_contacts_of(mover: u32, first: vec2u, statics: u32, count: u32) {
    let movers = step.spheres + step.rods;
    for (var begin = statics / ENTRIES_PER_MASK * ENTRIES_PER_MASK; begin < count; begin += ENTRIES_PER_MASK) {
        let hidden = hidden_from(mover, first, begin, count);
        for (var e = max(begin, statics); e < min(begin + ENTRIES_PER_MASK, count); e++) {
            let entry = entry_at(slot_at(first, e));
            let servo = servo_of(entry_id(entry));
            if (servo != NONE) & (((hidden >> (e - begin)) & 1u) == 0u) {
                contributions[servo * movers + insertion_index(mover)] += contribution(mover, entry_id(entry), entry_feature(entry), servo);
            }
        }
    }
}

@compute @workgroup_size(64)
fn servo_loads(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let mover = linear_thread(group, groups, local);
    let movers = step.spheres + step.rods;
    if (mover >= movers) | !are_loads_wanted(0u) {
        return;
    }
    for (var servo = 0u; servo < u32(servos[3].y); servo++) {
        contributions[servo * movers + insertion_index(mover)] = vec2f(0.0);
    }
    let count = count_of(mover);
    let first = first_of(mover);
    // Boxes and polygons are the last entries.
    var statics = count;
    var is_concerned = false;
    while (statics > 0u) && is_static(entry_id(entry_at(slot_at(first, statics - 1u)))) {
        statics--;
        is_concerned |= servo_of(entry_id(entry_at(slot_at(first, statics)))) != NONE;
    }
    if is_concerned {
        add_contacts_of(mover, first, statics, count);
    }
}
