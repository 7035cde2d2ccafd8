// requires model/step.wgsl physics/product.wgsl

// Periodic boundaries, and the shear of their images (docs/physics section 2.14).

// Period along each axis, 0 where the scene is not periodic.
fn periods() -> vec3f {
    return vec3f(step.period_x, step.period_y, step.period_z);
}

// Unit vector along an axis: 0 for x, 1 for y, 2 for z.
fn along(axis: u32) -> vec3f {
    return select(vec3f(0.0), vec3f(1.0), vec3u(0u, 1u, 2u) == vec3u(axis));
}

// Displacement of the box above in a sheared scene at the time of the pass, in units of 2^-64 periods: the low and the high word.
fn shear_phase() -> vec2u {
    let halves = 2u * (status.steps - step.pose_step) + min(2u, (pass_.index % EARLY + 1u) / 2u);
    let change = step.shear_change_low * halves;
    let low = step.shear_low + change;
    let high = step.shear_high + step.shear_change_high * halves + upper_product(step.shear_change_low, halves);
    return vec2u(low, high + u32(low < change));
}

// That displacement in units, rounded.
fn slide() -> vec3f {
    return (2.3283064365386963e-10 * f32(bitcast<i32>(shear_phase().y))) * (periods() * along(step.shear_axes >> 2u));
}

// Periods in a vector along the gradient of a shear.
fn boxes_in(d: vec3f) -> f32 {
    let gradient = along(step.shear_axes & 3u);
    return dot(d, gradient) / max(dot(periods(), gradient), TINY);
}

// The vector before some boxes slid.
fn before_slide(d: vec3f, boxes: f32) -> vec3f {
    if SHEARED {
        return d - boxes * slide();
    }
    return d;
}

// Number of whole periods in a vector: those that its nearest image lacks.
fn whole_periods(d: vec3f) -> vec3f {
    let length = periods();
    let rest = before_slide(d, round(boxes_in(d)));
    return select(vec3f(0.0), round(rest / max(length, vec3f(TINY))), length > vec3f(0.0));
}

// The displacement by a number of periods along each axis, rounded.
fn way_of(count: vec3f) -> vec3f {
    return before_slide(count * periods(), -dot(count, along(step.shear_axes & 3u)));
}

// The nearest image of a vector, rounded.
fn nearest_image(d: vec3f) -> vec3f {
    if PERIODIC {
        return d - way_of(whole_periods(d));
    }
    return d;
}

// The velocity of an image which is a number of boxes below its body, relative to the body.
fn velocity_below(boxes: f32) -> vec3f {
    return -(boxes * step.shear_speed) * along(step.shear_axes >> 2u);
}

// How far the images of a sheared scene slide in a time step.
fn slide_in_step() -> f32 {
    if SHEARED {
        return abs(step.shear_speed) * step.dt;
    }
    return 0.0;
}
