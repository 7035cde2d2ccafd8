// requires model/step.wgsl step/broad_phase/due.wgsl step/broad_phase/sort_and_skip/axis.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read_write> cells: array<u32>;
@group(0) @binding(4) var<storage, read_write> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read> status: Status;

var<workgroup> least: array<f32, WORKGROUP>;
var<workgroup> greatest: array<f32, WORKGROUP>;

@compute @workgroup_size(64)
fn bound_blocks(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if !builds_lists(REBUILD_UNDER_WAY) {
        return;
    }
    let block = linear_group(group, groups);
    let place = block * WORKGROUP + local;
    // In a block that is not full, the threads after the last object load the last object again.
    let clamped = min(place, objects() - 1u);
    let aabb = aabbs[cells[step.sorted_at + clamped]];
    least[local] = aabb.min.x;
    greatest[local] = aabb.max.x;
    for (var reach = WORKGROUP / 2u; reach > 0u; reach /= 2u) {
        workgroupBarrier();
        if local < reach {
            least[local] = min(least[local], least[local + reach]);
            greatest[local] = max(greatest[local], greatest[local + reach]);
        }
    }
    if (local == 0u) & (block < blocks()) {
        extents[block] = vec4f(least[0], greatest[0], 0.0, 0.0);
    }
    if place == 0u {
        cells[2] = objects();
    }
}
