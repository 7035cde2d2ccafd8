// requires model/step.wgsl

// Periodic boundaries (docs/physics.md section 2.14).

// Period along each axis, 0 where the scene is not periodic.
fn periods() -> vec3f {
    return vec3f(step.period_x, step.period_y, step.period_z);
}

// Number of whole periods in a vector: those that its nearest image lacks.
fn whole_periods(d: vec3f) -> vec3f {
    let length = periods();
    return select(vec3f(0.0), round(d / max(length, vec3f(TINY))), length > vec3f(0.0));
}

// The nearest image of a vector, rounded.
fn nearest_image(d: vec3f) -> vec3f {
    if PERIODIC {
        return d - whole_periods(d) * periods();
    }
    return d;
}
