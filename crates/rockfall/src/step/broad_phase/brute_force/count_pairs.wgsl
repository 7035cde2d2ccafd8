// requires model/put_head.wgsl model/step.wgsl step/broad_phase/due.wgsl step/broad_phase/brute_force/pair_tiles.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(4) var<storage, read> topology: array<u32>;
@group(0) @binding(5) var<storage, read> status: Status;

fn emit(mover: u32, place: u32, entry: u32) {}

@compute @workgroup_size(64)
fn count_pairs(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if !builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let mover = linear_thread(group, groups, local);
    let count = emit_pairs(mover, local);
    // After the last mover, up to the end of its slice, the counts are 0.
    if mover < step.slices_at {
        put_head(mover, count);
    }
}
