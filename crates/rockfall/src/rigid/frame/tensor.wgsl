// Symmetric matrices.

// A symmetric matrix: xx yy zz; xy xz yz.
struct Tensor {
    diagonal: vec3f,
    beside: vec3f,
}

fn axes_in(bits: u32) -> vec3<bool> {
    return (vec3u(bits) & vec3u(1u, 2u, 4u)) != vec3u(0u);
}

// K^-1 b for the rows that there are, by K = L D L^T.
fn solved(k: Tensor, rows: vec3<bool>, right: vec3f) -> vec3f {
    let d = select(vec3f(1.0), k.diagonal, rows);
    let e = select(vec3f(0.0), k.beside, rows.xxy & rows.yzz);
    let b = select(vec3f(0.0), right, rows);
    let low_y = e.x / d.x;
    let low_z = e.y / d.x;
    let d_y = d.y - low_y * e.x;
    let e_z = e.z - low_y * e.y;
    let last = e_z / d_y;
    let d_z = (d.z - low_z * e.y) - last * e_z;
    let y = b.y - low_y * b.x;
    let z = ((b.z - low_z * b.x) - last * y) / d_z;
    let middle = y / d_y - last * z;
    return vec3f(b.x / d.x - low_y * middle - low_z * z, middle, z);
}
