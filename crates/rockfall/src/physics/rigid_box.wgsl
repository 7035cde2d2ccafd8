// requires model/objects.wgsl model/step.wgsl physics/fine.wgsl physics/geometry.wgsl physics/rod_polygon.wgsl physics/round_pair.wgsl physics/period.wgsl
// requires physics/quaternion.wgsl physics/rigid.wgsl physics/rigid_parts.wgsl

// Contacts of boxes of rigid bodies (docs/physics.md section 2.16).

// Length over which an edge gives way to the vertices at its ends, in rounding radii.
const TAPER: f32 = 4.0;
// Sine of the angle below which parallel edges give way to the vertices.
const PARALLEL: f32 = 0.1;

struct BodyBox {
    centre: vec3f,
    // Rounding radius.
    radius: f32,
    // Half the edges of the core.
    half: vec3f,
    // Turns coordinates along the edges into those of the scene.
    turn: vec4f,
}

// The box that an object is a part of.
fn box_of_part(id: u32, word: u32) -> BodyBox {
    return box_in(rigid_record(rigid_body_of(id)), word);
}

// The box with this word of the body with this record.
fn box_in(record: u32, word: u32) -> BodyBox {
    let orientation = vec4f(vector_at(record + 14u), float_at(record + 17u));
    let at = word & ~BOX_RIM;
    return BodyBox(
        vector_at(record) + turned_vector(orientation, vector_at(at)),
        float_at(at + 3u),
        vector_at(at + 4u),
        multiply(orientation, vec4f(vector_at(at + 7u), float_at(at + 10u))),
    );
}

// The unit vector from the core of a box to a place, which is relative to its centre, and the distance: negative inside.
fn from_core(box: BodyBox, place: vec3f) -> vec4f {
    let seen = turned_vector(vec4f(-box.turn.xyz, box.turn.w), place);
    let gap = seen - clamp(seen, -box.half, box.half);
    let squared = dot(gap, gap);
    if squared > TINY {
        let distance = sqrt(squared);
        return vec4f(turned_vector(box.turn, gap / distance), distance);
    }
    let depth = box.half - abs(seen);
    var least = depth.x;
    var outward = vec3f(select(1.0, -1.0, seen.x < 0.0), 0.0, 0.0);
    if depth.y < least {
        least = depth.y;
        outward = vec3f(0.0, select(1.0, -1.0, seen.y < 0.0), 0.0);
    }
    if depth.z < least {
        least = depth.z;
        outward = vec3f(0.0, 0.0, select(1.0, -1.0, seen.z < 0.0));
    }
    return vec4f(turned_vector(box.turn, outward), -least);
}

// The contact of two spheres of which one stands for a solid. The normal points from a to b.
fn touch_solid(a: u32, b: u32, one: u32, other: u32) -> Touch {
    let is_a = is_solid(one);
    let solid = select(b, a, is_a);
    let ball = select(a, b, is_a);
    let box = box_of_part(solid, select(other, one, is_a));
    let nearest = from_core(box, between(solid, ball));
    let overlap = state[position_at(ball)].w + box.radius - nearest.w;
    return Touch(select(-nearest.xyz, nearest.xyz, is_a), overlap, 0.0, 0.0);
}

// A corner of a box or polygon, seen from the centre of a sphere.
fn corner_seen(sphere: u32, wall: u32, corner: u32) -> vec3f {
    let boxes = step.spheres + step.rods;
    let far = vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32((corner >> 2u) & 1u));
    var place = vec3f(0.0);
    if !DOUBLE {
        place = near_shape(wall, state[position_at(sphere)].xyz);
    }
    if wall < boxes + step.boxes {
        let box = box_from(sphere, cuboid(wall - boxes));
        return box.corner - place + far.x * box.i + far.y * box.j + far.z * box.k;
    }
    let face = polygon_from(sphere, polygon(wall - boxes - step.boxes));
    return face.corner - place + far.x * face.left + far.y * face.right;
}

// The contact of a solid with a corner of a box or polygon. The parameter on the wall is the number of the corner.
fn touch_corner(solid: u32, wall: u32, word: u32, corner: u32) -> Touch {
    let box = box_of_part(solid, word);
    let nearest = from_core(box, corner_seen(solid, wall, corner));
    return Touch(nearest.xyz, box.radius - nearest.w, 0.0, f32(corner));
}

