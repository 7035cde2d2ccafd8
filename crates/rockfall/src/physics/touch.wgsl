// requires model/objects.wgsl model/step.wgsl physics/collision.wgsl physics/geometry.wgsl physics/rod_polygon.wgsl physics/round_pair.wgsl

// Signed geometry: the contact line of two objects at any position. The overlap is negative when they are apart
// (docs/physics section 2.10).

fn centre_of(half: ContactSide, poise: SideMotion) -> vec4f {
    let is_second = RODS & (half.kind == CAPSULE) & (half.at > 0.5);
    return vec4f(select(poise.x1, poise.x2, is_second), state[position_at(half.id)].w);
}

// The rod of a side, at the positions in `poise`, which are those seen from the first sphere of A. Its end ids are placeholders that match no sphere, and no other rod with
// another `placeholder`. Pairs that share a sphere never get here, so the contact functions need no real ids.
fn bar_at(half: ContactSide, poise: SideMotion, placeholder: u32) -> Bar {
    return Bar(vec2u(NONE - placeholder), Axis(poise.x1, poise.x2 - poise.x1, rod_radius(half.id - step.spheres)));
}

// Contact of a pair at the positions in `a_poise` and `b_poise`. The overlap is negative when they are apart, and
// NO_CONTACT_LINE when they have no contact line. `by_vertex`: a rod meets vertex `feature` of a box, not edge `feature`.
fn signed_touch(a: ContactSide, b: ContactSide, a_poise: SideMotion, b_poise: SideMotion, feature: u32, by_vertex: bool) -> Touch {
    let boxes = step.spheres + step.rods;
    if a.id < step.spheres {
        let centre = centre_of(a, a_poise);
        if b.id < step.spheres {
            return touch_spheres(centre, centre_of(b, b_poise));
        }
        if RODS & (b.id < boxes) {
            return touch_sphere_rod(0u, centre, bar_at(b, b_poise, 1u));
        }
        if b.id < boxes + step.boxes {
            return touch_sphere_box(centre, box_from(origin_of(a), cuboid(b.id - boxes)));
        }
        return touch_sphere_polygon(centre, polygon_from(origin_of(a), polygon(b.id - boxes - step.boxes)));
    }
    if !RODS {
        return no_touch();
    }
    let bar = bar_at(a, a_poise, 1u);
    if b.id < boxes {
        return touch_rods(bar, bar_at(b, b_poise, 2u));
    }
    if ROD_POLYGONS {
        if b.id >= boxes + step.boxes {
            return touch_axis(bar.axis, polygon_from(origin_of(a), polygon(b.id - boxes - step.boxes)), feature, true).touch;
        }
    }
    if by_vertex {
        return touch_rod_vertex(bar.axis, box_from(origin_of(a), cuboid(b.id - boxes)), feature);
    }
    return touch_rod_edge(bar.axis, box_from(origin_of(a), cuboid(b.id - boxes)), feature);
}

// Whether a contact is that of a sphere with the face of a box or polygon, which it keeps at other positions (docs/physics section
// 2.10). The centre is neither beside the face nor inside the box.
fn is_over_face(a: ContactSide, b: ContactSide, poise: SideMotion) -> bool {
    let boxes = step.spheres + step.rods;
    if (a.id >= step.spheres) | (b.id < boxes) {
        return false;
    }
    let centre = centre_of(a, poise).xyz;
    if b.id < boxes + step.boxes {
        return is_over_box(centre, box_from(origin_of(a), cuboid(b.id - boxes)));
    }
    return is_over_polygon(centre, polygon_from(origin_of(a), polygon(b.id - boxes - step.boxes)));
}

// Whether a rod meets vertex `feature` of a box instead of edge `feature`. If it does not overlap the edge, the nearer of the
// two counts (docs/physics section 2.10).
fn meets_by_vertex(a: ContactSide, b: ContactSide, poise: SideMotion, feature: u32) -> bool {
    let boxes = step.spheres + step.rods;
    if !RODS | (a.id < step.spheres) | (b.id < boxes) | (feature >= 8u) {
        return false;
    }
    if ROD_POLYGONS {
        if b.id >= boxes + step.boxes {
            return false;
        }
    }
    let bar = bar_at(a, poise, 1u);
    let edge = touch_rod_edge(bar.axis, box_from(origin_of(a), cuboid(b.id - boxes)), feature);
    if edge.overlap > 0.0 {
        return false;
    }
    let vertex = touch_rod_vertex(bar.axis, box_from(origin_of(a), cuboid(b.id - boxes)), feature);
    return vertex.overlap >= edge.overlap;
}
