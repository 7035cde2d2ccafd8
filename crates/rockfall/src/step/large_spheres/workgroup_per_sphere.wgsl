// requires model/step.wgsl

// How stages that go through lists assign work: a thread to each mover, but a workgroup to each large sphere, because it has
// hundreds of neighbours. Large spheres are the last in memory. Their workgroups are the first of a dispatch, so that the
// longest work starts first.

// Length of an array in workgroup memory with a value for each thread. A scene without large spheres does not need it, and without
// it the processor has more cache.
const LARGE_WORKGROUP: u32 = select(1u, WORKGROUP, LARGE);

// Returns whether all threads of a workgroup work on one large sphere.
fn serves_large_sphere(workgroup: u32) -> bool {
    return LARGE & (workgroup < step.large);
}

fn is_large(id: u32) -> bool {
    return LARGE & (id < step.spheres) & (id >= step.spheres - step.large);
}

// Returns the sphere of a workgroup that works on a large sphere.
fn large_sphere_of(workgroup: u32) -> u32 {
    return step.spheres - step.large + workgroup;
}

var<workgroup> broadcast_word: u32;

// Returns the word of the first thread to all threads of the workgroup, because loops and branches around barriers must be
// uniform. All threads of the workgroup must call it.
fn broadcast_to_workgroup(local: u32, word: u32) -> u32 {
    if local == 0u {
        broadcast_word = word;
    }
    return workgroupUniformLoad(&broadcast_word);
}

// Returns the mover of a thread. In a workgroup that works on a large sphere, it is that sphere for all threads.
fn mover_of(workgroup: u32, local: u32) -> u32 {
    if serves_large_sphere(workgroup) {
        return large_sphere_of(workgroup);
    }
    if !LARGE {
        return workgroup * WORKGROUP + local;
    }
    let mover = (workgroup - step.large) * WORKGROUP + local;
    return mover + select(0u, step.large, mover >= step.spheres - step.large);
}

// Returns whether a thread writes the results of its mover. In a workgroup that works on a large sphere only the first thread
// does.
fn is_writer(workgroup: u32, local: u32) -> bool {
    return !serves_large_sphere(workgroup) | (local == 0u);
}
