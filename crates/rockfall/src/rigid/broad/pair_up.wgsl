// requires rigid/broad/search.wgsl rigid/broad/apart.wgsl rigid/frame/colliders.wgsl rigid/frame/rows.wgsl

// Pairs of colliders whose AABBs overlap and that may touch (docs/physics section 11.3). A collider looks for others in the cells of its
// own level and of all coarser ones, and at the large ones. In a periodic scene its images look, too.
//
// The pairs of a thread are written together: it keeps up to MOST_KEPT and takes room for all of them.

// Where the colliders of each slot end: `cells`.
@group(0) @binding(26) var<storage, read> ends: array<u32>;

struct Own {
    collider: u32,
    body: u32,
    home: u32,
    group: u32,
    meets: u32,
    has_mass: bool,
    least: vec3f,
    most: vec3f,
    // The displacement of the image that looks for others.
    way: vec3f,
}

const MOST_KEPT: u32 = 16u;

var<private> kept: array<vec2u, MOST_KEPT>;
var<private> kept_count: u32;

fn put_candidate(at: u32, pair: vec2u) {
    if at < search.candidates {
        candidates[at] = pair;
    }
}

// Whether colliders of two groups touch: the same group, or a bit of the groups that it meets.
fn touches(own: Own, group: u32) -> bool {
    return select(((own.meets >> (group >> 16u)) & 1u) == 1u, own.group == group, own.meets == 0u);
}

// A collider whose AABB overlaps.
fn take(own: Own, other: u32) {
    let body = body_of_collider(other);
    let home = home_in_search(body);
    if JOINED && own.home != home && own.home != 0u && home != 0u {
        return;
    }
    if body == own.body || !touches(own, marks_of_collider(other).x) || !(own.has_mass || has_mass(body)) {
        return;
    }
    if are_apart(own.body, body) || (PERIODIC && any(image_of(own.body, body) != -own.way)) {
        return;
    }
    let pair = select(vec2u(other, own.collider), vec2u(own.collider, other), own.body < body);
    if kept_count < MOST_KEPT {
        kept[kept_count] = pair;
        kept_count++;
    } else {
        put_candidate(atomicAdd(&counts[0], 1u), pair);
    }
}

fn overlaps(own: Own, least: vec4u, most: vec4u) -> bool {
    return all(own.least <= bitcast<vec3f>(most.xyz)) && all(bitcast<vec3f>(least.xyz) <= own.most);
}

// A cell. Slots are shared with other cells. Of its own cell a collider takes the greater numbers.
fn look_into(own: Own, key: vec2u, is_own: bool) {
    let slot = slot_of(key);
    var at = 0u;
    if slot > 0u {
        at = ends[slot - 1u];
    }
    for (let end = ends[slot]; at < end; at++) {
        let other = members[at];
        let least = bounds[2u * other];
        let most = bounds[2u * other + 1u];
        let is_there = least.w == key.x && most.w == key.y && (!is_own || other > own.collider);
        if is_there && overlaps(own, least, most) {
            take(own, other);
        }
    }
}

// The cells of a level: at most three along each axis, whatever the box. Of its own level a collider looks at its own cell and at
// those after it. Its images look at all cells, and take the greater numbers of its own level.
fn look_around(own: Own, level: u32, cell: vec3i, is_own_level: bool) {
    let fineness = fineness_of(level);
    let low = vec3i(floor(own.least * fineness - vec3f(0.5)));
    let high = vec3i(floor(own.most * fineness + vec3f(0.5)));
    let is_image = PERIODIC && any(own.way != vec3f(0.0));
    let is_half = is_own_level && !is_image;
    let start_z = select(low.z, cell.z, is_half);
    for (var z = start_z; z <= min(high.z, start_z + 2); z++) {
        let is_layer = is_half && z == cell.z;
        let start_y = select(low.y, cell.y, is_layer);
        for (var y = start_y; y <= min(high.y, start_y + 2); y++) {
            let is_row = is_layer && y == cell.y;
            let start_x = select(low.x, cell.x, is_row);
            for (var x = start_x; x <= min(high.x, start_x + 2); x++) {
                let key = key_in_world(key_of(level, vec3i(x, y, z)), own.home);
                look_into(own, key, (is_row && x == cell.x) || (is_own_level && is_image));
            }
        }
    }
}

fn look_at_large(own: Own, is_large: bool) {
    let count = atomicLoad(&counts[3]);
    for (var k = 0u; k < count; k++) {
        let other = members[search.colliders + k];
        if (!is_large || other > own.collider) && overlaps(own, bounds[2u * other], bounds[2u * other + 1u]) {
            take(own, other);
        }
    }
}

fn look(own: Own, key: vec2u, is_in_cells: bool) {
    if is_in_cells {
        let first = level_of_key(key);
        let used = atomicLoad(&counts[2]);
        for (var level = first; level < LEVELS; level++) {
            if ((used >> level) & 1u) == 1u {
                look_around(own, level, cell_of_key(key_in_world(key, own.home)), level == first);
            }
        }
    }
    look_at_large(own, !is_in_cells);
}

// Moves a collider to an image of itself: number 0 is where it is. False for images that are not near enough to the box.
fn move_to_image(own: ptr<function, Own>, image: u32, least: vec3f, most: vec3f) -> bool {
    // 0, 1 and -1 along each axis.
    let step = (vec3i(vec3u(image, image / 3u, image / 9u) % 3u) + 1) % 3 - 1;
    if any((step != vec3i(0)) & (frame.period == vec3f(0.0))) {
        return false;
    }
    (*own).way = vec3f(step) * frame.period;
    (*own).least = least + (*own).way;
    (*own).most = most + (*own).way;
    let reach = bitcast<f32>(atomicLoad(&counts[4]));
    let is_near = ((*own).most >= frame.box_start - reach) & ((*own).least <= frame.box_start + frame.period + reach);
    return image == 0u || all(is_near | (step == vec3i(0)));
}

fn find_pairs(k: u32) {
    // The colliders in the order of their cells, then the large ones.
    let in_cells = ends[search.slots - 1u];
    let collider = members[select(search.colliders + k - in_cells, k, k < in_cells)];
    let least = bounds[2u * collider];
    let most = bounds[2u * collider + 1u];
    let body = body_of_collider(collider);
    let marks = marks_of_collider(collider);
    var own =
        Own(collider, body, home_in_search(body), marks.x, marks.w, has_mass(body), bitcast<vec3f>(least.xyz), bitcast<vec3f>(most.xyz), vec3f(0.0));
    let key = vec2u(least.w, most.w);
    if !PERIODIC {
        look(own, key, k < in_cells);
        return;
    }
    let images = select(1u, 27u, own.has_mass);
    for (var image = 0u; image < images; image++) {
        if move_to_image(&own, image, bitcast<vec3f>(least.xyz), bitcast<vec3f>(most.xyz)) {
            look(own, key, k < in_cells);
        }
    }
}

@compute @workgroup_size(THREADS)
fn pair_up(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) local: u32) {
    kept_count = 0u;
    let k = thread_of(group, groups, local);
    if k < search.colliders {
        find_pairs(k);
    }
    // No barrier after loops that end differently: NVIDIA's driver does not survive it, and pairs were lost or found twice.
    let first = atomicAdd(&counts[0], kept_count);
    for (var k = 0u; k < kept_count; k++) {
        put_candidate(first + k, kept[k]);
    }
}
