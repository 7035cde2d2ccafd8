// requires rigid/collide/closest.wgsl rigid/collide/manifold.wgsl rigid/collide/reduce.wgsl rigid/collide/solid.wgsl

// Any two of face, box and hull, with radii (docs/physics section 11.13).

// Normals whose product is greater are those of contacts that lie flat.
const FLAT: f32 = 0.99;

// Whether the contact of a face has the place of a contact of edges, and others: corners of a plate that lies over an edge touch, too.
fn lies_flat(face: ptr<function, Manifold>, edges: ptr<function, Manifold>, slack: f32) -> bool {
    return (*face).count > 1u && dot((*face).normal, (*edges).normal) > FLAT
        && least_separation(face) <= least_separation(edges) + slack;
}

struct SolidPair {
    a: Solid,
    b: Solid,
    radii: vec2f,
    // The greatest separation of the cores.
    most: f32,
    // Half the less width, for preferences.
    size: f32,
    // Rounding error of a separation.
    noise: f32,
}

// A face, or two edges, whose plane separates best.
struct BestAxis {
    separation: f32,
    // A face: its number, and 1 if it is one of b. Edges: of a and of b.
    first: u32,
    second: u32,
    exists: bool,
    // For edges.
    normal: vec3f,
}

// Corners of a face, each with the label of the edge after it. Two corners are a segment.
struct FacePolygon {
    count: u32,
    corners: array<vec3f, MOST_CANDIDATES>,
    labels: array<u32, MOST_CANDIDATES>,
}

// The least of its vertices along an axis.
fn lowest_of(solid: Solid, axis: vec3f) -> f32 {
    var least = 3e38;
    for (var k = 0u; k < 64u && k < vertices_of_core(solid.shape); k++) {
        least = min(least, dot(vertex_of(solid, k), axis));
    }
    return least;
}

fn width_of_shape(shape: Shape) -> f32 {
    var width = 2.0 * least_of(shape.size.xyz);
    if HULLS & (shape.core == CORE_HULL) {
        width = bitcast<f32>(hulls[shape.more].w);
    } else if shape.core == CORE_FACE {
        let u = shape.size.xy;
        let v = shape.size.zw;
        let area = abs(u.x * v.y - u.y * v.x);
        var flat = 2.0 * area / max(length(u), length(v));
        if (shape.more & TRIANGLE) != 0u {
            flat = 3.0 * area / max(distance(u, v), max(distance(v, -u - v), distance(u, -u - v)));
        }
        width = select(flat, 0.0, shape.radius > 0.0);
    }
    return width + 2.0 * shape.radius;
}

// The face that separates best. A later one must win by a margin times `bias`.
fn best_face(pair: SolidPair, bias: f32) -> BestAxis {
    var best = BestAxis(NO_SEPARATION, 0u, 0u, false, vec3f(0.0));
    for (var side = 0u; side < 2u; side++) {
        var own = pair.a;
        var other = pair.b;
        if side == 1u {
            own = pair.b;
            other = pair.a;
        }
        for (var face = 0u; face < 32u && face < faces_of_core(own.shape); face++) {
            let normal = normal_of(own, face);
            let separation = lowest_of(other, normal) - dot(corner_of(own, face, 0u), normal);
            let margin = bias * (0.02 * abs(best.separation) + 1e-3 * pair.size + pair.noise);
            if !best.exists || separation > best.separation + margin {
                best = BestAxis(separation, face, side, true, normal);
            }
            // Beyond reach: no later face is asked.
            if separation > pair.most {
                return BestAxis(separation, face, side, true, normal);
            }
        }
    }
    return best;
}

