use std::path::Path;

use glam::Vec3;

use crate::Scene;
use crate::mesh::Mesh;
use crate::scene::Loaded;

const TETRAHEDRON: &str = "@hull 0,0,0 1.5,0,0 0,1,0 0,0,0.1";

fn parse(text: &str, folder: &Path) -> crate::Result<Loaded> {
    Scene::parse(text, &folder.join("a.txt"))
}

fn scene(text: &str) -> Scene {
    let loaded = parse(text, Path::new("")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(loaded.warnings, []);
    loaded.scene
}

#[test]
fn a_hull_is_read_and_written() {
    let text = format!(
        "set contact_law rigid\n@material wood density=1\n@body stone density=2\nS 0 0 0 0 0 0 0 0 0 0 - 0.5\n\
         B 0 0 0 1 0 0 0 1 0 0 0 1\n@use wood\n@group 3\n@name tip\n{TETRAHEDRON}\n@hull 5,0,0 6,0,0 5,1,0 5,0,1\n@end\n\
         @place stone at=1,2,3 first=7\n@force 9 0 0 1\n"
    );
    let read = scene(&text);
    // The sphere, one of the box, one per hull.
    assert_eq!((read.spheres().len(), read.bodies().len()), (4, 1));
    let shape = &read.shapes()[0];
    assert_eq!(shape.hulls[0].points(), [Vec3::ZERO, Vec3::new(1.5, 0.0, 0.0), Vec3::Y, Vec3::new(0.0, 0.0, 0.1)]);
    assert_eq!((shape.hulls[1].group(), shape.hulls[1].material().is_some()), (3, true));
    let ids: Vec<_> = read.sphere_ids().collect();
    assert_eq!(read.hull_of_sphere(ids[3]), Some(&shape.hulls[1]));
    assert!(read.hull_of_sphere(ids[1]).is_none() && read.box_of_sphere(ids[2]).is_none());
    assert_eq!((read.spheres()[2].force, read.spheres()[2].group), (Vec3::Z, 3));
    assert!(read.tag(ids[2]).unwrap().is_some());
    let written = read.to_text();
    let again = scene(&written);
    assert_eq!(again.to_text(), written);
    // Handles of both scenes print alike: slots count from 0 in both.
    let contents = |scene: &Scene| format!("{:?} {:?} {:?}", scene.spheres(), scene.bodies(), scene.shapes());
    assert_eq!(contents(&again), contents(&read));
}

/// A point that is no vertex is left out. The hull of the others has the same digits as when it is read again.
#[test]
fn a_hull_is_saved_as_its_vertices() {
    let points: String = (0..27).map(|k| format!(" {},{},{}", 0.1 + (k % 3) as f32, k / 3 % 3, k / 9)).collect();
    let read = scene(&format!("set contact_law rigid\n@body cube\n@hull{points}\n@end\n"));
    assert_eq!(read.shapes()[0].hulls[0].points().len(), 8);
    let again = scene(&read.to_text());
    assert_eq!(format!("{:?}", again.shapes()), format!("{:?}", read.shapes()));
}

#[test]
fn the_vertices_of_a_file_are_scaled_turned_and_moved() {
    let folder = std::env::temp_dir().join(format!("rockfall-hull-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let vertices = vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let mesh = Mesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    std::fs::write(folder.join("t.stl"), mesh.to_stl()).unwrap();
    let body = |line: &str| parse(&format!("set contact_law rigid\n@body b\n{line}\n@end\n@place b at=0,0,0\n"), &folder);
    let scene = body("@hull t.stl scale=0.5 axis=0,0,1 turn=90 at=10,0,0").unwrap().scene;
    let points = scene.shapes()[0].hulls[0].points().to_vec();
    for expected in [[10.0, 0.0, 0.0], [10.0, 1.0, 0.0], [9.0, 0.0, 0.0], [10.0, 0.0, 1.0]] {
        assert!(points.contains(&Vec3::from_array(expected)), "{expected:?} is not in {points:?}");
    }
    for (line, part) in [
        ("@hull", "@hull points: missing"),
        ("@hull gone.stl", "@hull FILE"),
        ("@hull t.xyz", ".stl, .obj or .ply"),
        ("@hull t.stl scale=0", "@hull scale: 0 is not allowed"),
        ("@hull t.stl turn=3", "given without axis"),
        ("@hull t.stl size=3", "an unknown key"),
        ("@hull my t.stl", "no spaces"),
        ("@hull 0,0,0 1,0,0 0,1,0", "@hull points: 3 points is not allowed, expected 4 to 100000 points"),
        ("@hull 0,0,0 1,0,0 0,1,0 1,1,0", "@hull points: points that lie in one plane is not allowed"),
        ("@hull 0,0,0 1,0 0,1,0 0,0,1", "@hull point 1: '1,0' is not allowed, expected three numbers"),
        ("@hull 0,0,0 1,0,0 0,1,nan 0,0,1", "@hull point 2: 'nan' is not a finite number"),
        ("@hull 0,0,0 1,0,0 0,1,1e300 0,0,1", "three finite numbers"),
        ("@hull 0,0,0 1,0,0 0,1,1e30 0,0,1", "at most 1e15"),
    ] {
        let error = body(line).unwrap_err().to_string();
        assert!(error.contains("a.txt:3") && error.contains(part), "{line}: {error}");
    }
    let error = parse(&format!("# hulls\n{TETRAHEDRON}\n"), &folder).unwrap_err().to_string();
    assert!(error.contains("a.txt:2") && error.contains("between `@body` and `@end`"), "{error}");
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_fixed_body_has_the_triangles_of_its_hulls() {
    let text = format!("set contact_law rigid\n@body b\n{TETRAHEDRON}\n@end\n@place b at=0,0,0 fixed=1\n");
    let scene = parse(&text, Path::new("")).unwrap().scene;
    assert!(scene.bodies().is_empty() && scene.polygons().iter().all(crate::Polygon::is_triangle));
    assert_eq!(scene.polygons().len(), 4);
}
