// requires model/step.wgsl

// Where a sphere may be within some steps: in a ball about the place that it comes to in a part of the first one, if nothing
// happens. Forwards and backwards that ball need not reach as far as one about the sphere itself.

fn place_ahead(position: vec3f, velocity: vec4f) -> vec3f {
    let way = step.lead * step.dt * velocity.xyz;
    // What is faster than all measure has no such place.
    return select(position, position + way, (velocity.w > 0.0) & all(abs(way) < vec3f(1e30)));
}

// How much further it comes in each of so many steps where it goes on accelerating as in its last step of RK4: a dt^2 / 2. These were
// its velocities in stage states 3 and 4 then, v + dt a / 2 and v + dt a.
fn may_gain(third: vec3f, fourth: vec3f, steps: f32) -> f32 {
    let gain = steps * step.dt * length(fourth - third);
    // What is beyond all measure tells nothing.
    return select(0.0, gain, gain < 1e30);
}

// How far it may come from there, with a little room for what accelerates, the more the longer it may do so.
fn may_travel(velocity: vec4f, radius: f32, steps: f32) -> f32 {
    return (steps - step.lead) * 1.05 * length(velocity.xyz) * step.dt + (0.05 * steps - 0.03) * radius;
}
