// requires rigid/collide/ball.wgsl rigid/collide/closest.wgsl rigid/collide/manifold.wgsl rigid/collide/solid.wgsl

// A segment with a radius against segments, faces, boxes and hulls (docs/physics section 11.13).

struct Segment {
    start: vec3f,
    end: vec3f,
}

fn segment_of(solid: Solid) -> Segment {
    return Segment(vertex_of(solid, 0u), vertex_of(solid, 1u));
}

// Two points at the ends of the common extent of two segments that are nearly parallel there. `most` is the reach of the cores.
fn side_by_side(a: Segment, b: Segment, radii: vec2f, most: f32, number: u32) -> Manifold {
    let along = unit_or_zero(a.end - a.start);
    let across = unit_or_zero(b.end - b.start);
    let cosine = dot(along, across);
    if abs(cosine) < 0.99 {
        return no_contact();
    }
    let size = distance(a.start, a.end);
    let ends = vec2f(dot(b.start - a.start, along), dot(b.end - a.start, along));
    let low = max(min(ends.x, ends.y), 0.0);
    let high = min(max(ends.x, ends.y), size);
    if high - low < 1e-3 * min(size, distance(b.start, b.end)) {
        return no_contact();
    }
    var feet = array<vec3f, 2>(a.start + low * along, a.start + high * along);
    var offsets: array<vec3f, 2>;
    for (var k = 0u; k < 2u; k++) {
        // Where b passes a foot, at the same coordinate along a.
        offsets[k] = b.start + across * (dot(feet[k] - b.start, along) / cosine) - feet[k];
    }
    let normal = unit_or_zero(offsets[0] + offsets[1]);
    let width = select(radii.y, min(radii.x, radii.y), radii.x > 0.0);
    var manifold = Manifold();
    manifold.normal = normal;
    for (var k = 0u; k < 2u; k++) {
        let separation = dot(offsets[k], normal);
        if separation <= 0.0 || length(offsets[k] - separation * normal) >= 0.01 * width {
            return no_contact();
        }
        if separation <= most {
            manifold.on_a[manifold.count] = feet[k] + radii.x * normal;
            manifold.on_b[manifold.count] = feet[k] + (separation - radii.y) * normal;
            manifold.ids[manifold.count] = number + 1u + k;
            manifold.count++;
        }
    }
    return manifold;
}

// The closest points of two segments.
fn closest_of_segments(a: Segment, b: Segment) -> Segment {
    let along = unit_or_zero(a.end - a.start);
    let across = unit_or_zero(b.end - b.start);
    let places = closest_of_lines(a.start, along, b.start, across);
    let is_inside = (places.xy >= vec2f(0.0)) & (places.xy <= vec2f(distance(a.start, a.end), distance(b.start, b.end)));
    if places.z > 0.0 && all(is_inside) {
        return Segment(a.start + places.x * along, b.start + places.y * across);
    }
    // At least one of the points is an end.
    var best = Segment(a.start, vec3f(0.0));
    var least = 3e38;
    for (var k = 0u; k < 4u; k++) {
        let of_a = k < 2u;
        var own = a;
        var other = b;
        if !of_a {
            own = b;
            other = a;
        }
        let end = select(own.start, own.end, (k & 1u) == 1u);
        let place = place_on_segment(other.start, other.end, end);
        let square = dot(place - end, place - end);
        if square < least {
            least = square;
            best = Segment(select(place, end, of_a), select(end, place, of_a));
        }
    }
    return best;
}

fn collide_capsules(a: Solid, b: Solid, reach: f32) -> Manifold {
    let first = segment_of(a);
    let second = segment_of(b);
    let radii = vec2f(a.shape.radius, b.shape.radius);
    let most = reach + radii.x + radii.y;
    let cores = closest_of_segments(first, second);
    let offset = cores.end - cores.start;
    let apart = length(offset);
    if apart > most {
        return no_contact();
    }
    let beside = side_by_side(first, second, radii, most, id_of_edges(0u, 0u));
    if beside.count > 0u {
        return beside;
    }
    let noise = 4.0 * EPSILON * (a.shape.size.x + b.shape.size.x + greatest_of(abs(b.position)));
    var normal = offset / apart;
    if apart <= noise {
        normal = unit_or_zero(cross(unit_or_zero(first.end - first.start), unit_or_zero(second.end - second.start)));
        normal = select(normal, vec3f(1.0, 0.0, 0.0), all(normal == vec3f(0.0)));
        normal *= unit_sign(dot(normal, b.position));
    }
    return one_point(normal, cores.start, cores.end, radii, 0u);
}

