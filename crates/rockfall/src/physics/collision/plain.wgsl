// requires model/entries.wgsl model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl

// Contacts of spheres without rods, with each other or with boxes and polygons: nearly all there are. Each side has one
// share of the impulse, so that the general contact of `collision.wgsl` is not needed.

struct Plain {
    // Unit normal from the sphere to the other.
    n: vec3f,
    // > 0: they touch.
    overlap: f32,
    // Approach velocity, > 0 when closing.
    approach: f32,
    // G_kk: inverse mass that the impulse meets.
    inverse_mass: f32,
}

fn is_plain(sphere: u32) -> bool {
    return end_of(sphere) == NO_ROD;
}

// Whether the contact of two objects is a plain one.
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

// The contact of a plain sphere, as that sphere sees it: the other sees the same, but for the sign of the normal.
fn plain_with(sphere: u32, own: vec4f, velocity: vec4f, other_met: Met) -> Plain {
    let other = entry_id(other_met.entry);
    var approach = velocity.xyz;
    var inverse_mass = velocity.w;
    var found = no_touch();
    if other < step.spheres {
        found = touch_two(sphere, own, other, other_met.place);
        approach -= other_met.velocity.xyz;
        inverse_mass += other_met.velocity.w;
    } else {
        let boxes = step.spheres + step.rods;
        if other < boxes + step.boxes {
            found = touch_sphere_box(own, cuboid(other - boxes));
        } else {
            found = touch_sphere_polygon(own, polygon(other - boxes - step.boxes));
        }
    }
    return Plain(found.n, found.overlap, dot(approach, found.n), inverse_mass);
}

// The same, of what nothing was read yet.
fn plain_contact(sphere: u32, other: u32) -> Plain {
    return plain_with(sphere, state[position_at(sphere)], state[velocity_at(sphere)], met(other, true));
}
