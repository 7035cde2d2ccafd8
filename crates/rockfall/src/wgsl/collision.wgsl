// Collisions as unit impulses with shares (physics.md section 3). A contact's unit impulse is -n on A's side, +n on B's.

// Up to four spheres take part in a contact: slots 0 and 1 for A, 2 and 3 for B; NONE and 0 where there is no sphere.
struct Contact {
    spheres: array<u32, 4>,
    shares: array<vec3f, 4>,
    inverse_masses: array<f32, 4>,
    overlap: f32,
    // Approach velocity, > 0 when closing, of what the impulse acts on.
    approach: f32,
    // G_kk: inverse mass that the impulse meets.
    inverse_mass: f32,
}

// The impulse `g` on a sphere goes to its slots. The end of a capsule shares the part along the axis by mass with the
// other end.
fn share_sphere(k: ptr<function, Contact>, slot: u32, sphere: u32, g: vec3f) {
    (*k).spheres[slot] = sphere;
    (*k).shares[slot] = g;
    let partner = capsule_partner(sphere);
    if partner == NONE {
        return;
    }
    let along = state[position_at(partner)].xyz - state[position_at(sphere)].xyz;
    let squared = dot(along, along);
    if squared <= TINY {
        return;
    }
    let axis = along / sqrt(squared);
    let axial = dot(g, axis) * axis;
    let own = inverse_mass(sphere);
    let other = inverse_mass(partner);
    var fraction = 1.0;
    if own > 0.0 {
        fraction = other / (own + other);
    }
    (*k).shares[slot] = (g - axial) + fraction * axial;
    (*k).spheres[slot + 1u] = partner;
    (*k).shares[slot + 1u] = (1.0 - fraction) * axial;
}

fn share_side(k: ptr<function, Contact>, slot: u32, id: u32, at: f32, g: vec3f) {
    if id < step.spheres {
        share_sphere(k, slot, id, g);
    } else if id - step.spheres < step.rods {
        let ends = rod_ends(id - step.spheres);
        (*k).spheres[slot] = ends.x;
        (*k).shares[slot] = (1.0 - at) * g;
        (*k).spheres[slot + 1u] = ends.y;
        (*k).shares[slot + 1u] = at * g;
    }
}

// Sum over the spheres that two contacts share of w g_k.g_l. A sphere may stand in two slots: its shares add up.
fn coupling(k: ptr<function, Contact>, l: ptr<function, Contact>) -> f32 {
    var sum = 0.0;
    for (var s = 0u; s < 4u; s++) {
        if (*k).spheres[s] == NONE {
            continue;
        }
        for (var t = 0u; t < 4u; t++) {
            if (*k).spheres[s] == (*l).spheres[t] {
                sum += (*k).inverse_masses[s] * dot((*k).shares[s], (*l).shares[t]);
            }
        }
    }
    return sum;
}

// The contact of two objects, a < b, that touch as told.
fn contact_of(a: u32, b: u32, found: Touch) -> Contact {
    var k: Contact;
    for (var s = 0u; s < 4u; s++) {
        k.spheres[s] = NONE;
        k.shares[s] = vec3f(0.0);
        k.inverse_masses[s] = 0.0;
    }
    share_side(&k, 0u, a, found.a, -found.n);
    share_side(&k, 2u, b, found.b, found.n);
    k.overlap = found.overlap;
    k.approach = 0.0;
    for (var s = 0u; s < 4u; s++) {
        if k.spheres[s] != NONE {
            let velocity = state[velocity_at(k.spheres[s])];
            k.inverse_masses[s] = velocity.w;
            k.approach -= dot(k.shares[s], velocity.xyz);
        }
    }
    var same = k;
    k.inverse_mass = coupling(&k, &same);
    return k;
}

fn takes_part(k: ptr<function, Contact>, sphere: u32) -> bool {
    return ((*k).spheres[0] == sphere) | ((*k).spheres[1] == sphere) | ((*k).spheres[2] == sphere)
        | ((*k).spheres[3] == sphere);
}

// Share of a sphere in a contact's unit impulse.
fn share_of(k: ptr<function, Contact>, sphere: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var s = 0u; s < 4u; s++) {
        if (*k).spheres[s] == sphere {
            sum += (*k).shares[s];
        }
    }
    return sum;
}
