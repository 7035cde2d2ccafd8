// Light that falls on a surface.

/// Light from all of the sky, more from above, and from the sun; `view` is the unit vector to the eye.
fn lit(colour: vec3f, point: vec3f, normal: vec3f, view: vec3f) -> vec3f {
    let sky = mix(vec3f(0.21, 0.20, 0.195), vec3f(0.40, 0.43, 0.47), 0.5 + 0.5 * normal.y);
    let towards = dot(normal, frame.light);
    var sun = 0.0;
    if towards > 0.0 {
        sun = 1.0;
    }
    let half_way = normalize(view + frame.light);
    let gloss = 0.08 * pow(max(dot(normal, half_way), 0.0), 40.0) * sun;
    let rim = 0.05 * pow(1.0 - max(dot(normal, view), 0.0), 3.0);
    return colour * (sky + max(towards, 0.0) * sun * vec3f(0.86, 0.83, 0.77)) + vec3f(gloss + rim);
}