// The pair of edges that separates best. Only edges whose arcs cross on the sphere of normals make a face of the difference of the shapes.
fn best_edges(pair: SolidPair, bias: f32) -> BestAxis {
    var best = BestAxis(NO_SEPARATION, 0u, 0u, false, vec3f(0.0));
    for (var of_a = 0u; of_a < 96u && of_a < edges_of_core(pair.a.shape); of_a++) {
        let edge_a = edge_of_core(pair.a.shape, of_a);
        let start = vertex_of(pair.a, edge_a.x);
        let along = unit_or_zero(vertex_of(pair.a, edge_a.y) - start);
        let n1 = normal_of(pair.a, edge_a.z);
        let n2 = normal_of(pair.a, edge_a.w);
        for (var of_b = 0u; of_b < 96u && of_b < edges_of_core(pair.b.shape); of_b++) {
            let edge_b = edge_of_core(pair.b.shape, of_b);
            let m1 = normal_of(pair.b, edge_b.z);
            let m2 = normal_of(pair.b, edge_b.w);
            if sign(dot(m1, along)) * sign(dot(m2, along)) >= 0.0 {
                continue;
            }
            let other = vertex_of(pair.b, edge_b.x);
            let across = unit_or_zero(vertex_of(pair.b, edge_b.y) - other);
            let product = cross(along, across);
            let square = dot(product, product);
            if sign(dot(n1, across)) * sign(dot(n2, across)) >= 0.0 || square < 1e-6 {
                continue;
            }
            let size = sqrt(square);
            let of_n = dot(product, n1 + n2) / size;
            let of_m = -dot(product, m1 + m2) / size;
            if of_n * of_m <= 0.0 {
                continue;
            }
            let normal = product / size * unit_sign(of_n);
            let separation = dot(other - start, normal) - pair.noise / size;
            if !best.exists || separation > best.separation + bias * (0.02 * abs(best.separation) + 1e-3 * pair.size) {
                best = BestAxis(separation, of_a, of_b, true, normal);
            }
            if separation > pair.most {
                return BestAxis(separation, of_a, of_b, true, normal);
            }
        }
    }
    return best;
}

// One point between two edges. None if the nearest points of their lines are beyond the edges.
fn contact_of_solid_edges(pair: SolidPair, axis: BestAxis) -> Manifold {
    if !axis.exists {
        return no_contact();
    }
    let edge_a = edge_of_core(pair.a.shape, axis.first);
    let edge_b = edge_of_core(pair.b.shape, axis.second);
    let start = vertex_of(pair.a, edge_a.x);
    let other = vertex_of(pair.b, edge_b.x);
    let way_a = vertex_of(pair.a, edge_a.y) - start;
    let way_b = vertex_of(pair.b, edge_b.y) - other;
    let along = unit_or_zero(way_a);
    let across = unit_or_zero(way_b);
    let places = closest_of_lines(start, along, other, across);
    if places.z <= 0.0 || !is_on_edge(places.x, length(way_a)) || !is_on_edge(places.y, length(way_b)) {
        return no_contact();
    }
    let on_a = start + places.x * along;
    let on_b = other + places.y * across;
    if dot(on_b - on_a, axis.normal) > pair.most {
        return no_contact();
    }
    return one_point(axis.normal, on_a, on_b, pair.radii, id_of_edges(axis.first, axis.second));
}

// One point between the closest points of the cores, unless these are nearer than `least`.
fn contact_of_closest(pair: SolidPair, points: ClosestPoints, least: f32) -> Manifold {
    if points.apart > pair.most || points.apart <= least {
        return no_contact();
    }
    return one_point(points.normal, points.on_a, points.on_b, pair.radii, id_of_closest(points.of_a, points.of_b));
}

// Removes what lies above a plane. The new edge gets a label.
fn cut_polygon(polygon: ptr<function, FacePolygon>, out: vec3f, bound: f32, label: u32) {
    var before = *polygon;
    var count = 0u;
    let is_segment = before.count == 2u;
    let edges = select(before.count, 1u, is_segment);
    for (var k = 0u; k < MOST_CANDIDATES && k < edges; k++) {
        let start = before.corners[k];
        let next = select(k + 1u, 0u, k + 1u == before.count);
        let end = before.corners[next];
        let above = dot(start, out) - bound;
        let below = dot(end, out) - bound;
        if above <= 0.0 && count < MOST_CANDIDATES {
            (*polygon).corners[count] = start;
            (*polygon).labels[count] = before.labels[k];
            count++;
        }
        if (above > 0.0) != (below > 0.0) && count < MOST_CANDIDATES {
            (*polygon).corners[count] = start + (end - start) * (above / (above - below));
            (*polygon).labels[count] = select(label, before.labels[k], above > 0.0);
            count++;
        }
        if is_segment && below <= 0.0 {
            (*polygon).corners[count] = end;
            (*polygon).labels[count] = before.labels[next];
            count++;
        }
    }
    (*polygon).count = count;
}

