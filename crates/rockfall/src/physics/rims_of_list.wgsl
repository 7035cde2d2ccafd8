// requires model/entries.wgsl model/lists.wgsl model/objects.wgsl model/step.wgsl physics/contact.wgsl physics/geometry.wgsl physics/rod_polygon.wgsl
// requires physics/smooth.wgsl physics/walls.wgsl

// The edges and vertices of polygons in the list of a rod that are no edges of the surface, or count elsewhere (docs/physics section 2.19).

// Distance, as a part of the radius of the rod, at which the surface beside an edge is looked for, and up to which places are one.
const BESIDE_RIM: f32 = 1e-3;
// Room along the edges of a polygon, as a part of that distance.
const RIM_ROOM: f32 = 0.3;
// The sine of the angle up to which a bent surface has no edge.
const BENT: f32 = 0.01;
// Another polygon goes on at an edge if the cosine of the angle between both is at most this.
const FOLDED: f32 = 0.5;
// An edge leads towards the rod if the cosine of its angle with the normal is less than this.
const LEADS_NEARER: f32 = -1e-3;

// A contact of the axis of a rod with an edge of a polygon.
struct RimContact {
    id: u32,
    feature: u32,
    is_vertex: bool,
    n: vec3f,
    place: vec3f,
    // Unit vectors along the edge, and across it into the polygon.
    along: vec3f,
    inward: vec3f,
}

fn polygon_at(origin: u32, id: u32) -> Polygon {
    return polygon_from(origin, polygon(id - step.spheres - step.rods - step.boxes));
}

fn rim_contact(own: Bar, id: u32, feature: u32, face: Polygon, found: AxisTouch) -> RimContact {
    let along = normalize(rim_of(face, feature).along);
    let place = own.axis.start + found.touch.a * own.axis.along + (own.axis.radius - found.touch.overlap) * found.touch.n;
    let share = select(0.5, 1.0 / 3.0, is_triangle(face));
    let inside = face.corner + share * (face.left + face.right) - place;
    return RimContact(id, feature, found.is_vertex, found.touch.n, place, along, normalize(inside - dot(inside, along) * along));
}

// Whether a point belongs to a polygon, with room of the length `reach` across it and a part of that along it.
fn is_on_polygon(face: Polygon, front: Face, place: vec3f, reach: f32) -> bool {
    let t = place - face.corner;
    let at = along_edges(front, t);
    let room = RIM_ROOM * reach / vec2f(length(face.left), length(face.right));
    let is_inside = all(at >= -room) & all(at <= vec2f(1.0) + room);
    let is_beyond = is_triangle(face) & (at.x + at.y > 1.0 + max(room.x, room.y));
    return is_inside & !is_beyond & (abs(dot(t, front.n)) <= reach);
}

// Whether a polygon goes on at the edge of another one, so that the surface is flat or hollow there.
fn goes_on(rim: RimContact, face: Polygon, reach: f32) -> bool {
    let front = face_of(face);
    let across_edge = cross(rim.along, front.n);
    if dot(across_edge, across_edge) < 1e-6 {
        return false;
    }
    let way = normalize(across_edge);
    for (var k = 0u; k < 2u; k++) {
        let v = select(way, -way, k == 1u);
        if (dot(v, rim.inward) <= FOLDED) & (dot(rim.n, rim.inward + v) <= BENT) {
            if is_on_polygon(face, front, rim.place + reach * v, reach) {
                return true;
            }
        }
    }
    return false;
}

// Whether the contact with another edge comes before one at the same place.
fn comes_before(own: Bar, rim: RimContact, id: u32, feature: u32, face: Polygon, reach: f32) -> bool {
    let their = touch_axis(own.axis, face, feature, false);
    if !(their.touch.overlap > 0.0) {
        return false;
    }
    let place = own.axis.start + their.touch.a * own.axis.along + (own.axis.radius - their.touch.overlap) * their.touch.n;
    if distance(place, rim.place) > reach {
        return false;
    }
    if their.is_vertex != rim.is_vertex {
        return rim.is_vertex;
    }
    return (id < rim.id) | ((id == rim.id) & (feature < rim.feature));
}

// Whether an edge leads from a vertex towards the rod.
fn leads_nearer(rim: RimContact, other: Rim, reach: f32) -> bool {
    if !rim.is_vertex {
        return false;
    }
    if distance(nearest_on_rim(other, rim.place), rim.place) > reach {
        return false;
    }
    let one = other.start - rim.place;
    let two = one + other.along;
    let by_one = (length(one) > reach) & (dot(one, rim.n) < LEADS_NEARER * length(one));
    return by_one | ((length(two) > reach) & (dot(two, rim.n) < LEADS_NEARER * length(two)));
}

// Whether the contact of a rod with an edge or vertex does not count, because of any polygon of the list that belongs to the same body.
fn is_rim_hidden(own: Bar, rim: RimContact, first: vec2u, count: u32) -> bool {
    let reach = BESIDE_RIM * own.axis.radius;
    for (var e = count; e > 0u; e--) {
        let entry = entry_at(slot_at(first, e - 1u));
        let id = entry_id(entry);
        let feature = entry_feature(entry);
        if !is_polygon(id) {
            break;
        }
        if WALLS {
            if body_of(id) != body_of(rim.id) {
                continue;
            }
        }
        let face = polygon_at(own.ends.x, id);
        if is_round(face) {
            continue;
        }
        if (feature == 0u) & (id != rim.id) {
            if goes_on(rim, face, reach) {
                return true;
            }
        }
        if leads_nearer(rim, rim_of(face, feature), reach) {
            return true;
        }
        if (id != rim.id) | (feature != rim.feature) {
            if comes_before(own, rim, id, feature, face, reach) {
                return true;
            }
        }
    }
    return false;
}

fn is_polygon(id: u32) -> bool {
    return id >= step.spheres + step.rods + step.boxes;
}

// Which of the entries of a rod from `begin` on, up to ENTRIES_PER_MASK, are hidden edges of polygons: a bit each.
fn hidden_rims(own: Bar, first: vec2u, begin: u32, count: u32) -> u32 {
    var hidden = 0u;
    for (var e = min(begin + ENTRIES_PER_MASK, count); e > begin; e--) {
        let entry = entry_at(slot_at(first, e - 1u));
        let id = entry_id(entry);
        if !is_polygon(id) {
            break;
        }
        let face = polygon_at(own.ends.x, id);
        if is_round(face) {
            continue;
        }
        let found = touch_axis(own.axis, face, entry_feature(entry), false);
        if found.touch.overlap > 0.0 {
            let rim = rim_contact(own, id, entry_feature(entry), face, found);
            hidden |= u32(is_rim_hidden(own, rim, first, count)) << (e - 1u - begin);
        }
    }
    return hidden;
}
