// A sweep over one collision that shares bodies (docs/physics.md section 3.5).

fn is_shared(r: u32) -> bool {
    return impulse_at(r).tau == SHARED;
}

// How many neighbours a collision has in its record.
fn neighbours_of(r: u32) -> u32 {
    return collisions[ROWS * r + 2u].z;
}

// By how much the impulses of the collision itself and of its neighbours have changed its approach velocity; `most` is how many any has
// that this is worked out for together.
fn change_by_neighbours(r: u32, most: u32, sweeps: u32) -> f32 {
    let info = collisions[ROWS * r + 2u];
    var change = bitcast<f32>(info.y) * impulse_after(r, sweeps);
    for (var place = 0u; place < most; place += 2u) {
        if place < info.z {
            let pairs = collisions[ROWS * r + 4u + place / 2u];
            change = fma(bitcast<f32>(pairs.y), impulse_after(pairs.x, sweeps), change);
            if place + 1u < info.z {
                change = fma(bitcast<f32>(pairs.w), impulse_after(pairs.z, sweeps), change);
            }
        }
    }
    return change;
}

// The next impulse, with all that has changed the approach velocity.
fn put_sweep(r: u32, sweeps: u32, change: f32) {
    let impulse = impulse_at(r);
    let approach = bitcast<f32>(collisions[ROWS * r].w);
    let before = impulse_after(r, sweeps);
    let is_only = (collisions[ROWS * r + 2u].x & ONLY) != 0u;
    let size = select(SWEEP_SIZES[sweeps / 2u], 1.0, is_only) * impulse.inverse;
    // Told to be single operations: whoever sweeps, the same bits come of it.
    let after = max(0.0, fma(fma(1.0 + step.restitution, approach, change), size, before));
    let is_even = (sweeps & 1u) == 0u;
    let row = vec4f(select(after, before, is_even), select(before, after, is_even), impulse.inverse, impulse.tau);
    collisions[ROWS * r + 3u] = bitcast<vec4u>(row);
}
