// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl physics/rims_of_list.wgsl physics/round_pair.wgsl
// requires physics/surface.wgsl physics/surfaces_of_list.wgsl physics/walls.wgsl

// The edges and vertices of boxes in the list of a rod at which another box continues a face (docs/physics section 2.11).

// Distance, as a part of the radius of the rod, at which another box is looked for beside an edge.
const BESIDE: f32 = 1e-3;

// Whether another box of the list contains a point beside `place` and outside of box `id`. `steps` has a step outwards per axis of the
// box. `axes` has a bit for each axis with a step: all of them at a vertex, and two at an edge.
fn is_continued(origin: u32, id: u32, place: vec3f, steps: Cuboid, axes: u32, first: vec2u, count: u32) -> bool {
    for (var e = 0u; e < count; e++) {
        let entry = entry_at(slot_at(first, e));
        let other = entry_id(entry);
        if !is_box(other) | (other == id) | (entry_feature(entry) != 0u) {
            continue;
        }
        if WALLS {
            if body_of(other) != body_of(id) {
                continue;
            }
        }
        let box = box_from(origin, cuboid(other - step.spheres - step.rods));
        for (var signs = 1u; signs < 8u; signs++) {
            if (signs & axes) == 0u {
                continue;
            }
            let ways = select(vec3f(-1.0), vec3f(1.0), (vec3u(signs) & vec3u(1u, 2u, 4u)) != vec3u(0u));
            let point = place + ways.x * steps.i + ways.y * steps.j + ways.z * steps.k;
            if in_unit_cube(box_parameters(point, box)) {
                return true;
            }
        }
    }
    return false;
}

// Whether the edge or vertex that a rod touches is no edge of the surface. `found` is the contact with feature `feature` of box `id`.
fn is_seam(own: Bar, id: u32, feature: u32, found: Touch, first: vec2u, count: u32) -> bool {
    let box = box_from(own.ends.x, cuboid(id - step.spheres - step.rods));
    let place = own.axis.start + found.a * own.axis.along + (own.axis.radius - found.overlap) * found.n;
    let by_edge = (feature >= 8u) || (touch_rod_edge(own.axis, box, feature).overlap > 0.0);
    let along = select(3u, feature / 4u, by_edge);
    let outward = select(vec3f(1.0), vec3f(-1.0), box_parameters(place, box) < vec3f(0.5));
    let size = select(vec3f(BESIDE * own.axis.radius), vec3f(0.0), vec3u(0u, 1u, 2u) == vec3u(along)) * outward;
    let steps = Cuboid(vec3f(0.0), size.x * normalize(box.i), size.y * normalize(box.j), size.z * normalize(box.k));
    return is_continued(own.ends.x, id, place, steps, 7u & ~(1u << along), first, count);
}

// Which of the entries of a rod from `begin` on, up to ENTRIES_PER_MASK, are hidden: a bit each.
fn hidden_edges(own: Bar, first: vec2u, begin: u32, count: u32) -> u32 {
    if ROD_POLYGONS {
        return hidden_rims(own, first, begin, count) | hidden_box_edges(own, first, begin, count);
    }
    return hidden_box_edges(own, first, begin, count);
}

fn is_box(id: u32) -> bool {
    return is_static(id) & (id - step.spheres - step.rods < step.boxes);
}

fn hidden_box_edges(own: Bar, first: vec2u, begin: u32, count: u32) -> u32 {
    // Boxes and polygons are the last entries. Boxes have BOX_FEATURES entries each.
    if count < 2u * BOX_FEATURES {
        return 0u;
    }
    if !is_static_entry(first, count - 1u - BOX_FEATURES) {
        return 0u;
    }
    var hidden = 0u;
    for (var e = begin; e < min(begin + ENTRIES_PER_MASK, count); e++) {
        let entry = entry_at(slot_at(first, e));
        let id = entry_id(entry);
        if !is_box(id) {
            continue;
        }
        let found = touch_rod_box(own.axis, box_from(own.ends.x, cuboid(id - step.spheres - step.rods)), entry_feature(entry));
        if found.overlap > 0.0 {
            hidden |= u32(is_seam(own, id, entry_feature(entry), found, first, count)) << (e - begin);
        }
    }
    return hidden;
}
