@vertex
fn whole_picture(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(vec2u((index << 1u) & 2u, index & 2u)) * 2.0 - 1.0, 0.0, 1.0);
}
