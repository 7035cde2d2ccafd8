// Far spheres: discs of a few pixels at the depth of the centre.

struct FarVertex {
    @builtin(position) place: vec4f,
    /// Centre, in pixels.
    @location(0) @interpolate(flat) centre: vec2f,
    /// Radius, in pixels.
    @location(1) @interpolate(flat) radius: f32,
    @location(2) @interpolate(flat) point: vec3f,
    @location(3) @interpolate(flat) colour: vec3f,
}

struct FarSurface {
    @location(0) colour: vec4f,
    @builtin(sample_mask) covered: u32,
}

@vertex
fn far_vertex(@builtin(vertex_index) corner: u32, @location(0) slot: u32) -> FarVertex {
    let ball = ball(slot);
    let middle = frame.view_projection * vec4f(ball.xyz, 1.0);
    var vertex: FarVertex;
    // Sampled spheres have at least the least radius (`LEAST_RADIUS` in `cull.wgsl`).
    vertex.radius = max(ball.w / (middle.w * pixel_width()), 0.35);
    vertex.centre = (vec2f(0.5, -0.5) * middle.xy / middle.w + 0.5) * frame.viewport;
    let side = vec2f(vec2u(corner & 1u, corner >> 1u)) * 2.0 - 1.0;
    vertex.place = middle + vec4f(side * (vertex.radius + 1.0) * 2.0 / frame.viewport * middle.w, 0.0, 0.0);
    vertex.point = ball.xyz;
    let colour = sphere_colour(slot);
    vertex.colour = mix(colour, sphere_tone(slot, sphere_look(slot), colour), 0.5);
    return vertex;
}

@fragment
fn far_surface(vertex: FarVertex) -> FarSurface {
    var surface: FarSurface;
    for (var index = 0u; index < 4u; index++) {
        let away = vertex.place.xy + sample_place(index) - vertex.centre;
        if dot(away, away) <= vertex.radius * vertex.radius {
            surface.covered |= 1u << index;
        }
    }
    if surface.covered == 0u {
        discard;
    }
    let away = (vertex.place.xy - vertex.centre) / vertex.radius;
    let high = sqrt(max(1.0 - dot(away, away), 0.0));
    let normal = normalize(away.x * frame.right - away.y * frame.up - high * frame.forward);
    surface.colour = vec4f(lit(vertex.colour, vertex.point, normal, normalize(frame.eye - vertex.point), GLOSS), 1.0);
    return surface;
}