// The ends of a segment b above a half-space a.
fn capsule_above_half_space(a: Shape, b: Solid, reach: f32) -> Manifold {
    var manifold = Manifold();
    manifold.normal = vec3f(0.0, 1.0, 0.0);
    for (var k = 0u; k < 2u; k++) {
        let end = vertex_of(b, k);
        if a.more == HALF_SPACE && end.y <= reach + a.radius + b.shape.radius {
            manifold.on_a[manifold.count] = vec3f(end.x, a.radius, end.z);
            manifold.on_b[manifold.count] = vec3f(end.x, end.y - b.shape.radius, end.z);
            manifold.ids[manifold.count] = id_of_vertex(k);
            manifold.count++;
        }
    }
    return manifold;
}

// A polyhedron a and a segment b.
struct CapsulePair {
    a: Solid,
    segment: Segment,
    radii: vec2f,
    // The greatest separation of the cores.
    most: f32,
    // Rounding error of a coordinate.
    noise: f32,
    // Where the middle of the segment is, for faces.
    is_below: bool,
}

// Points of the segment above a face.
fn capsule_above_face(pair: CapsulePair, face: u32) -> Manifold {
    let normal = normal_of(pair.a, face);
    let anchor = corner_of(pair.a, face, 0u);
    var start = pair.segment.start;
    var end = pair.segment.end;
    for (var k = 0u; k < 64u && k < corners_of_core(pair.a.shape, face); k++) {
        let corner = corner_of(pair.a, face, k);
        let out = unit_or_zero(cross(corner_after(pair.a, face, k) - corner, normal));
        let bound = dot(corner, out) + pair.noise;
        let above = dot(start, out) - bound;
        let below = dot(end, out) - bound;
        if above > 0.0 && below > 0.0 {
            return no_contact();
        }
        let crossing = start + (end - start) * (above / (above - below));
        if above > 0.0 {
            start = crossing;
        } else if below > 0.0 {
            end = crossing;
        }
    }
    var manifold = Manifold();
    manifold.normal = normal;
    for (var k = 0u; k < 2u; k++) {
        let place = select(start, end, k == 1u);
        let separation = dot(place - anchor, normal);
        if separation <= pair.most {
            manifold.on_a[manifold.count] = place + (pair.radii.x - separation) * normal;
            manifold.on_b[manifold.count] = place - pair.radii.y * normal;
            manifold.ids[manifold.count] = id_of_corner(false, face, 0u, 0u, k);
            manifold.count++;
        }
    }
    return manifold;
}

// The least separation of the cores is about their distance.
fn fits_distance(pair: CapsulePair, manifold: ptr<function, Manifold>, apart: f32) -> bool {
    let off = least_separation(manifold) + pair.radii.x + pair.radii.y - apart;
    return abs(off) <= 0.01 * (apart + pair.radii.y);
}

// The face that the ends are least below, and its depth. A later one must win by a part of the depth.
fn least_deep_face(pair: CapsulePair, part: f32) -> vec2f {
    var best = vec2f(0.0, NO_SEPARATION);
    for (var face = 0u; face < 32u && face < faces_of_core(pair.a.shape); face++) {
        let normal = normal_of(pair.a, face);
        let bound = dot(corner_of(pair.a, face, 0u), normal);
        let depth = min(dot(pair.segment.start, normal), dot(pair.segment.end, normal)) - bound;
        let is_flat = pair.a.shape.core == CORE_FACE;
        let is_first = face == 0u && !is_flat;
        let is_better = is_first || depth > best.y + part * abs(best.y);
        if select(is_better, face == select(0u, 1u, pair.is_below), is_flat) {
            best = vec2f(f32(face), depth);
        }
    }
    return best;
}

