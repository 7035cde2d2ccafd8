// The shadow map: depths seen from the sun. Points nearer to the sun have smaller depths.

struct BallShadow {
    @builtin(position) place: vec4f,
    /// Position on the disc, from -1 to 1.
    @location(0) on_disc: vec2f,
    /// Depth of the centre, and the difference of depth that corresponds to a radius.
    @location(1) @interpolate(flat) depth: vec2f,
    @location(2) @interpolate(flat) look: u32,
}

/// Transforms a point to the shadow map. Its depth is clamped, so that a body between the sun and the map still casts a shadow.
fn in_map(point: vec3f) -> vec4f {
    let place = frame.light_projection * vec4f(point, 1.0);
    return vec4f(place.xy, clamp(place.z, 0.0, 1.0), 1.0);
}

/// Returns a corner of the quad of a ball. Its disc has radius `radius`, its depth is that of the ball's own radius.
fn ball_in_map(ball: vec4f, radius: f32, corner: u32) -> BallShadow {
    var vertex: BallShadow;
    vertex.on_disc = vec2f(vec2u(corner & 1u, corner >> 1u)) * 2.0 - 1.0;
    let disc = vertex.on_disc.x * frame.light_right + vertex.on_disc.y * frame.light_up;
    let place = frame.light_projection * vec4f(ball.xyz + radius * disc, 1.0);
    vertex.depth = vec2f(place.z, ball.w * frame.light_depth);
    vertex.place = vec4f(place.xy, 0.5, 1.0);
    return vertex;
}

@vertex
fn sphere_shadow_vertex(@builtin(vertex_index) corner: u32, @location(0) slot: u32) -> BallShadow {
    let ball = ball(slot);
    // Sampled spheres have at least the least radius.
    var vertex = ball_in_map(ball, max(ball.w, LEAST_SHADOW * frame.light_texel), corner);
    vertex.look = sphere_look(slot);
    return vertex;
}

@vertex
fn anchor_shadow_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) tether: u32) -> BallShadow {
    let ball = anchor_ball(tether);
    return ball_in_map(ball, ball.w, corner);
}

@fragment
fn sphere_shadow(vertex: BallShadow) -> @builtin(frag_depth) f32 {
    let high = 1.0 - dot(vertex.on_disc, vertex.on_disc);
    if high < 0.0 || is_lit_through(vertex.look, vertex.place) {
        discard;
    }
    return clamp(vertex.depth.x - vertex.depth.y * sqrt(high), 0.0, 1.0);
}

struct CapsuleShadow {
    @builtin(position) place: vec4f,
    @location(0) point: vec3f,
    @location(1) @interpolate(flat) end1: vec4f,
    @location(2) @interpolate(flat) line: vec3f,
    @location(3) @interpolate(flat) look: u32,
}

@vertex
fn capsule_shadow_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) rod: u32) -> CapsuleShadow {
    let at = frame.rods_at + 4u * rod;
    let end1 = ball(topology[at]).xyz;
    let end2 = ball_beside(topology[at + 1u], end1).xyz;
    var vertex: CapsuleShadow;
    vertex.end1 = vec4f(end1, topology_float(at + 2u));
    vertex.line = end2 - end1;
    vertex.point = capsule_corner(end1, end2, vertex.end1.w, 0.0, corner);
    vertex.place = in_map(vertex.point);
    vertex.look = body_look(frame.spheres + rod);
    return vertex;
}

@fragment
fn capsule_shadow(vertex: CapsuleShadow) -> @builtin(frag_depth) f32 {
    let found = nearest_points(vertex.end1.xyz - vertex.point, vertex.line, -frame.light);
    let high = vertex.end1.w * vertex.end1.w - found.square;
    if high < 0.0 || is_lit_through(vertex.look, vertex.place) {
        discard;
    }
    return in_map(vertex.point - (found.on_ray - sqrt(high)) * frame.light).z;
}

struct FlatShadow {
    @builtin(position) place: vec4f,
    /// Not clamped yet: clamped depths of corners far outside the map would tilt the whole face.
    @location(0) depth: f32,
    @location(1) @interpolate(flat) look: u32,
}

fn flat_in_map(point: vec3f, look: u32) -> FlatShadow {
    let place = frame.light_projection * vec4f(point, 1.0);
    return FlatShadow(vec4f(place.xy, 0.5, 1.0), place.z, look);
}

@vertex
fn box_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatShadow {
    // Without this, the shadow of a wall that is not there would fall on the bodies.
    if drawn[number] == 0u {
        return FlatShadow(NOWHERE, 1.0, 0u);
    }
    // Faces towards the sun would shade themselves where they are far larger than the map, by rounding. The other faces of a box
    // cast the same shadow.
    let corner = box_corner(index, number);
    if dot(corner.normal, frame.light) > 0.0 {
        return FlatShadow(NOWHERE, 1.0, 0u);
    }
    return flat_in_map(corner.point, corner.look);
}

@vertex
fn block_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) slot: u32) -> FlatShadow {
    if index >= block_corners(slot) {
        return FlatShadow(NOWHERE, 1.0, 0u);
    }
    let corner = block_corner(index, slot);
    if dot(corner.normal, frame.light) > 0.0 {
        return FlatShadow(NOWHERE, 1.0, 0u);
    }
    return flat_in_map(corner.point, corner.look);
}

@fragment
fn box_shadow(vertex: FlatShadow) -> @builtin(frag_depth) f32 {
    if is_lit_through(vertex.look, vertex.place) {
        discard;
    }
    return clamp(vertex.depth, 0.0, 1.0);
}

@vertex
fn polygon_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> FlatShadow {
    let vertex = polygon_corner(index, number);
    if polygon_drawn(number) == 0u || is_hollow(number) || all(vertex.place == NOWHERE) {
        return FlatShadow(NOWHERE, 1.0, 0u);
    }
    return flat_in_map(vertex.point, polygon_look(number));
}

@fragment
fn polygon_shadow(vertex: FlatShadow) -> @builtin(frag_depth) f32 {
    if is_lit_through(vertex.look, vertex.place) {
        discard;
    }
    return clamp(vertex.depth, 0.0, 1.0);
}

@vertex
fn spring_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> @builtin(position) vec4f {
    return coil_in_map(spring_corner(index, number, vec4f(frame.light, 0.0)));
}

@vertex
fn tether_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> @builtin(position) vec4f {
    return coil_in_map(tether_corner(index, number, vec4f(frame.light, 0.0)));
}

@vertex
fn string_shadow_vertex(
    @builtin(vertex_index) corner: u32,
    @location(0) start: vec3f,
    @location(1) end: vec3f,
) -> @builtin(position) vec4f {
    let vertex = string_corner(corner, start, end, vec4f(frame.light, 0.0));
    if all(vertex.place == NOWHERE) {
        return NOWHERE;
    }
    return in_map(vertex.point);
}

fn coil_in_map(vertex: CoilVertex) -> vec4f {
    if all(vertex.place == NOWHERE) {
        return NOWHERE;
    }
    return in_map(vertex.point);
}
