// requires model/step.wgsl

// Who works on what in stages that go through lists: a thread on each mover, but a workgroup on each large sphere, which has hundreds of
// neighbours. Large spheres are the last in memory. Their workgroups come first, for what takes longest should begin first.

// Whether all of a workgroup works on one sphere.
fn serves_large_sphere(workgroup: u32) -> bool {
    return LARGE & (workgroup < step.large);
}

fn is_large(id: u32) -> bool {
    return LARGE & (id < step.spheres) & (id >= step.spheres - step.large);
}

// The large sphere of a team.
fn large_sphere_of(workgroup: u32) -> u32 {
    return step.spheres - step.large + workgroup;
}

var<workgroup> told: u32;

// What the first thread of a team says, for all of them: what they loop over and wait at must be the same. All must come here.
fn broadcast_to_workgroup(local: u32, word: u32) -> u32 {
    if local == 0u {
        told = word;
    }
    return workgroupUniformLoad(&told);
}

// Of a thread of another workgroup its mover, of one of a team the sphere of all.
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

// Whether a thread writes what becomes of its mover: of a team one does.
fn is_writer(workgroup: u32, local: u32) -> bool {
    return !serves_large_sphere(workgroup) | (local == 0u);
}
