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

@compute @workgroup_size(64)
fn apply_collisions(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if i < step.spheres {
        // Nearly all are told by one word of the lists that they have nothing to do; the status takes several times as long to read.
        if takes_part_in_any(i) {
            if has_changes() & !is_shared_out(i) {
                write_change(i);
            }
        }
    }
}
