// A power of two near 1 / |v| (docs/physics section 2.3). Products of vectors that are multiplied by it neither overflow nor underflow, and are rounded as
// without it.
fn scale_of(v: vec3f) -> f32 {
    let size = max(max(abs(v.x), abs(v.y)), abs(v.z));
    return bitcast<f32>((254u - min(bitcast<u32>(size) >> 23u, 254u)) << 23u);
}
