// When the lists of an earlier step are no longer enough.

// Whether a sphere may be outside its AABB before the next step is done, at the velocity at hand.
fn may_leave(sphere: u32, centre: vec4f, velocity: vec4f) -> bool {
    if velocity.w <= 0.0 {
        return false;
    }
    let reach = vec3f(centre.w + 1.05 * length(velocity.xyz) * step.dt + 0.02 * centre.w);
    return any(centre.xyz - reach < aabbs[sphere].min) | any(centre.xyz + reach > aabbs[sphere].max);
}

// A sphere that may leave its AABB asks for new lists.
fn ask_for_lists(sphere: u32, centre: vec4f, velocity: vec4f) {
    if may_leave(sphere, centre, velocity) {
        atomicStore(&status.rebuild, 1u);
    }
}
