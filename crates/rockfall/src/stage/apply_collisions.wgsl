@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> next: array<vec4f>;
@group(0) @binding(4) var<storage, read> words: array<u32>;
@group(0) @binding(5) var<storage, read> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(7) var<storage, read> row_sums: array<array<f32, SLICE>>;
@group(0) @binding(8) var<storage, read_write> status: StatusAtomic;

fn put_next(region: u32, i: u32, row: vec4f) {
    next[region * step.spheres + i] = row;
}

// `changes_of` a team's sphere, of which there is one list.
fn changes_together(sphere: u32, local: u32) -> Change {
    let count = count_of(sphere);
    let first = first_of(sphere);
    begin_sums(local);
    for (var begin = 0u; begin < count; begin += WORKGROUP) {
        var part = no_part();
        if begin + local < count {
            let slot = slot_at(first, begin + local);
            if (entry_at(slot) & ENTRY_COLLIDES) != 0u {
                part = part_of_entry(sphere, sphere, slot);
            }
        }
        add_in_order(local, min(count - begin, WORKGROUP), part.share, part.velocity, part.share, part.position);
    }
    workgroupBarrier();
    return Change(first_sum(), second_sum());
}

fn apply_together(sphere: u32, local: u32) {
    if told_to_team(local, u32(takes_part_in_any(sphere) & has_changes())) == 0u {
        return;
    }
    // Where there are several lists one thread goes through all of them.
    if told_to_team(local, u32(is_plain(sphere) & (inverse_mass(sphere) > 0.0))) == 0u {
        if local == 0u {
            write_change(sphere);
        }
        return;
    }
    let change = changes_together(sphere, local);
    if local == 0u {
        write_changed(sphere, change);
    }
}

@compute @workgroup_size(64)
fn apply_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let workgroup = linear_group(group, groups);
    if is_team(workgroup) {
        apply_together(sphere_of_team(workgroup), local);
        return;
    }
    let i = mover_of(workgroup, local);
    if i < step.spheres {
        // Nearly all are told by one word of the lists that they have nothing to do; the status takes several times as long to read.
        if takes_part_in_any(i) {
            if has_changes() {
                write_change(i);
            }
        }
    }
}
