// requires model/step.wgsl

// Bounds for the motion of a sphere within some steps. The bound is a ball. Its centre is ahead of the sphere: where the sphere
// will be after `lead` steps at its present velocity. A ball around that point can be smaller than one around the present
// position.

const MOST_OF_REPEAT: f32 = 10.0;

// Position of a sphere after `lead` steps at constant velocity. `velocity.w` is the inverse mass. The result is `position` for
// a fixed sphere, and when the displacement is 1e30 or larger.
fn position_ahead(position: vec3f, velocity: vec4f) -> vec3f {
    let way = step.lead * step.dt * velocity.xyz;
    return select(position, position + way, (velocity.w > 0.0) & all(abs(way) < vec3f(1e30)));
}

// Distance from the point that `position_ahead` returns to the position of a sphere before the last step, taken as straight. Where
// contacts that begin and end within a step are handled, lists hold the pairs of this path too.
fn trail(velocity: vec4f, unit: f32) -> f32 {
    return 1.001 * (step.lead + 1.0) * step.dt * length(velocity.xyz) + 0.02 * unit;
}

// Bound for the distance of a sphere, within `steps` steps, from the point that `position_ahead` returns. It includes some room
// for acceleration, which grows with the number of steps.
fn travel_bound(velocity: vec4f, unit: f32, steps: f32) -> f32 {
    return (steps - step.lead) * 1.05 * length(velocity.xyz) * step.dt + (0.05 * steps - 0.03) * unit;
}
