// requires model/put_head.wgsl model/step.wgsl step/broad_phase/grid/long.wgsl step/broad_phase/grid/neighbours.wgsl

@group(0) @binding(2) var<storage, read> aabbs: array<Aabb>;
@group(0) @binding(3) var<storage, read> cells: array<u32>;
@group(0) @binding(4) var<storage, read> extents: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> lists: array<array<u32, SLICE>>;
@group(0) @binding(6) var<storage, read> topology: array<u32>;
@group(0) @binding(7) var<storage, read> status: Status;

var<private> found: u32;
var<workgroup> all_found: atomic<u32>;

fn emit(mover: u32, place: u32) {
    found += entries_found(mover, place);
}

@compute @workgroup_size(256)
fn count_long(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if cells[1] == 0u {
        return;
    }
    for (var turn = linear_group(group, groups); turn < long_movers(); turn += groups.x * groups.y) {
        let mover = long_mover(turn);
        if local == 0u {
            atomicStore(&all_found, 0u);
        }
        workgroupBarrier();
        found = 0u;
        emit_neighbours(mover, portion_of_thread(local));
        atomicAdd(&all_found, found);
        workgroupBarrier();
        if local == 0u {
            put_head(mover, atomicLoad(&all_found));
        }
    }
}
