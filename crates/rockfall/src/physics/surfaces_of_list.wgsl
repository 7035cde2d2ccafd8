// requires model/entries.wgsl model/lists.wgsl model/step.wgsl physics/contact.wgsl physics/surface.wgsl

// The hidden entries in the list of a sphere.

fn is_static_entry(first: vec2u, e: u32) -> bool {
    return is_static(entry_id(entry_at(slot_at(first, e))));
}

// Which of the entries from `begin` on, up to ENTRIES_PER_MASK, are hidden: a bit each.
fn hidden_entries(i: u32, own: vec4f, first: vec2u, begin: u32, count: u32) -> u32 {
    let end = min(begin + ENTRIES_PER_MASK, count);
    // Boxes and polygons are the last entries. One alone is not hidden.
    if count < 2u {
        return 0u;
    }
    if !is_static_entry(first, count - 2u) || !is_static_entry(first, end - 1u) {
        return 0u;
    }
    return hidden_among_several(i, own, first, begin, count);
}

fn hidden_among_several(i: u32, own: vec4f, first: vec2u, begin: u32, count: u32) -> u32 {
    var statics = count;
    while (statics > 0u) && is_static_entry(first, statics - 1u) {
        statics--;
    }
    var chosen: Surfaces;
    while chosen.count < MOST_SURFACES {
        var best = no_candidate();
        for (var e = statics; e < count; e++) {
            best = nearer_candidate(best, i, own, entry_id(entry_at(slot_at(first, e))), &chosen);
        }
        if best.overlaps < 2u {
            return 0u;
        }
        if best.id == NONE {
            break;
        }
        choose_surface(best, &chosen);
    }
    var hidden = 0u;
    for (var e = max(begin, statics); e < min(begin + ENTRIES_PER_MASK, count); e++) {
        if is_hidden(i, own, entry_id(entry_at(slot_at(first, e))), &chosen) {
            hidden |= 1u << (e - begin);
        }
    }
    return hidden;
}
