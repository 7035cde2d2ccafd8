//! The target `mesh`: any bytes as a mesh file.

use rockfall::glam::DVec3;
use rockfall::{Mesh, MeshFormat};

use super::message::assert_short;

/// Reads bytes after the first one as a file of the format that the first one chooses: `s`, `o` or `p`. A refused file gets a short
/// error. An accepted mesh is valid, and is equal when it is written and read again.
///
/// # Panics
/// When the reader breaks one of these promises.
pub fn mesh(bytes: &[u8]) {
    let Some((first, file)) = bytes.split_first() else { return };
    let format = match first {
        b's' => MeshFormat::Stl,
        b'o' => MeshFormat::Obj,
        b'p' => MeshFormat::Ply,
        _ => return,
    };
    let mesh = match Mesh::parse(file, format) {
        Ok(mesh) => mesh,
        Err(error) => return assert_short(&error),
    };
    let mut used = 0;
    for [a, b, c] in mesh.triangles.iter().copied() {
        assert!(a != b && b != c && c != a, "{mesh:?}");
        for index in [a, b, c] {
            assert!(index <= used, "vertices are in order of use: {mesh:?}");
            used = used.max(index + 1);
        }
    }
    assert!(used as usize == mesh.vertices.len() && used > 0, "{mesh:?}");
    assert!(mesh.vertices.iter().flatten().all(|x| x.is_finite()), "{mesh:?}");
    assert!(mesh.area() > 0.0 && mesh.volume().is_finite(), "{mesh:?}");
    let again = Mesh::parse(&mesh.to_stl(), MeshFormat::Stl).expect("a written mesh is valid");
    assert_eq!((&again.vertices, &again.triangles, again.left_out), (&mesh.vertices, &mesh.triangles, 0));
    match mesh.transformed(-0.5, DVec3::new(1.0, 2.0, 3.0), 50.0, DVec3::ONE) {
        Ok(moved) => assert!(moved.triangles.len() + moved.left_out == mesh.triangles.len() + mesh.left_out),
        Err(error) => assert_short(&error),
    }
}
