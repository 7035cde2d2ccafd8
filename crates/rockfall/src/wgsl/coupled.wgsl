// What the contacts of the spheres that share in a collision add to its row sum, whatever the kinds of objects (physics.md section 3).

// Whether a sphere that moves stands in an earlier slot of k and takes part in l: then l is counted already.
fn counted(k: ptr<function, Contact>, slot: u32, l: ptr<function, Contact>) -> bool {
    for (var s = 0u; s < slot; s++) {
        if ((*k).inverse_masses[s] > 0.0) & ((*k).spheres[s] != NONE) {
            if takes_part(l, (*k).spheres[s]) {
                return true;
            }
        }
    }
    return false;
}

// |G_kl| / sqrt(G_kk G_ll) for an overlapping entry l in a row of the sphere in a slot of k; 0 where l is counted elsewhere. `name`
// is k's ids and feature.
fn coupled_term(k: ptr<function, Contact>, name: vec3u, slot: u32, row: u32, entry: u32) -> f32 {
    let id = entry_id(entry);
    if taken_elsewhere((*k).spheres[slot], row, id) {
        return 0.0;
    }
    let other = vec3u(ordered(row, id), entry_feature(entry));
    let found = touch(other.x, other.y, other.z);
    var l = contact_of(other.x, other.y, found);
    if (l.inverse_mass <= 0.0) | (found.overlap <= 0.0) {
        return 0.0;
    }
    if counted(k, slot, &l) {
        return 0.0;
    }
    if all(other == name) {
        return 1.0;
    }
    return abs(coupling(k, &l)) / (sqrt((*k).inverse_mass) * sqrt(l.inverse_mass));
}
