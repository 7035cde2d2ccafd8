// In which lists the contacts of a sphere stand.

// Whether there are collisions to apply in this attempt at the step.
fn has_changes() -> bool {
    return (atomicLoad(&status.void) == 0u) & (atomicLoad(&status.collided) == 0u) & (atomicLoad(&status.collides) != 0u);
}

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
        return step.spheres + index_of(words[rods.x + row - 1u]);
    }
    let rod = index_of(words[rods.x + row - 1u - rods.y]);
    let partner = other_end(rod, sphere);
    return select(NONE, partner, capsule_rod(partner) == rod);
}

// Whether a sphere has a share in some collision: only then its state changes.
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
    return false;
}

fn is_row_of(sphere: u32, id: u32) -> bool {
    if id < step.spheres {
        return (id == sphere) | (capsule_partner(id) == sphere);
    }
    if id - step.spheres < step.rods {
        return any(rod_ends(id - step.spheres) == vec2u(sphere));
    }
    return false;
}

// A contact between two rows of one sphere stands in both of their lists: it is taken in that of the lower id.
fn taken_elsewhere(sphere: u32, row: u32, id: u32) -> bool {
    if user_of(id) > user_of(row) {
        return false;
    }
    return is_row_of(sphere, id);
}