// The vector from the centre of a solid to that of the sphere, or to the corner `at` of the wall, that touches it: a point of the line on
// which the normal force acts.
fn toucher(solid: u32, other: u32, at: f32) -> vec3f {
    if other < step.spheres {
        return between(solid, other);
    }
    return corner_seen(solid, other, u32(at));
}

// Where a solid is touched: the vector from its centre to the point of its core. `other` is a sphere or a wall.
fn core_point(solid: u32, other: u32, word: u32, found: Touch) -> vec3f {
    var reach = float_at(word + 3u) - found.overlap;
    if other < step.spheres {
        reach += state[position_at(other)].w;
    }
    let place = toucher(solid, other, found.b);
    let outward = select(found.n, -found.n, dot(found.n, place) < 0.0);
    return place - reach * outward;
}

// Whether an edge of a box touches a wall at a vertex of the wall. The corner and the solid stand for that contact.
fn meets_vertex(edge: u32, wall: u32, feature: u32) -> bool {
    let boxes = step.spheres + step.rods;
    let bar = bar_of(edge - step.spheres);
    if wall < boxes + step.boxes {
        if feature >= 8u {
            return false;
        }
        return !(touch_rod_edge(bar.axis, box_from(bar.ends.x, cuboid(wall - boxes)), feature).overlap > 0.0);
    }
    if ROD_POLYGONS {
        return touch_axis(bar.axis, polygon_from(bar.ends.x, polygon(wall - boxes - step.boxes)), feature, false).is_vertex;
    }
    return false;
}

// How much of an edge or another rod is left near its ends, at a parameter.
fn share_of_rod(rod: u32, at: f32) -> f32 {
    let ends = rod_ends(rod);
    return clamp(min(at, 1.0 - at) * length(between(ends.x, ends.y)) / (TAPER * rod_radius(rod)), 0.0, 1.0);
}

// The part along n of the vector from the centre of the box to the middle of an edge.
fn outward_along(id: u32, word: u32, n: vec3f) -> f32 {
    let ends = rod_ends(id - step.spheres);
    let middle = state[position_at(ends.x)].xyz + 0.5 * between(ends.x, ends.y);
    return dot(nearest_image(middle - box_of_part(id, word).centre), n);
}

// The contact of two rods of which at least one is an edge.
fn touch_edges(a: u32, b: u32, one: u32, other: u32, found: Touch) -> Touch {
    let rod_a = a - step.spheres;
    let rod_b = b - step.spheres;
    let along_a = rod_ends(rod_a);
    let along_b = rod_ends(rod_b);
    let axis_a = between(along_a.x, along_a.y);
    let axis_b = between(along_b.x, along_b.y);
    let crossed = cross(axis_a, axis_b);
    let sine = sqrt(dot(crossed, crossed) / (dot(axis_a, axis_a) * dot(axis_b, axis_b)));
    let share = min(1.0, sine / PARALLEL) * min(share_of_rod(rod_a, found.a), share_of_rod(rod_b, found.b));
    let reach = rod_radius(rod_a) + rod_radius(rod_b);
    let distance = reach - found.overlap;
    var leaves = 0.0;
    var enters = 0.0;
    if one != 0u {
        leaves = outward_along(a, one, found.n);
    }
    if other != 0u {
        enters = outward_along(b, other, found.n);
    }
    if ((one == 0u) | (leaves < 0.0)) & ((other == 0u) | (enters > 0.0)) {
        return Touch(-found.n, share * (reach + distance), found.a, found.b);
    }
    if (leaves < 0.0) | (enters > 0.0) {
        return no_touch();
    }
    return Touch(found.n, share * found.overlap, found.a, found.b);
}

// The contact of two objects of which at least one is a part of a box. `found` is that of the sphere or rod that stands for it.
fn touch_parts(a: u32, b: u32, one: u32, other: u32, found: Touch, feature: u32) -> Touch {
    if b >= step.spheres + step.rods {
        if is_solid(one) {
            return touch_corner(a, b, one, feature);
        }
        if RODS & (a >= step.spheres) & (found.overlap > 0.0) {
            if meets_vertex(a, b, feature) {
                return no_touch();
            }
        }
        return found;
    }
    if is_solid(one) | is_solid(other) {
        return touch_solid(a, b, one, other);
    }
    if RODS & (a >= step.spheres) & (b - step.spheres < step.rods) & (found.overlap > 0.0) {
        return touch_edges(a, b, one, other, found);
    }
    return found;
}
