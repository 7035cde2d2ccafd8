// requires model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/forces/attached.wgsl physics/forces/muscle.wgsl

// What a unit impulse of a lone collision does to springs and tethers (docs/physics section 3.6).

// The spheres that a unit impulse of a collision moves, and their changes of velocity. Each side has two places.
struct Pushed {
    spheres: vec4u,
    velocities: array<vec3f, 4>,
}

fn push_side(half: ContactSide, poise: SideMotion, n: vec3f, place: u32, pushed: ptr<function, Pushed>) {
    if half.kind == STATIC {
        return;
    }
    (*pushed).spheres[place] = half.spheres.x;
    (*pushed).velocities[place] = inverse_mass(half.spheres.x) * n;
    if !RODS | (half.kind == SPHERE) {
        return;
    }
    (*pushed).spheres[place + 1u] = half.spheres.y;
    if half.kind == ROD {
        (*pushed).velocities[place] = (1.0 - half.at) * inverse_mass(half.spheres.x) * n;
        (*pushed).velocities[place + 1u] = half.at * inverse_mass(half.spheres.y) * n;
        return;
    }
    let capsule = capsule_of(half.spheres, poise);
    let spin = capsule.inverse_inertia * torque_at(capsule, half.at, n);
    (*pushed).velocities[place] = capsule.inverse_mass * n - cross(spin, capsule.centre * capsule.d);
    (*pushed).velocities[place + 1u] = capsule.inverse_mass * n + cross(spin, (1.0 - capsule.centre) * capsule.d);
}

// K of docs/physics section 3.6: the second derivative of the energy of springs and tethers, when every sphere is
// displaced along its change of velocity by a unit impulse. A spring between two of these spheres is visited from both, so
// each visit counts half. The term with K takes the energy that the displacements add to the springs from the rebound,
// so that the collision adds no energy.
fn curvature_along(pushed: Pushed) -> f32 {
    var sum = 0.0;
    for (var place = 0u; place < 4u; place++) {
        let sphere = pushed.spheres[place];
        if sphere == NONE {
            continue;
        }
        let own = pushed_velocity(pushed, sphere).velocity;
        let range = adjacency(sphere);
        for (var at = range.x; at < range.y; at++) {
            let kind = kind_of(topology[at]);
            let index = index_of(topology[at]);
            if kind == KIND_SPRING {
                let spring = step.springs_at + index * SPRING_WORDS;
                let other = select(topology[spring], topology[spring + 1u], topology[spring] == sphere);
                let theirs = pushed_velocity(pushed, other);
                let stretch = theirs.velocity - own;
                let part = select(1.0, 0.5, theirs.is_pushed);
                let distance = state[position_at(other)].xyz - state[position_at(sphere)].xyz;
                let length = rest_length(index, float_at(spring + 3u));
                sum += part * spring_curvature(distance, stretch, float_at(spring + 2u), length);
            } else if kind == KIND_TETHER {
                let tether = step.tethers_at + index * TETHER_WORDS;
                let distance = vector_at(tether + 1u) - state[position_at(sphere)].xyz;
                sum += spring_curvature(distance, own, float_at(tether + 4u), float_at(tether + 5u));
            }
        }
    }
    return sum;
}

// The change of the velocity of a sphere by the unit impulse, and whether it has one.
struct PushedVelocity {
    velocity: vec3f,
    is_pushed: bool,
}

fn pushed_velocity(pushed: Pushed, sphere: u32) -> PushedVelocity {
    var found = PushedVelocity(vec3f(0.0), false);
    for (var place = 0u; place < 4u; place++) {
        if pushed.spheres[place] == sphere {
            found = PushedVelocity(found.velocity + pushed.velocities[place], true);
        }
    }
    return found;
}
