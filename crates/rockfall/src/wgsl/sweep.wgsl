// A sweep over one collision that shares bodies (docs/physics.md section 3.5).

fn is_shared(r: u32) -> bool {
    return impulse_at(r).tau == SHARED;
}

// By how much the impulses of the collision itself and of its neighbours have changed its approach velocity. All have as many rounds:
// where there are no more neighbours it is its own with no coupling.
fn change_by_neighbours(r: u32, sweeps: u32) -> f32 {
    let own = bitcast<f32>(collisions[ROWS * r + 2u].y);
    var change = own * impulse_after(r, sweeps);
    for (var row = 4u; row < ROWS; row++) {
        let pairs = collisions[ROWS * r + row];
        change = fma(bitcast<f32>(pairs.y), impulse_after(pairs.x, sweeps), change);
        change = fma(bitcast<f32>(pairs.w), impulse_after(pairs.z, sweeps), change);
    }
    return change;
}

// The next impulse, with all that has changed the approach velocity.
fn put_sweep(r: u32, sweeps: u32, change: f32) {
    let impulse = impulse_at(r);
    let approach = bitcast<f32>(collisions[ROWS * r].w);
    let before = impulse_after(r, sweeps);
    // Told to be single operations: whoever sweeps, the same bits come of it.
    let after = max(0.0, fma(fma(1.0 + step.restitution, approach, change), impulse.inverse, before));
    let is_even = (sweeps & 1u) == 0u;
    let row = vec4f(select(after, before, is_even), select(before, after, is_even), impulse.inverse, impulse.tau);
    collisions[ROWS * r + 3u] = bitcast<vec4u>(row);
}
