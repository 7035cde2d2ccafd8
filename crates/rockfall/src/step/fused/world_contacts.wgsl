// requires physics/forces/sphere_push.wgsl model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/forces/net_force.wgsl physics/geometry.wgsl
// requires physics/surface.wgsl
// requires step/fused/world_memory.wgsl

// Contacts of the spheres of a world in `run_worlds`. There are no pair lists: each thread keeps the objects near its sphere as bits.

// Two spheres of a world may be in the same group. The host replaces it. Without, there is no code for pairs of spheres.
const SPHERE_PAIRS: bool = true;
// Objects of the same group that the sphere of this thread may touch at all: a bit per id.
var<private> mates: vec2u;
// Those that it may touch as long as no sphere leaves the ball around its reference position.
var<private> near: vec2u;
// Position at which `near` was found, and the squared radius of the ball.
var<private> reference: vec4f;

// Worlds in one dispatch do not handle contacts within a step.
fn is_hidden_crossing(i: u32, id: u32, time: f32) -> bool {
    return false;
}

// The bit of an object.
fn bit_of(id: u32) -> vec2u {
    let bit = 1u << (id & 31u);
    return select(vec2u(0u, bit), vec2u(bit, 0u), id < 32u);
}

// Takes the lowest bit out of a mask, and returns its number.
fn take_lowest(mask: ptr<function, vec2u>) -> u32 {
    if (*mask).x != 0u {
        let id = firstTrailingBit((*mask).x);
        (*mask).x &= (*mask).x - 1u;
        return id;
    }
    let id = firstTrailingBit((*mask).y);
    (*mask).y &= (*mask).y - 1u;
    return 32u + id;
}

// The bits of all spheres. The other bits of the first word are those of static objects.
fn sphere_bits() -> u32 {
    return select((1u << (step.spheres & 31u)) - 1u, ~0u, step.spheres >= 32u);
}

fn mates_of(i: u32) -> vec2u {
    let group = topology[step.tags_at + i] & GROUP_MASK;
    var found = vec2u(0u);
    for (var id = select(step.spheres, 0u, SPHERE_PAIRS); id < objects(); id++) {
        if (id != i) & ((topology[step.tags_at + id] & GROUP_MASK) == group) {
            found |= bit_of(id);
        }
    }
    return found;
}

// Radius of the ball in which a sphere may move before the near objects are found again: some room, and the way of a few steps.
fn margin_of(radius: f32, velocity: vec3f) -> f32 {
    return 0.1 * radius + 4.0 * step.dt * length(velocity);
}

// Upper bound of the rounding errors of the distance from a static object, in units. `size` is the sum of all lengths in it.
fn rounding(own: vec3f, size: vec3f) -> f32 {
    let all = abs(own) + size;
    return 1e-6 * (all.x + all.y + all.z);
}

// Whether a static object may be within `reach` of a point.
fn is_static_near(own: vec3f, reach: f32, number: u32) -> bool {
    if number < step.boxes {
        let box = cuboid(number);
        let size = abs(box.corner) + abs(box.i) + abs(box.j) + abs(box.k);
        return !(touch_sphere_box(vec4f(own, reach + rounding(own, size)), box).overlap <= 0.0);
    }
    let face = polygon(number - step.boxes);
    let distance = dot(own - face.corner, face_of(face).n);
    return !(abs(distance) > reach + rounding(own, abs(face.corner) + abs(face.left) + abs(face.right)));
}

// Whether another sphere may touch a sphere before one of the two leaves its ball. Comparisons with values that are not finite
// count as near.
fn is_sphere_near(own: vec4f, margin: f32, id: u32) -> bool {
    let other = state[position_at(id)];
    let between = other.xyz - own.xyz;
    let reach = own.w + other.w + margin + margin_of(other.w, state[velocity_at(id)].xyz);
    return !(dot(between, between) > reach * reach);
}