// The face at the lowest vertex along an axis whose normal is most against the axis.
fn face_against(solid: Solid, axis: vec3f) -> u32 {
    let lowest = farthest_vertex(solid, -axis);
    var best = 3e38;
    var found = 0u;
    for (var face = 0u; face < 32u && face < faces_of_core(solid.shape); face++) {
        let product = dot(normal_of(solid, face), axis);
        if product >= best - 1e-4 {
            continue;
        }
        for (var k = 0u; k < 64u && k < corners_of_core(solid.shape, face); k++) {
            if corner_of_core(solid.shape, face, k) == lowest {
                best = product;
                found = face;
                break;
            }
        }
    }
    return found;
}

// Points of the other shape's face above a face. Sides of a flat face have only an edge, which is clipped instead.
fn contact_of_solid_face(pair: SolidPair, axis: BestAxis) -> Manifold {
    let of_b = axis.second == 1u;
    var own = pair.a;
    var other = pair.b;
    if of_b {
        own = pair.b;
        other = pair.a;
    }
    let normal = normal_of(own, axis.first);
    let incident = face_against(other, normal);
    let against = normal_of(other, incident);
    let slope = dot(against, normal);
    let is_side = corners_of_core(own.shape, axis.first) == 2u;

    // The face that is clipped, and the one between whose sides. Candidates have their places on a.
    var clipped = other;
    var clipped_face = incident;
    var within = own;
    var within_face = axis.first;
    if is_side {
        clipped = own;
        clipped_face = axis.first;
        within = other;
        within_face = incident;
    }
    var polygon: FacePolygon;
    polygon.count = min(corners_of_core(clipped.shape, clipped_face), MOST_CANDIDATES);
    for (var k = 0u; k < MOST_CANDIDATES && k < polygon.count; k++) {
        polygon.corners[k] = corner_of(clipped, clipped_face, k);
        polygon.labels[k] = k;
    }
    let turn = select(1.0, unit_sign(slope), is_side);
    for (var k = 0u; k < 64u && k < corners_of_core(within.shape, within_face); k++) {
        let start = corner_of(within, within_face, k);
        let out = unit_or_zero(cross(corner_after(within, within_face, k) - start, normal) * turn);
        if any(out != vec3f(0.0)) {
            cut_polygon(&polygon, out, dot(start, out) + pair.noise, 32u + k);
        }
    }
    if polygon.count == 0u || is_side && slope >= -1e-3 {
        return no_contact();
    }
    let anchor = corner_of(within, within_face, 0u);
    let outward = select(normal, -normal, of_b);
    var candidates: Candidates;
    candidates.count = 0u;
    var before = polygon.labels[polygon.count - 1u];
    for (var k = 0u; k < MOST_CANDIDATES && k < polygon.count; k++) {
        let corner = polygon.corners[k];
        let after = polygon.labels[k];
        let height = select(dot(corner - anchor, normal), dot(anchor - corner, against) / slope, is_side);
        if height <= pair.most {
            // The corner is on the shape that is clipped.
            let is_on_a = of_b != is_side;
            let foot = corner + select(-height, height, is_side) * normal;
            candidates.places[candidates.count] = vec4f(select(foot, corner, is_on_a), height);
            candidates.ids[candidates.count] = id_of_corner(of_b, axis.first, incident, before, after);
            candidates.count++;
        }
        before = after;
    }
    let along = corner_of(own, axis.first, 1u) - corner_of(own, axis.first, 0u);
    return reduced(&candidates, outward, unit_or_zero(along), pair.radii);
}

// A common point of shapes that overlap, pushed out of a face.
fn contact_of_common_point(pair: SolidPair, face: BestAxis, place: vec3f) -> Manifold {
    let of_b = face.second == 1u;
    var own = pair.a;
    if of_b {
        own = pair.b;
    }
    let foot = place - dot(place - corner_of(own, face.first, 0u), face.normal) * face.normal;
    let outward = select(face.normal, -face.normal, of_b);
    return one_point(outward, select(foot, place, of_b), select(place, foot, of_b), pair.radii, 0u);
}

