// requires model/entries.wgsl model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl
// requires physics/round_pair.wgsl physics/walls.wgsl

// Contacts of spheres without rods, with each other or with boxes and polygons ("plain" contacts). Nearly all contacts are of
// this kind. Each side gets the whole impulse, so the general contact of `collision.wgsl` is not needed.

struct Plain {
    // Unit normal from the sphere to the other object.
    n: vec3f,
    // Positive when the objects overlap.
    overlap: f32,
    // Approach velocity, positive when the objects approach each other.
    approach: f32,
    // G_kk: inverse mass of the contact, summed over both sides.
    inverse_mass: f32,
}

fn is_plain(sphere: u32) -> bool {
    return end_of(sphere) == NO_ROD;
}

// Whether the contact of two objects is plain.
fn are_plain(a: u32, b: u32) -> bool {
    if !RODS {
        return true;
    }
    if (a >= step.spheres) | ((b >= step.spheres) & (b - step.spheres < step.rods)) {
        return false;
    }
    if b < step.spheres {
        if !is_plain(b) {
            return false;
        }
    }
    return is_plain(a);
}

// The plain contact of a sphere without rods, seen from that sphere. Seen from the other object it is the same with the
// opposite normal.
fn plain_with(sphere: u32, own: vec4f, velocity: vec4f, other_met: LoadedEntry) -> Plain {
    let other = entry_id(other_met.entry);
    var approach = velocity.xyz;
    var inverse_mass = velocity.w;
    var found = no_touch();
    if other < step.spheres {
        found = touch_two(sphere, own, other, other_met.place);
        approach -= other_met.velocity.xyz;
        inverse_mass += other_met.velocity.w;
    } else {
        found = touch_static(sphere, other, own);
        if WALLS {
            approach -= velocity_of_wall(wall_of(other), own.xyz + (own.w - found.overlap) * found.n);
        }
    }
    return Plain(found.n, found.overlap, dot(approach, found.n), inverse_mass);
}

// The same contact, for a pair whose rows have not been read yet.
fn plain_contact(sphere: u32, other: u32) -> Plain {
    return plain_with(sphere, state[position_at(sphere)], state[velocity_at(sphere)], load_entry(other, true));
}
