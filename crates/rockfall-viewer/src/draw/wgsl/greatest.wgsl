// Computes the greatest speed of all spheres.

struct Found {
    /// Bits of a float. Floats that are not negative have the same order as their bits.
    greatest: atomic<u32>,
    spheres: u32,
}

@group(0) @binding(0) var<storage, read> state: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> found: Found;

var<workgroup> of_group: atomic<u32>;

@compute @workgroup_size(256)
fn greatest_speed(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) local: u32,
    @builtin(num_workgroups) groups: vec3u,
) {
    var greatest = 0.0;
    for (var sphere = id.x; sphere < found.spheres; sphere += 256u * groups.x) {
        greatest = max(greatest, length(state[found.spheres + sphere].xyz));
    }
    atomicMax(&of_group, bitcast<u32>(greatest));
    workgroupBarrier();
    if local == 0u {
        atomicMax(&found.greatest, atomicLoad(&of_group));
    }
}
