// requires model/objects.wgsl model/one_state.wgsl model/step.wgsl physics/period.wgsl physics/smooth.wgsl physics/travel.wgsl
// requires physics/wall_bounds.wgsl physics/walls.wgsl step/broad_phase/due.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read> topology: array<u32>;
// Two rows per AABB, with the layout of the struct Aabb. Writing whole rows takes half as long as writing the fields one by
// one.
@group(0) @binding(4) var<storage, read_write> aabbs: array<vec4u>;
@group(0) @binding(5) var<storage, read> status: Status;

struct Hull {
    min: vec3f,
    max: vec3f,
}

// Where lists may be rebuilt in every step, a step that a body left its AABB in is repeated with larger AABBs, in units of the
// radius.
fn repeat_margin() -> f32 {
    let is_repeated = has_only_escaped(status.rejected) & (step.list_interval == 1.0);
    return select(0.0, 0.02 * min(1.25 * bitcast<f32>(status.escape_ratio) + 1.0, MOST_OF_REPEAT), is_repeated);
}

// Returns the distance that a sphere may move before its list is rebuilt. `unit` is its radius.
fn margin(velocity: vec4f, unit: f32) -> f32 {
    let spare = ((step.margin_scale - 1.0) * 0.02 + repeat_margin()) * unit;
    var travel = travel_bound(velocity, unit, step.lookahead);
    if CONTINUOUS {
        travel = max(travel, trail(velocity, unit));
    }
    // What the images of two bodies slide in a step, and as much again where a face of the box is between a sphere and the centre of its
    // AABB.
    travel += 3.0 * slide_in_step();
    return select(0.0, travel + spare, velocity.w > 0.0);
}

// The velocity of a sphere; in a sheared scene, that of its image in the box.
fn image_velocity(centre: vec3f, velocity: vec4f) -> vec4f {
    if SHEARED {
        let boxes = floor(boxes_in(centre - vec3f(step.from_x, step.from_y, step.from_z)));
        return velocity + vec4f(velocity_below(boxes), 0.0);
    }
    return velocity;
}

// Returns the AABB of a ball of this radius about the centre of a sphere. The radius is that of the sphere itself or of a rod
// that ends in it.
fn ball_hull(sphere: u32, radius: f32) -> Hull {
    let centre = state[position_at(sphere)];
    let velocity = image_velocity(centre.xyz, state[velocity_at(sphere)]);
    let reach = vec3f(radius + step.neck * radius + margin(velocity, centre.w));
    let middle = position_ahead(centre.xyz, velocity);
    return Hull(middle - reach, middle + reach);
}

fn hull_of(id: u32) -> Hull {
    if id < step.spheres {
        return ball_hull(id, state[position_at(id)].w);
    }
    var rest = id - step.spheres;
    if rest < step.rods {
        let ends = rod_ends(rest);
        let first = ball_hull(ends.x, rod_radius(rest));
        let second = ball_hull(ends.y, rod_radius(rest));
        return Hull(min(first.min, second.min), max(first.max, second.max));
    }
    // The hull of all corners: the negative components of an edge lower the minimum, the positive ones raise the maximum.
    let zero = vec3f(0.0);
    rest -= step.rods;
    if rest < step.boxes {
        let box = cuboid(rest);
        return Hull(
            box.corner + min(box.i, zero) + min(box.j, zero) + min(box.k, zero),
            box.corner + max(box.i, zero) + max(box.j, zero) + max(box.k, zero),
        );
    }
    let face = polygon(rest - step.boxes);
    if is_plane(face) || is_round(face) {
        let bounds = bounds_of_smooth(face);
        return Hull(face.corner + bounds.least, face.corner + bounds.most);
    }
    if is_triangle(face) {
        return Hull(
            face.corner + min(min(face.left, face.right), zero),
            face.corner + max(max(face.left, face.right), zero),
        );
    }
    return Hull(
        face.corner + min(face.left, zero) + min(face.right, zero),
        face.corner + max(face.left, zero) + max(face.right, zero),
    );
}

// There is room for rounding: twice as much in periodic scenes, where AABBs are compared with images.
fn grown(hull: Hull) -> Hull {
    let far = max(abs(hull.min), abs(hull.max));
    let room = vec3f(select(1.0, 2.0, PERIODIC) * ROUNDING_MARGIN * max(max(far.x, far.y), far.z));
    return Hull(hull.min - room, hull.max + room);
}

// The hull of a plane has no ends, except along an axis of the coordinates that is its normal, if it does not move.
fn unbounded(id: u32, hull: Hull) -> Hull {
    let polygons = step.spheres + step.rods + step.boxes;
    if !SMOOTH | (id < polygons) {
        return hull;
    }
    let face = polygon(id - polygons);
    if !is_plane(face) {
        return hull;
    }
    let differs = cross(face.left, face.right) != vec3f(0.0);
    var is_open = vec3<bool>(true);
    if dot(select(vec3f(0.0), vec3f(1.0), differs), vec3f(1.0)) == 1.0 {
        is_open = !differs;
    }
    if WALLS {
        if body_of(id) != 0u {
            is_open = vec3<bool>(true);
        }
    }
    return Hull(select(hull.min, vec3f(-UNBOUNDED), is_open), select(hull.max, vec3f(UNBOUNDED), is_open));
}

// The image of a hull whose centre is in the box of a periodic scene.
fn brought_back(hull: Hull) -> Hull {
    let length = periods();
    let centre = 0.5 * hull.min + 0.5 * hull.max;
    let above = centre - vec3f(step.from_x, step.from_y, step.from_z);
    let turns = floor(before_slide(above, floor(boxes_in(above))) / max(length, vec3f(TINY)));
    let way = way_of(select(vec3f(0.0), turns, length > vec3f(0.0)));
    return Hull(hull.min - way, hull.max - way);
}

@compute @workgroup_size(256)
fn update_aabbs(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let id = wide_thread(group, groups, local);
    if !builds_lists(REBUILD_REQUESTED) | (id >= objects()) {
        return;
    }
    var hull = hull_of(id);
    if WALLS {
        if id >= step.spheres + step.rods {
            let margin = select(0.0, margin_of_wall(reach_of(id), repeat_margin()), body_of(id) != 0u);
            hull = Hull(hull.min - margin, hull.max + margin);
        }
    }
    hull = unbounded(id, grown(hull));
    if PERIODIC {
        hull = brought_back(hull);
    }
    aabbs[2u * id] = vec4u(bitcast<vec3u>(hull.min), id);
    aabbs[2u * id + 1u] = vec4u(bitcast<vec3u>(hull.max), topology[step.tags_at + id]);
}
