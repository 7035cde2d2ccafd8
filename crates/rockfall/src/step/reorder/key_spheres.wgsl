// requires model/step.wgsl

@group(0) @binding(2) var<storage, read> state: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> pairs: array<vec2u>;
@group(0) @binding(4) var<storage, read> status: Status;

// Spreads the low 10 bits of each component, with two zero bits between neighbours.
fn spread(bits: vec3u) -> vec3u {
    var x = bits & vec3u(0x3ffu);
    x = (x | (x << vec3u(16u))) & vec3u(0x30000ffu);
    x = (x | (x << vec3u(8u))) & vec3u(0x300f00fu);
    x = (x | (x << vec3u(4u))) & vec3u(0x30c30c3u);
    return (x | (x << vec3u(2u))) & vec3u(0x9249249u);
}

// Returns the size class of a sphere: 0 for up to 4 cells wide, 1 for up to 16, 2 for up to 64, 3 for more. Large
// spheres come after all small ones in memory, so that long lists are adjacent.
fn size_class(radius: f32) -> u32 {
    let cells = vec3f(4.0, 16.0, 64.0) * step.cell_size;
    let larger = select(vec3u(0u), vec3u(1u), vec3f(2.0 * radius) > cells);
    return larger.x + larger.y + larger.z;
}

@compute @workgroup_size(64)
fn key_spheres(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let i = linear_thread(group, groups, local);
    if (i >= step.spheres) | (status.rejected != 0u) {
        return;
    }
    let ball = state[i];
    let far = vec3f(1073741824.0);
    let cell = vec3i(clamp(floor(ball.xyz / step.cell_size), -far, far));
    let axes = spread(vec3u(cell));
    pairs[i] = vec2u(axes.x | (axes.y << 1u) | (axes.z << 2u) | (size_class(ball.w) << 30u), i);
}
