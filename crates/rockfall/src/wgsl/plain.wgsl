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
    if !RODS {
        return true;
    }
    let range = adjacency(sphere);
    if range.x == range.y {
        return true;
    }
    return kind_of(words[range.x]) != KIND_ROD;
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

// The contact of a plain sphere, as that sphere sees it.
fn plain_contact(sphere: u32, other: u32) -> Plain {
    let own = state[position_at(sphere)];
    let velocity = state[velocity_at(sphere)];
    var approach = velocity.xyz;
    var inverse_mass = velocity.w;
    var found = no_touch();
    if other < step.spheres {
        let place = state[position_at(other)];
        // Where the centres coincide the normal points up from the sphere of lower index to the other.
        let distance = place.xyz - own.xyz;
        var up = vec3f(0.0, 1.0, 0.0);
        if dot(distance, distance) <= TINY {
            up.y = select(-1.0, 1.0, ordered(sphere, other).x == sphere);
        }
        found = touch_at(distance, own.w + place.w, 0.0, 0.0, up);
        let other_velocity = state[velocity_at(other)];
        approach -= other_velocity.xyz;
        inverse_mass += other_velocity.w;
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
