// requires model/objects.wgsl model/step.wgsl physics/geometry.wgsl physics/round_pair.wgsl physics/smooth.wgsl physics/walls.wgsl

// Which of the boxes and polygons that a sphere overlaps touch it (docs/physics section 2.11). In each round, the nearest candidate
// that none of the chosen ones hides is chosen.

// A candidate counts as hidden if its nearest point is less than this times the radius in front of a tangent plane.
const SURFACE_SLACK: f32 = 1e-5;
// Part of the distance by which an edge comes later than a face.
const EDGE_SLACK: f32 = 2e-6;
// The cosine of 0.01 rad. Normals that differ by less are one. Those of two triangles may differ by more.
const ONE_NORMAL: f32 = 0.99995;
// Room for chosen candidates. Those that do not fit count, but hide no others.
const MOST_SURFACES: u32 = 16u;

// A box or polygon that a sphere overlaps.
struct Candidate {
    // NONE if there is none.
    id: u32,
    // Distance of the nearest point from the centre; negative if the centre is inside a box.
    distance: f32,
    // From the centre to the nearest point, if the distance is positive.
    n: vec3f,
    // Number of overlaps among the objects that it was chosen from.
    overlaps: u32,
    // The distance by which candidates are ordered.
    order: f32,
}

// The chosen candidates of a sphere. A variable of a function: those of a module would be set to zero in every thread.
struct Surfaces {
    // Unit normals and distances.
    rows: array<vec4f, MOST_SURFACES>,
    ids: array<u32, MOST_SURFACES>,
    count: u32,
}

fn is_static(id: u32) -> bool {
    return id >= step.spheres + step.rods;
}

// How far the part of a box or polygon that is most in front of a plane is behind the parallel plane through a place.
fn front_of_shape(id: u32, place: vec3f, n: vec3f) -> f32 {
    let boxes = step.spheres + step.rods;
    let x = near_shape(id, place);
    if id < boxes + step.boxes {
        let box = cuboid(id - boxes);
        return dot(box.corner - x, n) + min(dot(box.i, n), 0.0) + min(dot(box.j, n), 0.0) + min(dot(box.k, n), 0.0);
    }
    let face = polygon(id - boxes - step.boxes);
    if is_plane(face) || is_round(face) {
        return front_of_smooth(face, x, n, ONE_NORMAL);
    }
    let left = min(dot(face.left, n), 0.0);
    let right = min(dot(face.right, n), 0.0);
    return dot(face.corner - x, n) + select(left + right, min(left, right), is_triangle(face));
}

// The cosine of the angle up to which two normals are one.
fn one_normal(one: u32, other: u32) -> f32 {
    if TRIANGLES {
        if is_facet(one) && is_facet(other) {
            return step.mesh_cosine;
        }
    }
    return ONE_NORMAL;
}

fn is_facet(id: u32) -> bool {
    let polygons = step.spheres + step.rods + step.boxes;
    return (id >= polygons) && is_triangle(polygon(id - polygons));
}

// Whether a chosen candidate hides this one. A box that contains the centre hides only what is wholly behind its face.
fn is_behind(one: Candidate, own: vec4f, chosen: ptr<function, Surfaces>) -> bool {
    for (var k = 0u; k < (*chosen).count; k++) {
        if WALLS {
            // Shapes of different bodies do not hide each other.
            if body_of(one.id) != body_of((*chosen).ids[k]) {
                continue;
            }
        }
        let n = (*chosen).rows[k].xyz;
        let distance = (*chosen).rows[k].w;
        let cosine = dot(one.n, n);
        var front = one.distance * cosine;
        if distance < 0.0 {
            front = front_of_shape(one.id, own.xyz, n);
        }
        if (front >= distance - SURFACE_SLACK * own.w) | (cosine >= one_normal(one.id, (*chosen).ids[k])) {
            return true;
        }
    }
    return false;
}

