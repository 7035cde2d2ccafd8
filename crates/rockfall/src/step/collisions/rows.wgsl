// requires model/lists.wgsl model/objects.wgsl model/step.wgsl

// In which lists the contacts of a sphere stand.

// Whether some entry of a mover collides.
fn has_collisions(mover: u32) -> bool {
    return (head_of(mover) & LIST_COLLIDES) != 0u;
}

// The objects whose lists hold the contacts in which a sphere takes part ("rows"): the sphere itself, its rods, and the
// far ends of its capsules. There are 1 + 2 `rods.y` of them, some NONE.
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

// Whether some collision may change the state of a sphere. In a network it is enough that there are collisions at all: who has them is
// too much to ask.
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

// Whether a rod of fixed length is a rigid capsule with the spheres at its ends.
fn is_capsule(rod: u32) -> bool {
    return (network_of_rod(rod) == NO_NETWORK) & (inverse_mass(rod_ends(rod).x) > 0.0);
}

// The rod of the rigid capsule that a sphere is an end of, or NONE.
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