// Compilers put the body of a function in the place of each call, so axes and contacts are computed in one place, in three rounds: with
// preferences; the edges without, if those with are no contact but win; and the strict contact. After the second one the closest points
// may decide.
fn collide_solids(a: Solid, b: Solid, reach: f32) -> Manifold {
    let radii = vec2f(a.shape.radius, b.shape.radius);
    let rounding = radii.x + radii.y;
    let scales = extent_of_solid(a) + extent_of_solid(b) + greatest_of(abs(b.position));
    let size = 0.5 * min(width_of_shape(a.shape), width_of_shape(b.shape));
    let pair = SolidPair(a, b, radii, reach + rounding, size, 4.0 * EPSILON * scales);
    let tiny = 1e-3 * size + pair.noise;
    let a_is_face = a.shape.core == CORE_FACE;
    let b_is_face = b.shape.core == CORE_FACE;
    let is_one_sided = a_is_face && (a.shape.more & ONE_SIDED) != 0u;
    if a_is_face && b_is_face && (is_one_sided || (b.shape.more & ONE_SIDED) != 0u) || is_one_sided && b.position.z < 0.0 {
        return no_contact();
    }

    var found = no_contact();
    var by_edges = no_contact();
    var first_face = BestAxis();
    var best = 0.0;
    var wins = false;
    var least = 0.0;
    var points = ClosestPoints();
    for (var round = 0u; round < 3u; round++) {
        if round == 1u && !(wins && found.count == 0u) {
            continue;
        }
        if round == 2u {
            let exists = found.count > 0u;
            least = least_separation(&found);
            let is_round = exists && best > 0.0 && rounding > 0.0;
            let is_beside = exists && !is_round && best > 0.0 && least > best + 20.0 * tiny;
            let is_touch = !exists && best > -10.0 * tiny;
            let is_inside = exists && best <= 0.0 && least + rounding > best + 0.1 * abs(best) + 20.0 * tiny;
            if is_one_sided || exists && !is_round && !is_beside && !is_inside {
                return found;
            }
            points = closest_of_solids(a, b);
            if is_round || is_beside || is_touch {
                var other = contact_of_closest(pair, points, select(tiny, 0.0, is_round));
                let other_least = least_separation(&other);
                if is_touch && other.count == 0u {
                    return by_edges;
                }
                let is_same = other.count > 0u && abs(other_least - least) <= 1e-3 * (best + size) + pair.noise;
                let is_better = other.count > 0u && other_least < least - 20.0 * tiny;
                if is_touch || is_round && !is_same || is_beside && is_better {
                    return other;
                }
                return found;
            }
        }

        let bias = select(0.0, 1.0, round == 0u);
        var face = BestAxis(0.0, 0u, 0u, true, vec3f(0.0, 0.0, 1.0));
        var edges = BestAxis(NO_SEPARATION, 0u, 0u, false, vec3f(0.0));
        if is_one_sided {
            face.separation = lowest_of(b, face.normal);
        } else {
            face = best_face(pair, bias);
            edges = best_edges(pair, bias);
        }
        if max(face.separation, edges.separation) > pair.most {
            return no_contact();
        }
        if round == 0u {
            first_face = face;
            best = max(face.separation, edges.separation);
            wins = edges.exists && edges.separation > face.separation + 0.05 * abs(face.separation) + 0.01 * size;
        } else if round == 1u {
            face = first_face;
        }
        let edges_first = round < 2u || edges.exists && edges.separation > face.separation;
        var contact = no_contact();
        let may_lie_flat = wins && round < 2u;
        for (var attempt = 0u; attempt < 2u && (contact.count == 0u || may_lie_flat); attempt++) {
            if edges_first == (attempt == 0u) {
                contact = contact_of_solid_edges(pair, edges);
                if round == 0u {
                    by_edges = contact;
                    contact.count = select(0u, contact.count, wins);
                }
            } else if round > 0u || !wins || contact.count > 0u {
                var flat = contact_of_solid_face(pair, face);
                if contact.count == 0u || lies_flat(&flat, &contact, 0.01 * size + pair.noise) {
                    contact = flat;
                }
            }
        }
        if round == 2u {
            if contact.count == 0u {
                contact = contact_of_common_point(pair, face, points.on_b);
            }
            if found.count > 0u && least_separation(&contact) >= least {
                return found;
            }
        }
        found = contact;
    }
    return found;
}