// -1, 0 or 1: whether vector a comes before b, is b, or comes after it.
fn order_of_vectors(a: vec3f, b: vec3f) -> i32 {
    let before = vec3i(a < b);
    let after = vec3i(a > b);
    let order = before - after;
    return -select(select(order.z, order.y, order.y != 0), order.x, order.x != 0);
}

// Whether a box or polygon comes before another one at the same distance.
fn is_first_shape(one: u32, other: u32) -> bool {
    let boxes = step.spheres + step.rods;
    let polygons = boxes + step.boxes;
    if (one < polygons) != (other < polygons) {
        return one < polygons;
    }
    if one < polygons {
        let a = cuboid(one - boxes);
        let b = cuboid(other - boxes);
        let corner = order_of_vectors(a.corner, b.corner);
        let i = order_of_vectors(a.i, b.i);
        let j = order_of_vectors(a.j, b.j);
        return select(select(select(order_of_vectors(a.k, b.k), j, j != 0), i, i != 0), corner, corner != 0) < 0;
    }
    let a = polygon(one - polygons);
    let b = polygon(other - polygons);
    let corner = order_of_vectors(a.corner, b.corner);
    let left = order_of_vectors(a.left, b.left);
    return select(select(order_of_vectors(a.right, b.right), left, left != 0), corner, corner != 0) < 0;
}

// Whether the point of a box or polygon that is nearest to a place is on a face, and not on an edge or a corner. The place is outside of the box.
fn has_face_at(id: u32, place: vec3f) -> bool {
    let boxes = step.spheres + step.rods;
    let x = near_shape(id, place);
    if id < boxes + step.boxes {
        return is_over_box(x, cuboid(id - boxes));
    }
    return is_over_polygon(x, polygon(id - boxes - step.boxes));
}

// The better one of a candidate and a box or polygon: nearer, and not hidden by the chosen ones.
fn nearer_candidate(best: Candidate, i: u32, own: vec4f, id: u32, chosen: ptr<function, Surfaces>) -> Candidate {
    let found = touch_static(i, id, own);
    if !(found.overlap > 0.0) {
        return best;
    }
    var kept = best;
    kept.overlaps++;
    let distance = own.w - found.overlap;
    // An edge comes later than a face, whatever the rounding errors.
    let order = distance + select(EDGE_SLACK * distance, 0.0, (distance < 0.0) | has_face_at(id, own.xyz));
    let one = Candidate(id, distance, found.n, kept.overlaps, order);
    if is_behind(one, own, chosen) {
        return kept;
    }
    var is_nearer = (best.id == NONE) | (one.order < best.order);
    if !is_nearer & (one.order == best.order) {
        is_nearer = is_first_shape(id, best.id);
    }
    if is_nearer {
        return one;
    }
    return kept;
}

// A candidate that is not ordered.
fn candidate(id: u32, own: vec4f, found: Touch) -> Candidate {
    return Candidate(id, own.w - found.overlap, found.n, 0u, 0.0);
}

fn no_candidate() -> Candidate {
    return Candidate(NONE, 0.0, vec3f(0.0), 0u, 0.0);
}

// Whether a sphere overlaps a box or polygon that a chosen candidate hides. All candidates have been chosen from.
fn is_hidden(i: u32, own: vec4f, id: u32, chosen: ptr<function, Surfaces>) -> bool {
    for (var k = 0u; k < (*chosen).count; k++) {
        if (*chosen).ids[k] == id {
            return false;
        }
    }
    let found = touch_static(i, id, own);
    return (found.overlap > 0.0) && is_behind(candidate(id, own, found), own, chosen);
}

fn choose_surface(one: Candidate, chosen: ptr<function, Surfaces>) {
    (*chosen).rows[(*chosen).count] = vec4f(one.n, one.distance);
    (*chosen).ids[(*chosen).count] = one.id;
    (*chosen).count++;
}
