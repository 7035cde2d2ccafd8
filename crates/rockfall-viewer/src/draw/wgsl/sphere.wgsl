// Spheres: ray-cast in a quad that covers their outline.

struct SphereVertex {
    @builtin(position) place: vec4f,
    @location(0) @interpolate(flat) ball: vec4f,
    @location(1) @interpolate(flat) orientation: vec4f,
    @location(2) @interpolate(flat) colour: vec3f,
    @location(3) @interpolate(flat) second: vec3f,
    @location(4) @interpolate(flat) look: u32,
    @location(5) @interpolate(flat) offset: vec3f,
}

/// Returns a corner of a quad that is perpendicular to the line of sight and contains the outline of a sphere: the cone of
/// tangents from the eye intersects the plane through the centre in a circle of radius r d / sqrt(d² - r²).
fn outline_corner(ball: vec4f, corner: u32) -> vec4f {
    let offset = ball.xyz - frame.eye;
    let distance = length(offset);
    if distance <= ball.w * 1.0001 {
        return NOWHERE;
    }
    let reach = ball.w * distance / sqrt(distance * distance - ball.w * ball.w) + distance * pixel_width();
    let axis = offset / distance;
    let across = normalize(cross(axis, frame.up));
    let side = vec2f(vec2u(corner & 1u, corner >> 1u)) * 2.0 - 1.0;
    let point = ball.xyz + reach * (side.x * across + side.y * cross(across, axis));
    return frame.view_projection * vec4f(point, 1.0);
}

@vertex
fn sphere_vertex(@builtin(vertex_index) corner: u32, @location(0) slot: u32) -> SphereVertex {
    return sphere_corner(corner, slot, false);
}

/// Spheres of glass are drawn after all other bodies.
@vertex
fn glass_sphere_vertex(@builtin(vertex_index) corner: u32, @location(0) slot: u32) -> SphereVertex {
    return sphere_corner(corner, slot, true);
}

fn sphere_corner(corner: u32, slot: u32, of_glass: bool) -> SphereVertex {
    var vertex: SphereVertex;
    vertex.look = sphere_look(slot);
    if (vertex.look == LOOK_GLASS) != of_glass {
        vertex.place = NOWHERE;
        return vertex;
    }
    vertex.ball = ball(slot);
    vertex.place = outline_corner(vertex.ball, corner);
    vertex.orientation = orientation(slot);
    vertex.colour = sphere_colour(slot);
    vertex.second = sphere_tone(slot, vertex.look, vertex.colour);
    vertex.offset = pattern_offset(insertion_index(slot));
    return vertex;
}

/// The anchor point of a tether, as a small ball.
fn anchor_ball(tether: u32) -> vec4f {
    let at = frame.tethers_at + 7u * tether;
    return vec4f(topology_vector(at + 1u), 0.22 * state[topology[at]].w);
}

@vertex
fn anchor_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) tether: u32) -> SphereVertex {
    var vertex: SphereVertex;
    vertex.ball = anchor_ball(tether);
    vertex.place = outline_corner(vertex.ball, corner);
    vertex.orientation = vec4f(0.0, 0.0, 0.0, 1.0);
    vertex.colour = tether_colour(tether);
    vertex.second = vertex.colour;
    return vertex;
}

@fragment
fn sphere_surface(vertex: SphereVertex) -> Surface {
    let ball = vertex.ball;
    let offset = ball.xyz - frame.eye;
    let square = ball.w * ball.w;
    var surface: Surface;
    for (var index = 0u; index < 4u; index++) {
        let ray = normalize(view_ray(vertex.place.xy + sample_place(index)));
        if approach(offset, ray).x <= square {
            surface.covered |= 1u << index;
        }
    }
    if surface.covered == 0u {
        discard;
    }
    let ray = normalize(view_ray(vertex.place.xy));
    let found = approach(offset, ray);
    // If only some samples hit, the nearest point of the ray to the centre stands for the surface.
    let distance = found.y - sqrt(max(square - found.x, 0.0));
    let point = frame.eye + distance * ray;
    let normal = normalize(point - ball.xyz);
    let width = distance * pixel_width() / (ball.w * max(-dot(normal, ray), 0.15));
    if vertex.look == LOOK_GLASS {
        surface.colour = glass(vertex.colour, normal, -ray, glass_rim(normal, ray));
        surface.depth = depth_at(point);
        return surface;
    }
    let local = to_body(vertex.orientation, normal);
    let tone = beach_ball(local, width);
    let shade = shade_of(vertex.look, 1.25 * local + vertex.offset, 1.25 * width);
    let colour = mix(vertex.colour, vertex.second, tone) * shade;
    surface.colour = vec4f(lit(colour, point, normal, -ray, gloss_of(vertex.look)), 1.0);
    surface.depth = depth_at(point);
    return surface;
}
