// requires model/objects.wgsl model/step.wgsl physics/geometry.wgsl physics/rod_polygon.wgsl physics/round_pair.wgsl physics/laws/history.wgsl physics/pairs.wgsl

// Cohesion by Johnson, Kendall and Roberts (docs/physics section 4.13). The contact radius is u^2 times the one at which the
// contact tears. The overlap is `unit` times u^4 - 4 u.

// The attraction in a contact.
struct Bond {
    // Overlap a^2 / R* of a contact without attraction and with the same contact radius a. Without this model, the overlap.
    depth: f32,
    // Attraction per elastic force, 6 / u^3.
    pull: f32,
}

// Overlap of the unit u^4 - 4 u = 1: k^2 R*^(1/3) with k^3 = pi gamma / (4 E*). `cohesion` is -k.
fn bond_unit(cohesion: f32, radius: f32) -> f32 {
    // `pow` is less accurate than the other functions. A step of Newton's method repairs that.
    let root = pow(radius, 1.0 / 3.0);
    return cohesion * cohesion * (2.0 * root + radius / (root * root)) / 3.0;
}

// Inverts u^4 - 4 u. With x = u - 1 and q^2 = u^4 - 4 u + 3, q = x sqrt(x^2 + 4 x + 6). The start is too large by less than a
// quarter, from where Newton's method decreases to the root. Its terms are positive, so no digits cancel.
fn bond_at(cohesion: f32, radius: f32, overlap: f32) -> Bond {
    if cohesion >= 0.0 {
        return Bond(overlap, 0.0);
    }
    let unit = bond_unit(cohesion, radius);
    let q = sqrt(max(0.0, overlap / unit + 3.0));
    var x = q / (sqrt(q + 1.0) + 1.0);
    for (var k = 0; k < 3; k++) {
        let rest = sqrt((x + 4.0) * x + 6.0);
        x = 0.5 * (q * rest + (x + 2.0) * x * x) / ((x + 3.0) * x + 3.0);
    }
    let u = x + 1.0;
    let u2 = u * u;
    return Bond(u2 * u2 * unit, 6.0 / (u2 * u));
}

// 1 / r, 0 for a box or a polygon.
fn curvature_of(id: u32) -> f32 {
    if id < step.spheres {
        return 1.0 / state[position_at(id)].w;
    }
    if RODS & (id < step.spheres + step.rods) {
        return 1.0 / rod_radius(id - step.spheres);
    }
    return 0.0;
}

// Geometry of objects a and b that are apart, with a negative overlap. `found` is the result of `touch`.
fn touch_apart(a: u32, b: u32, feature: u32, found: Touch) -> Touch {
    let boxes = step.spheres + step.rods;
    if b < step.spheres {
        if joined(a, bonded_partner(a), b) {
            return no_touch();
        }
        return found;
    }
    if a < step.spheres {
        return found;
    }
    if !RODS | (b < boxes) {
        return found;
    }
    let bar = bar_of(a - step.spheres);
    let axis = bar.axis;
    if ROD_POLYGONS {
        if b >= boxes + step.boxes {
            return touch_axis(axis, polygon_from(bar.ends.x, polygon(b - boxes - step.boxes)), feature, true).touch;
        }
    }
    // A rod and the feature of a box: the nearer of edge and vertex.
    let box = box_from(bar.ends.x, cuboid(b - boxes));
    let edge = touch_rod_edge(axis, box, feature);
    if feature >= 8u {
        return edge;
    }
    let vertex = touch_rod_vertex(axis, box, feature);
    if vertex.overlap >= edge.overlap {
        return vertex;
    }
    return edge;
}

// The contact of objects that a neck connects although they are apart: a was added first, the contact has a spring, and the
// distance is less than that at which it tears, 3 units. For other objects that are apart, there is none.
fn neck(a: u32, b: u32, feature: u32, found: Touch) -> Touch {
    let cohesion = cohesion_of(a, b);
    if cohesion >= 0.0 {
        return no_touch();
    }
    let apart = touch_apart(a, b, feature, found);
    let reach = 3.0 * bond_unit(cohesion, 1.0 / (curvature_of(a) + curvature_of(b)));
    if (apart.overlap > 0.0) | (apart.overlap <= -reach) {
        return no_touch();
    }
    if spring_of(a, b, feature).overlap <= 0.0 {
        return no_touch();
    }
    return apart;
}
