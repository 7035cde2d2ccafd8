// Counts the speeds of the spheres by size, from which a percentile is computed.

struct Found {
    spheres: u32,
    /// Every n-th sphere is counted.
    stride: u32,
    padding: vec2u,
    /// The region whose spheres are counted separately.
    low: vec4f,
    high: vec4f,
    /// The counts of the spheres in the region, then those of the others. The upper 12 bits of a float that is not negative
    /// are its bin: exponent and 4 bits of the fraction.
    bins: array<atomic<u32>, 8192>,
}

@group(0) @binding(0) var<storage, read> state: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> found: Found;

@compute @workgroup_size(256)
fn count_speeds(@builtin(global_invocation_id) id: vec3u) {
    let sphere = id.x * found.stride;
    if sphere >= found.spheres {
        return;
    }
    let speed = length(state[found.spheres + sphere].xyz);
    // Bodies at rest say nothing about the scale.
    if !(speed > 0.0) {
        return;
    }
    let place = state[sphere].xyz;
    let inside = all(place >= found.low.xyz) && all(place <= found.high.xyz);
    atomicAdd(&found.bins[select(4096u, 0u, inside) + (bitcast<u32>(speed) >> 19u)], 1u);
}
