// requires model/step.wgsl step/collisions/records.wgsl

// A sweep, for one collision that shares bodies (docs/physics section 3.7).

fn is_shared(r: u32) -> bool {
    return impulse_at(r).tau == SHARED;
}

// The number of neighbours in the record of a collision.
fn neighbours_of(r: u32) -> u32 {
    return collisions[row_at(r, 2u)].z;
}

// Adds the change of the approach velocity by two neighbours, those at `place` and `place + 1` in the record.
fn change_by_two(change: f32, r: u32, place: u32, count: u32, sweeps: u32) -> f32 {
    let pairs = collisions[row_at(r, 4u + place / 2u)];
    // A missing neighbour is replaced by the collision itself with coupling 0, so that no load depends on a branch.
    let is_one = place < count;
    let is_two = place + 1u < count;
    let one = select(0.0, bitcast<f32>(pairs.y), is_one);
    let two = select(0.0, bitcast<f32>(pairs.w), is_two);
    let after_one = impulse_after(select(r, pairs.x, is_one), sweeps);
    let after_two = impulse_after(select(r, pairs.z, is_two), sweeps);
    return fma(two, after_two, fma(one, after_one, change));
}

// The change of the approach velocity of a collision by its own impulse and those of its neighbours. `most` is the largest
// number of neighbours among the collisions that the caller processes together.
fn change_by_neighbours(r: u32, most: u32, sweeps: u32) -> f32 {
    let info = collisions[row_at(r, 2u)];
    var change = bitcast<f32>(info.y) * impulse_after(r, sweeps);
    change = change_by_two(change, r, 0u, info.z, sweeps);
    change = change_by_two(change, r, 2u, info.z, sweeps);
    for (var place = 4u; place < most; place += 2u) {
        change = change_by_two(change, r, place, info.z, sweeps);
    }
    return change;
}

// Two collisions are at one place, for the sweeps, if 1 - G_kl^2 / (G_kk G_ll) is at most this. The closed form would divide by
// it.
const ONE_PLACE: f32 = 1e-3;

// The only neighbour of a collision that is left to the sweeps, if there is just one and its changes are not gathered;
// otherwise NONE.
fn only_neighbour_of(r: u32) -> u32 {
    let info = collisions[row_at(r, 2u)];
    let has_one = ((info.x & (GATHERED_A | GATHERED_B)) == 0u) & (info.z == 1u) & is_shared(r);
    return select(NONE, collisions[row_at(r, 4u)].x, has_one);
}

// What the impulses have to take from the approach velocity of a collision, where its own one is not 0.
fn wanted_of(r: u32) -> f32 {
    let restitution = select(step.restitution, bitcast<f32>(collisions[row_at(r, 2u)].w), MATERIALS);
    return (1.0 + restitution) * bitcast<f32>(collisions[row_at(r, 0u)].w);
}

// The impulse of a collision that has one neighbour, which has no other one either. `swept` is the impulse by the sweeps, which
// holds where both are at one place.
fn pair_impulse(r: u32, neighbour: u32, swept: f32) -> f32 {
    let own = -bitcast<f32>(collisions[row_at(r, 2u)].y);
    let their = -bitcast<f32>(collisions[row_at(neighbour, 2u)].y);
    let by = -bitcast<f32>(collisions[row_at(r, 4u)].y);
    let wanted = wanted_of(r);
    let their_wanted = wanted_of(neighbour);
    let margin = fma(own, their, -(by * by));
    if margin <= ONE_PLACE * own * their {
        return swept;
    }
    if their * wanted <= by * their_wanted {
        // The other impulse alone takes enough.
        return 0.0;
    }
    if own * their_wanted <= by * wanted {
        return wanted / own;
    }
    return fma(their, wanted, -(by * their_wanted)) / margin;
}

// Stores the next impulse. `change` is the change of the approach velocity by all impulses.
fn put_sweep(r: u32, sweeps: u32, change: f32) {
    let impulse = impulse_at(r);
    let approach = bitcast<f32>(collisions[row_at(r, 0u)].w);
    let before = impulse_after(r, sweeps);
    let is_only = (collisions[row_at(r, 2u)].x & ONLY) != 0u;
    let size = select(SWEEP_SIZES[sweeps / 2u], 1.0, is_only) * impulse.inverse;
    // The operations are explicit `fma`s, so that the results of all kernels that sweep are bitwise identical.
    let restitution = select(step.restitution, bitcast<f32>(collisions[row_at(r, 2u)].w), MATERIALS);
    var after = max(0.0, fma(fma(1.0 + restitution, approach, change), size, before));
    let neighbour = only_neighbour_of(r);
    if neighbour != NONE {
        if only_neighbour_of(neighbour) == r {
            after = pair_impulse(r, neighbour, after);
        }
    }
    let is_even = (sweeps & 1u) == 0u;
    let row = vec4f(select(after, before, is_even), select(before, after, is_even), impulse.inverse, impulse.tau);
    collisions[row_at(r, 3u)] = bitcast<vec4u>(row);
}
