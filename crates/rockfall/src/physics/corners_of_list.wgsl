// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl
// requires physics/rigid_box.wgsl physics/round_pair.wgsl physics/surface.wgsl

// Which corners of boxes and polygons in the list of a solid do not count, because another wall is in front of them, or has a corner at the
// same place (docs/physics.md section 2.16).

// Overlaps up to this part of the rounding radius are rounding errors.
const CORNER_SLACK: f32 = 1e-3;

// The overlap of a sphere with a wall. `place` is its centre, seen from sphere i.
fn overlap_near(i: u32, wall: u32, place: vec3f, radius: f32) -> f32 {
    let boxes = step.spheres + step.rods;
    var centre = place;
    if !DOUBLE {
        centre += near_shape(wall, state[position_at(i)].xyz);
    }
    if wall < boxes + step.boxes {
        return touch_sphere_box(vec4f(centre, radius), box_from(i, cuboid(wall - boxes))).overlap;
    }
    return touch_sphere_polygon(vec4f(centre, radius), polygon_from(i, polygon(wall - boxes - step.boxes))).overlap;
}

// The vector from the middle of a box or polygon to a corner.
fn outward_of_corner(wall: u32, corner: u32) -> vec3f {
    let boxes = step.spheres + step.rods;
    let far = vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32((corner >> 2u) & 1u));
    if wall < boxes + step.boxes {
        let box = cuboid(wall - boxes);
        return (far.x - 0.5) * box.i + (far.y - 0.5) * box.j + (far.z - 0.5) * box.k;
    }
    let face = polygon(wall - boxes - step.boxes);
    let middle = select(0.5, 1.0 / 3.0, is_triangle(face));
    return (far.x - middle) * face.left + (far.y - middle) * face.right;
}

// Whether the corner of an entry does not count. `found` is its contact.
fn is_corner_hidden(i: u32, entry: u32, found: Touch, radius: f32, first: vec2u, count: u32) -> bool {
    let wall = entry_id(entry);
    let place = corner_seen(i, wall, entry_feature(entry)) - radius * found.n;
    let outward = outward_of_corner(wall, entry_feature(entry));
    let along = outward - dot(outward, found.n) * found.n;
    let squared = dot(along, along);
    let beside = place + select(vec3f(0.0), radius * inverseSqrt(squared) * along, squared > TINY);
    let slack = CORNER_SLACK * radius;
    var is_before = true;
    for (var e = 0u; e < count; e++) {
        let other = entry_at(slot_at(first, e));
        let id = entry_id(other);
        if !is_static(id) | (entry_feature(other) != 0u) {
            continue;
        }
        let overlap = overlap_near(i, id, place, radius);
        if id == wall {
            is_before = false;
            if abs(overlap) > slack {
                return true;
            }
        } else if (overlap > slack) | (is_before & (overlap >= -slack)) {
            return true;
        } else if overlap_near(i, id, beside, radius) >= -slack {
            return true;
        }
    }
    return false;
}

// Which of the entries from `begin` on, up to ENTRIES_PER_MASK, do not count: a bit each. Those without an overlap are left out.
fn hidden_corners(i: u32, word: u32, first: vec2u, begin: u32, count: u32) -> u32 {
    var hidden = 0u;
    for (var e = begin; e < min(begin + ENTRIES_PER_MASK, count); e++) {
        let entry = entry_at(slot_at(first, e));
        if !is_static(entry_id(entry)) {
            continue;
        }
        let found = touch_corner(i, entry_id(entry), word, entry_feature(entry));
        if found.overlap > 0.0 {
            if is_corner_hidden(i, entry, found, float_at(word + 3u), first, count) {
                hidden |= 1u << (e - begin);
            }
        }
    }
    return hidden;
}
