// requires model/objects.wgsl model/step.wgsl physics/period.wgsl physics/smooth.wgsl physics/walls.wgsl

// Bounds for the motion of walls within some steps (docs/physics section 2.12).

// A moving box or polygon: its bounds, and the greatest speed and acceleration of its vertices.
struct Reach {
    least: vec3f,
    most: vec3f,
    speed: f32,
    acceleration: f32,
}

fn reach_of(id: u32) -> Reach {
    let wall = wall_of(id);
    let zero = vec3f(0.0);
    var box: Cuboid;
    var is_facet = false;
    var is_smooth = false;
    var smooth_bounds = SmoothBounds(zero, zero);
    let index = id - step.spheres - step.rods;
    if index < step.boxes {
        box = cuboid(index);
    } else {
        let face = polygon(index - step.boxes);
        box = Cuboid(face.corner, face.left, face.right, zero);
        is_facet = is_triangle(face);
        is_smooth = is_plane(face) || is_round(face);
        if is_smooth {
            smooth_bounds = bounds_of_smooth(face);
        }
    }
    let rate = length(wall.spin);
    let farthest = length(box.i) + length(box.j) + length(box.k);
    var least = min(box.i, zero) + min(box.j, zero) + min(box.k, zero);
    var most = max(box.i, zero) + max(box.j, zero) + max(box.k, zero);
    if is_facet {
        least = min(min(box.i, box.j), zero);
        most = max(max(box.i, box.j), zero);
    }
    if is_smooth {
        least = smooth_bounds.least;
        most = smooth_bounds.most;
    }
    return Reach(
        box.corner + least,
        box.corner + most,
        length(wall.velocity) + rate * farthest,
        length(wall.acceleration) + rate * rate * farthest,
    );
}

// The radius of most bodies, which the margins of walls are compared with.
fn size_of_most() -> f32 {
    return 0.4 * step.cell_size;
}

// Bound for the way of the vertices within some steps. The last term leaves room for changes of the acceleration.
fn way_of_wall(reach: Reach, steps: f32) -> f32 {
    let time = steps * step.dt;
    return (1.05 * reach.speed + 0.5 * reach.acceleration * time) * time + 0.05 * steps * size_of_most();
}

// Margin of the AABB. `repeat` is added where a step is repeated, in units of the size of most bodies.
fn margin_of_wall(reach: Reach, repeat: f32) -> f32 {
    var travel = way_of_wall(reach, max(1.0, step.lookahead));
    if CONTINUOUS {
        // The path of the last step, for contacts that begin and end within it.
        travel = max(travel, way_of_wall(reach, 1.0));
    }
    return travel + (max(0.0, step.margin_scale - 1.0) * 0.02 + repeat) * size_of_most();
}

// How far a wall may be outside its AABB after some steps, in units of 0.02 of the size of most bodies; 0 when it is inside.
fn escape_of_wall(reach: Reach, aabb: Aabb, steps: f32) -> f32 {
    var far = max(abs(aabb.min), abs(aabb.max));
    var back = vec3f(0.0);
    if PERIODIC {
        far = max(far, max(abs(reach.least), abs(reach.most)));
        let apart = 0.5 * (reach.least + reach.most) - (0.5 * aabb.min + 0.5 * aabb.max);
        back = nearest_image(apart) - apart;
    }
    let beyond = max(aabb.min - (reach.least + back), reach.most + back - aabb.max);
    var out = max(max(beyond.x, beyond.y), beyond.z) + ROUNDING_SLACK * max(max(far.x, far.y), far.z);
    if steps > 0.0 {
        out += way_of_wall(reach, steps);
    }
    return select(clamp(out / (0.02 * size_of_most()), 1e-3, 1e30), 0.0, out <= 0.0);
}
