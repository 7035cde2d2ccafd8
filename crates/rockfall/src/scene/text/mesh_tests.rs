use std::path::{Path, PathBuf};

use crate::Scene;
use crate::mesh::Mesh;

/// A folder with the mesh `tetrahedron.stl`, whose vertices are the origin and 2 on each axis.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("rockfall-mesh-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let vertices = vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 1, 1]];
    std::fs::write(folder.join("tetrahedron.stl"), Mesh::new(vertices, triangles).unwrap().to_stl()).unwrap();
    folder
}

fn parse(text: &str, folder: &Path) -> crate::Result<Scene> {
    Scene::parse(text, &folder.join("scene.txt")).map(|loaded| loaded.scene)
}

#[test]
fn a_mesh_is_read_beside_the_scene_scaled_turned_and_named() {
    let folder = folder("read");
    let text = "@material wood density=1\n@motion drum velocity=1,0,0\n@use wood\n@move drum\n@group 2\n@colour red\n\
                @mesh tetrahedron.stl scale=0.5 axis=0,0,1 turn=90 at=10,0,0 name=pot\n@move -\n@repeat 3 0 1 0\n\
                @mesh tetrahedron.stl\n@end\n";
    let scene = parse(text, &folder).unwrap();
    assert_eq!(scene.counts().polygons, 16);
    let first = &scene.polygons()[..4];
    let vertices: Vec<[f32; 3]> = first.iter().flat_map(|polygon| polygon.vertices()).map(|v| v.to_array()).collect();
    for expected in [[10.0, 0.0, 0.0], [10.0, 1.0, 0.0], [9.0, 0.0, 0.0], [10.0, 0.0, 1.0]] {
        assert!(vertices.contains(&expected), "{expected:?} is not in {vertices:?}");
    }
    assert!(first.iter().all(|polygon| polygon.group == 2 && polygon.material.is_some() && polygon.motion.is_some()));
    assert_eq!(scene.named("pot").unwrap().len(), 4);
    let highest = scene.polygons()[4..].iter().flat_map(|polygon| polygon.vertices()).map(|v| v.y).fold(0.0, f32::max);
    assert_eq!(highest, 4.0, "the third copy is moved by 2");
    // Written as triangles, it is the same scene without the file.
    let written = scene.to_text();
    assert_eq!(parse(&written, Path::new("elsewhere")).unwrap().to_text(), written);
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn wrong_lines_name_the_field() {
    let folder = folder("wrong");
    for (line, field, part) in [
        ("@mesh gone.stl", "FILE", "gone.stl"),
        ("@mesh scene.xyz", "FILE", ".stl, .obj or .ply"),
        ("@mesh tetrahedron.stl scale=0", "", "other than 0"),
        ("@mesh tetrahedron.stl scale=no", "scale", "not a finite number"),
        ("@mesh tetrahedron.stl at=1,2", "at", "three numbers"),
        ("@mesh tetrahedron.stl turn=90", "turn", "without axis"),
        ("@mesh tetrahedron.stl size=2", "size", "an unknown key"),
        ("@mesh tetrahedron.stl name=a=b", "name", "one word"),
        ("@mesh my file.stl", "file.stl", "no spaces"),
        ("@mesh tetrahedron.stl scale=1 scale=2", "scale", "twice"),
    ] {
        let error = parse(&format!("# meshes\n{line}\n"), &folder).unwrap_err().to_string();
        assert!(error.contains("scene.txt:2") && error.contains(field) && error.contains(part), "{line}: {error}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}
