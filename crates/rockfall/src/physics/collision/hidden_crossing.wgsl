// requires model/entries.wgsl model/lists.wgsl physics/collision/crossings.wgsl physics/surface.wgsl

// Whether another shape of the same surface hides a crossing with a box or polygon at its time of contact (docs/physics section 2.11).
fn is_hidden_crossing(i: u32, id: u32, time: f32) -> bool {
    if !is_static(id) {
        return false;
    }
    let now = state[position_at(i)];
    let own = vec4f(now.xyz - time * (path_of(i) - drift_of(i, id)), now.w);
    let found = contact_with_shape(own, id);
    let one = candidate(id, own, found);
    let count = count_of(i);
    let first = first_of(i);
    for (var e = 0u; e < count; e++) {
        let other = entry_id(entry_at(slot_at(first, e)));
        if !is_static(other) | (other == id) {
            continue;
        }
        let nearer = contact_with_shape(own, other);
        if (nearer.overlap > 0.0) & (nearer.overlap > found.overlap) {
            var chosen: Surfaces;
            choose_surface(candidate(other, own, nearer), &chosen);
            if is_behind(one, own, &chosen) {
                return true;
            }
        }
    }
    return false;
}
