// What the sun sees: depth alone. A point nearer to the sun has less of it.

struct BallShadow {
    @builtin(position) place: vec4f,
    /// On the disc, from -1 to 1.
    @location(0) on_disc: vec2f,
    /// Depth of the centre, and of a radius.
    @location(1) @interpolate(flat) depth: vec2f,
}

/// What lies before the map's depths casts its shadow from their beginning.
fn in_map(point: vec3f) -> vec4f {
    let place = frame.light_projection * vec4f(point, 1.0);
    return vec4f(place.xy, clamp(place.z, 0.0, 1.0), 1.0);
}

/// A ball that is as wide as `radius`, but no higher than it is.
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
    // Those that stand for others are as large as the least.
    return ball_in_map(ball, max(ball.w, LEAST_SHADOW * frame.light_texel), corner);
}

@vertex
fn anchor_shadow_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) tether: u32) -> BallShadow {
    let ball = anchor_ball(tether);
    return ball_in_map(ball, ball.w, corner);
}

@fragment
fn sphere_shadow(vertex: BallShadow) -> @builtin(frag_depth) f32 {
    let high = 1.0 - dot(vertex.on_disc, vertex.on_disc);
    if high < 0.0 {
        discard;
    }
    return clamp(vertex.depth.x - vertex.depth.y * sqrt(high), 0.0, 1.0);
}

struct CapsuleShadow {
    @builtin(position) place: vec4f,
    @location(0) point: vec3f,
    @location(1) @interpolate(flat) end1: vec4f,
    @location(2) @interpolate(flat) line: vec3f,
}

@vertex
fn capsule_shadow_vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) rod: u32) -> CapsuleShadow {
    let at = frame.rods_at + 4u * rod;
    let end1 = ball(words[at]).xyz;
    let end2 = ball(words[at + 1u]).xyz;
    var vertex: CapsuleShadow;
    vertex.end1 = vec4f(end1, word_float(at + 2u));
    vertex.line = end2 - end1;
    vertex.point = capsule_corner(end1, end2, vertex.end1.w, 0.0, corner);
    vertex.place = in_map(vertex.point);
    return vertex;
}

@fragment
fn capsule_shadow(vertex: CapsuleShadow) -> @builtin(frag_depth) f32 {
    let found = passing(vertex.end1.xyz - vertex.point, vertex.line, -frame.light);
    let high = vertex.end1.w * vertex.end1.w - found.square;
    if high < 0.0 {
        discard;
    }
    return in_map(vertex.point - (found.on_ray - sqrt(high)) * frame.light).z;
}

@vertex
fn box_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> @builtin(position) vec4f {
    // Through glass the sun shines too.
    if opacities[number] < 0.5 {
        return NOWHERE;
    }
    return in_map(box_corner(index, number).point);
}

@vertex
fn polygon_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> @builtin(position) vec4f {
    return in_map(polygon_corner(index, number).point);
}

@vertex
fn spring_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> @builtin(position) vec4f {
    return coil_in_map(spring_corner(index, number));
}

@vertex
fn tether_shadow_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) number: u32) -> @builtin(position) vec4f {
    return coil_in_map(tether_corner(index, number));
}

fn coil_in_map(vertex: CoilVertex) -> vec4f {
    if all(vertex.place == NOWHERE) {
        return NOWHERE;
    }
    return in_map(vertex.point);
}
