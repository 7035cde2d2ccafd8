// requires model/put_head.wgsl model/step.wgsl step/broad_phase/due.wgsl step/broad_phase/sort_and_skip/near_tiles.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> topology: array<u32>;
@group(0) @binding(7) var<storage, read> status: Status;

var<private> count: u32;

fn emit(mover: u32, id: u32, features: u32) {
    count += features;
}

@compute @workgroup_size(64)
fn count_near(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if !builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let block = linear_group(group, groups);
    emit_near(block, local);
    let place = block * WORKGROUP + local;
    let mover = mover_at(place);
    if mover != NONE {
        put_head(mover, count);
    }
    // After the last mover, up to the end of its slice, the counts are 0.
    if (place >= step.spheres + step.rods) & (place < step.slices_at) {
        put_head(place, 0u);
    }
}
