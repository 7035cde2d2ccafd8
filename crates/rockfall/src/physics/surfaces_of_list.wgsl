// requires model/entries.wgsl model/lists.wgsl model/step.wgsl physics/surface.wgsl

// The surfaces of a sphere, from its list.

// The sphere whose surfaces have been chosen.
var<private> chosen_for: u32 = NONE;

fn choose_surfaces(i: u32, own: vec4f) {
    surface_count = 0u;
    let count = count_of(i);
    let first = first_of(i);
    // Boxes and polygons are the last entries.
    var begin = count;
    while (begin > 0u) && is_static(entry_id(entry_at(slot_at(first, begin - 1u)))) {
        begin--;
    }
    if count - begin < 2u {
        return;
    }
    while surface_count < MOST_SURFACES {
        var best = no_candidate();
        for (var e = begin; e < count; e++) {
            best = nearer_candidate(best, i, own, entry_id(entry_at(slot_at(first, e))));
        }
        if best.id == NONE {
            return;
        }
        choose_surface(best);
    }
}

// Whether a sphere does not touch an object that it overlaps, because a nearer one hides it.
fn is_hidden(i: u32, own: vec4f, id: u32) -> bool {
    if !is_static(id) {
        return false;
    }
    if chosen_for != i {
        choose_surfaces(i, own);
        chosen_for = i;
    }
    return is_hidden_by_surfaces(i, own, id);
}