// Finds the objects of the same group that a sphere may touch, at the present positions. Each thread goes through its own bits, so
// that threads with different objects test them at the same time.
fn find_near(i: u32) {
    let own = state[position_at(i)];
    let margin = margin_of(own.w, state[velocity_at(i)].xyz);
    var found = vec2u(0u);
    if SPHERE_PAIRS {
        for (var spheres = mates.x & sphere_bits(); spheres != 0u; spheres &= spheres - 1u) {
            let id = firstTrailingBit(spheres);
            found.x |= select(0u, 1u << id, is_sphere_near(own, margin, id));
        }
    }
    var statics = vec2u(mates.x & ~sphere_bits(), mates.y);
    while any(statics != vec2u(0u)) {
        let id = take_lowest(&statics);
        found |= select(vec2u(0u), bit_of(id), is_static_near(own.xyz, own.w + margin, id - step.spheres));
    }
    near = found;
    // A little less than the square of the margin, because of rounding errors.
    reference = vec4f(own.xyz, 0.98 * margin * margin);
}

// Requests that near objects are found again in the next force evaluation if the sphere has left its ball.
fn check_reference(i: u32, evaluations: u32) {
    let way = state[position_at(i)].xyz - reference.xyz;
    if !(dot(way, way) <= reference.w) {
        atomicStore(&moved[own_world], evaluations + 1u);
    }
}

// Those of some spheres that are close to a sphere. The test is that of `close`.
fn close_spheres(own: vec4f, spheres: u32) -> u32 {
    var found = spheres;
    for (var rest = spheres; rest != 0u; rest &= rest - 1u) {
        let id = firstTrailingBit(rest);
        let place = state[position_at(id)];
        let between = place.xyz - own.xyz;
        let reach = own.w + place.w;
        if !(dot(between, between) < SLACK * reach * reach) {
            found &= ~(1u << id);
        }
    }
    return found;
}

fn near_statics() -> vec2u {
    return vec2u(near.x & ~sphere_bits(), near.y);
}

// The near static objects that are not hidden.
fn visible_statics(i: u32, own: vec4f) -> vec2u {
    var visible = near_statics();
    if countOneBits(visible.x) + countOneBits(visible.y) < 2u {
        return visible;
    }
    var chosen: Surfaces;
    while chosen.count < MOST_SURFACES {
        var best = no_candidate();
        var statics = near_statics();
        while any(statics != vec2u(0u)) {
            best = nearer_candidate(best, i, own, take_lowest(&statics), &chosen);
        }
        if best.overlaps < 2u {
            return visible;
        }
        if best.id == NONE {
            break;
        }
        choose_surface(best, &chosen);
    }
    var statics = near_statics();
    while any(statics != vec2u(0u)) {
        let id = take_lowest(&statics);
        if is_hidden(i, own, id, &chosen) {
            visible &= ~bit_of(id);
        }
    }
    return visible;
}

fn add_near_contact(i: u32, own: vec4f, side: Side, other: LoadedEntry, net: ptr<function, Net>) {
    let push = push_of(i, NO_ROD, own, side, other);
    (*net).force += push.force;
    (*net).torque = fma(push.torque_per_arm, vec3f(push.arm), (*net).torque);
    count_push(i, other.entry, push, net);
}

fn add_sphere_contacts(i: u32, own: vec4f, side: Side, candidates: u32, net: ptr<function, Net>) {
    var spheres = close_spheres(own, candidates);
    while spheres != 0u {
        add_near_contact(i, own, side, load_entry(firstTrailingBit(spheres), true), net);
        spheres &= spheres - 1u;
    }
}

// Adds the forces of contacts in ascending order of ids, as `add_contacts` does. First come spheres, then static objects, so that
// the threads of a subgroup have objects of the same kind at the same time.
fn add_near_contacts(i: u32, net: ptr<function, Net>) {
    let own = state[position_at(i)];
    let side = sphere_side(own, state[velocity_at(i)], state[momentum_at(i)]);
    if SPHERE_PAIRS {
        add_sphere_contacts(i, own, side, near.x & sphere_bits(), net);
    }
    var statics = visible_statics(i, own);
    while any(statics != vec2u(0u)) {
        // The rows of a static object are not used.
        let other = LoadedEntry(take_lowest(&statics), vec4f(0.0), vec4f(0.0), vec4f(0.0));
        add_near_contact(i, own, side, other, net);
    }
}