// Cores that overlap and have a common point: the way out that is shortest.
fn capsule_inside(pair: CapsulePair, shared_place: vec3f) -> Manifold {
    let shape = pair.a.shape;
    let is_flat = shape.core == CORE_FACE;
    let along = unit_or_zero(pair.segment.end - pair.segment.start);
    let size = distance(pair.segment.start, pair.segment.end);
    let preferred = least_deep_face(pair, 0.02);
    let deepest = least_deep_face(pair, 0.0);
    let enough = preferred.y + 0.05 * abs(preferred.y);
    // The best edge and face, with a preference, without one, and then without conditions.
    for (var attempt = 0u; attempt < 6u; attempt++) {
        let part = select(0.0, 0.02, attempt == 0u || attempt == 2u || attempt == 5u);
        let has_condition = attempt < 4u;
        if attempt < 2u || attempt == 4u {
            var best = NO_SEPARATION;
            var normal = vec3f(0.0);
            var start = vec3f(0.0);
            var end = vec3f(0.0);
            var exists = false;
            for (var edge = 0u; edge < 96u && edge < edges_of_core(shape); edge++) {
                let numbers = edge_of_core(shape, edge);
                let first = normal_of(pair.a, numbers.z);
                let second = normal_of(pair.a, numbers.w);
                let from_vertex = vertex_of(pair.a, numbers.x);
                let to_vertex = vertex_of(pair.a, numbers.y);
                let product = cross(unit_or_zero(to_vertex - from_vertex), along);
                if dot(first, along) * dot(second, along) >= 0.0 || dot(product, product) < 1e-6 {
                    continue;
                }
                let outward = normalize(product) * unit_sign(dot(product, first + second));
                let separation = dot(pair.segment.start - from_vertex, outward);
                if !exists || separation > best + part * abs(best) {
                    exists = true;
                    best = separation;
                    normal = outward;
                    start = from_vertex;
                    end = to_vertex;
                }
            }
            let direction = unit_or_zero(end - start);
            let places = closest_of_lines(start, direction, pair.segment.start, along);
            let is_within = is_on_edge(places.x, distance(start, end)) && is_on_edge(places.y, size);
            let is_allowed = exists && !(is_flat && (shape.more & ONE_SIDED) != 0u) && (!has_condition || best > enough);
            if is_allowed && places.z > 0.0 && is_within {
                return one_point(normal, start + places.x * direction, pair.segment.start + places.y * along, pair.radii, 0u);
            }
        } else {
            let face = select(deepest, preferred, part > 0.0);
            var found = capsule_above_face(pair, u32(face.x));
            let most = face.y + 0.05 * abs(face.y) + pair.noise - pair.radii.x - pair.radii.y;
            if found.count > 0u && (!has_condition || is_flat || least_separation(&found) <= most) {
                return found;
            }
        }
    }
    if is_flat {
        return no_contact();
    }
    let face = u32(deepest.x);
    let normal = normal_of(pair.a, face);
    let height = dot(shared_place - corner_of(pair.a, face, 0u), normal);
    return one_point(normal, shared_place - height * normal, shared_place, pair.radii, 0u);
}

// A face, box or hull a and a capsule b.
fn collide_capsule(a: Solid, b: Solid, reach: f32) -> Manifold {
    let radii = vec2f(a.shape.radius, b.shape.radius);
    let noise = 2.0 * EPSILON * (extent_of_solid(a) + b.shape.size.x + greatest_of(abs(b.position)));
    let pair = CapsulePair(a, segment_of(b), radii, reach + radii.x + radii.y, noise, b.position.z < 0.0);
    let is_one_sided = a.shape.core == CORE_FACE && (a.shape.more & ONE_SIDED) != 0u;
    if is_one_sided && pair.is_below {
        return no_contact();
    }
    let points = closest_of_solids(a, b);
    if points.apart > pair.most {
        return no_contact();
    }
    // Single precision tells apart no less than this.
    if points.apart <= 4.0 * noise {
        return capsule_inside(pair, points.on_b);
    }
    let normal = points.normal;
    if is_one_sided && normal.z < 1e-3 {
        return no_contact();
    }
    for (var face = 0u; face < 32u && face < faces_of_core(a.shape); face++) {
        if dot(normal_of(a, face), normal) > 0.99999 {
            var found = no_contact();
            if corners_of_core(a.shape, face) > 2u {
                found = capsule_above_face(pair, face);
            }
            if found.count > 0u && fits_distance(pair, &found, points.apart) {
                return found;
            }
            break;
        }
    }
    let along = unit_or_zero(pair.segment.end - pair.segment.start);
    for (var edge = 0u; edge < 96u && edge < edges_of_core(a.shape); edge++) {
        let numbers = edge_of_core(a.shape, edge);
        let own = Segment(vertex_of(a, numbers.x), vertex_of(a, numbers.y));
        if abs(dot(unit_or_zero(own.end - own.start), along)) < 0.999 {
            continue;
        }
        var found = side_by_side(own, pair.segment, radii, pair.most, id_of_edges(edge + 1u, 0u));
        if found.count > 0u && dot(found.normal, normal) > 0.999 && fits_distance(pair, &found, points.apart) {
            return found;
        }
    }
    return one_point(normal, points.on_a, points.on_b, radii, 0u);
}
