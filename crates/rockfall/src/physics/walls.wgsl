// requires model/objects.wgsl model/step.wgsl physics/geometry.wgsl physics/period.wgsl

// Boxes and polygons that move on a prescribed path (docs/physics section 2.12).

// First word of the motion of a box or polygon: `wall` counts boxes and then polygons.
fn wall_record(wall: u32) -> u32 {
    return step.walls_at + wall * WALL_WORDS;
}

// Number of the body of a box or polygon, 0 for the world.
fn body_of(id: u32) -> u32 {
    return topology[wall_record(id - step.spheres - step.rods) + 3u];
}

// The motion of a box or polygon: its corner, the velocity and acceleration there, its angular velocity, and the velocity of its surface.
struct Wall {
    corner: vec3f,
    velocity: vec3f,
    acceleration: vec3f,
    spin: vec3f,
    surface: vec3f,
    // From the corner to the middle of the shape, in periodic scenes.
    to_middle: vec3f,
}

// The motion of a box or polygon, which is 0 for one that never moves. Only in scenes with moving walls.
fn wall_of(id: u32) -> Wall {
    let wall = id - step.spheres - step.rods;
    let record = wall_record(wall);
    let of_polygon = step.polygons_at + (wall - step.boxes) * POLYGON_WORDS;
    let corner = vector_at(select(of_polygon, step.boxes_at + wall * BOX_WORDS, wall < step.boxes));
    var to_middle = vec3f(0.0);
    if PERIODIC {
        if wall < step.boxes {
            to_middle = middle_of_box(cuboid(wall));
        } else {
            to_middle = middle_of_polygon(polygon(wall - step.boxes));
        }
    }
    return Wall(corner, vector_at(record), vector_at(record + 8u), vector_at(record + 4u), vector_at(record + 12u), to_middle);
}

// From the corner of a wall to a point, as seen from the nearest image of the wall.
fn lever_on_wall(wall: Wall, point: vec3f) -> vec3f {
    if PERIODIC {
        return nearest_image(point - wall.corner - wall.to_middle) + wall.to_middle;
    }
    return point - wall.corner;
}

// Velocity of a wall at a point.
fn velocity_of_wall(wall: Wall, point: vec3f) -> vec3f {
    return wall.velocity + cross(wall.spin, lever_on_wall(wall, point));
}

// Velocity of the surface of a wall at a contact point. A conveyor has a part of its own in the tangent plane.
fn velocity_of_surface(wall: Wall, point: vec3f, n: vec3f) -> vec3f {
    return velocity_of_wall(wall, point) + (wall.surface - dot(wall.surface, n) * n);
}

// Acceleration of a wall at a point.
fn acceleration_of_wall(wall: Wall, point: vec3f) -> vec3f {
    return wall.acceleration + cross(wall.spin, cross(wall.spin, lever_on_wall(wall, point)));
}

// A vector after a turn by a small angle, at its old length.
fn turned_by(v: vec3f, angle: vec3f) -> vec3f {
    let moved = v + cross(angle, v);
    let squared = dot(moved, moved);
    return select(v, moved * sqrt(dot(v, v) / squared), (squared > 0.0) & any(angle != vec3f(0.0)));
}
