// requires model/lists.wgsl model/objects.wgsl model/step.wgsl

// Which lists hold the contacts of a sphere, and which capsule or network the sphere belongs to.

// Whether an entry of a mover's list collides.
fn has_collisions(mover: u32) -> bool {
    return (head_of(mover) & LIST_COLLIDES) != 0u;
}

// Returns a row of a sphere: a mover whose list holds contacts of the sphere's body. The rows are the sphere itself, its
// rods, and the other end of its capsule. There are 1 + 2 `rods.y` of them. Some are NONE.
fn row_of(sphere: u32, rods: vec2u, row: u32) -> u32 {
    if row == 0u {
        return sphere;
    }
    if row <= rods.y {
        return step.spheres + index_of(topology[rods.x + row - 1u]);
    }
    let rod = index_of(topology[rods.x + row - 1u - rods.y]);
    let partner = other_end(rod, sphere);
    return select(NONE, partner, capsule_rod(partner) == rod);
}

// Number of rows of a body: of a sphere and its `rods`, or of a capsule if `rod` is not NONE.
fn body_rows(rod: u32, rods: vec2u) -> u32 {
    return select(1u + rods.y, 3u, rod != NONE);
}

// Row r of a body: the sphere itself and its rods, or both ends of a capsule and its rod.
fn body_row(sphere: u32, rod: u32, rods: vec2u, r: u32) -> u32 {
    if RODS & (rod != NONE) {
        let ends = rod_ends(rod);
        return select(select(ends.x, ends.y, r == 1u), step.spheres + rod, r == 2u);
    }
    if r == 0u {
        return sphere;
    }
    return step.spheres + index_of(topology[rods.x + r - 1u]);
}

// The parameter on the rod of a capsule of a contact in one of its rows. `at` is the parameter in the row of the rod.
fn at_on_capsule(rod: u32, row: u32, at: f32) -> f32 {
    if row < step.spheres {
        return select(0.0, 1.0, rod_ends(rod).y == row);
    }
    return at;
}

// Whether a collision may change the state of a sphere. The result is true for every sphere of a network, because it would take
// too long to check all rows of the network.
fn takes_part_in_any(sphere: u32) -> bool {
    let rods = rods_of(sphere);
    for (var r = 0u; r < 1u + 2u * rods.y; r++) {
        let row = row_of(sphere, rods, r);
        if row != NONE {
            if has_collisions(row) {
                return true;
            }
        }
    }
    return RODS & (network_of(sphere) != NO_NETWORK);
}

fn network_of_rod(rod: u32) -> u32 {
    return topology[step.networks_at - step.rods + rod];
}

// Whether a rod of fixed length forms a rigid capsule with the spheres at its ends.
fn is_capsule(rod: u32) -> bool {
    return (network_of_rod(rod) == NO_NETWORK) & (inverse_mass(rod_ends(rod).x) > 0.0);
}

// The rod of the rigid capsule that has the sphere as an end, or NONE.
fn capsule_with(sphere: u32) -> u32 {
    let rod = capsule_rod(sphere);
    if rod == NONE {
        return NONE;
    }
    return select(NONE, rod, is_capsule(rod));
}

// The network that a moving sphere belongs to, or NO_NETWORK.
fn network_of(sphere: u32) -> u32 {
    if end_of(sphere) == NO_ROD {
        return NO_NETWORK;
    }
    if inverse_mass(sphere) <= 0.0 {
        return NO_NETWORK;
    }
    let rods = rods_of(sphere);
    for (var r = 0u; r < rods.y; r++) {
        let network = network_of_rod(index_of(topology[rods.x + r]));
        if network != NO_NETWORK {
            return network;
        }
    }
    return NO_NETWORK;
}
