// requires model/step.wgsl physics/collision/cluster.wgsl step/collisions/has_changes.wgsl step/collisions/records.wgsl

@group(0) @binding(2) var<storage, read_write> collisions: array<vec4u>;
@group(0) @binding(3) var<storage, read_write> status: StatusAtomic;

// Set to the largest number of threads that the device allows in a workgroup.
override GROUP_SIZE: u32 = 256u;

var<workgroup> records: u32;
// The largest number of neighbours of any record. All threads use it, so that they run the same number of rounds.
var<workgroup> most: atomic<u32>;
var<workgroup> rounds: u32;

// All threads run the same number of rounds in a loop before a barrier. One driver was seen to let threads that leave such a loop early
// run through the barrier while their neighbours were still in the loop.
@compute @workgroup_size(GROUP_SIZE)
fn sweep_at_once(@builtin(local_invocation_index) local: u32) {
    if local == 0u {
        let is_due = has_changes() & (atomicLoad(&status.clustered) != 0u);
        records = select(0u, min(listed_records(), FEW_COLLISIONS), is_due);
        atomicStore(&most, 0u);
    }
    let count = workgroupUniformLoad(&records);
    if count == 0u {
        return;
    }
    for (var first = 0u; first < count; first += GROUP_SIZE) {
        let r = first + local;
        if r < count {
            if is_shared(r) {
                atomicMax(&most, neighbours_of(r));
            }
        }
    }
    workgroupBarrier();
    if local == 0u {
        rounds = atomicLoad(&most);
    }
    let neighbours = workgroupUniformLoad(&rounds);
    for (var sweeps = 0u; sweeps < SWEEPS; sweeps++) {
        for (var first = 0u; first < count; first += GROUP_SIZE) {
            let r = first + local;
            if r < count {
                if is_shared(r) {
                    put_sweep(r, sweeps, change_by_neighbours(r, neighbours, sweeps));
                }
            }
        }
        storageBarrier();
    }
}
