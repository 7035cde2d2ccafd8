use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::{Mesh, MeshFormat};

/// A cube from 0 to 1 and the tetrahedron of the origin and the unit vectors, with the outside outside.
pub(super) fn cube() -> Mesh {
    let vertices = (0..8_u8).map(|number| [0, 1, 2].map(|axis| f32::from(number >> axis & 1))).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh::new(vertices, sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()).unwrap()
}

fn tetrahedron() -> Mesh {
    let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Mesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found}, expected {expected}");
}

/// Number of edges that do not belong to exactly one triangle in each direction.
fn open_edges(mesh: &Mesh) -> usize {
    let ends = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let edges: Vec<_> = mesh.triangles.iter().copied().flat_map(ends).collect();
    let count = |edge| edges.iter().filter(|other| **other == edge).count();
    edges.iter().filter(|[a, b]| count([*a, *b]) != 1 || count([*b, *a]) != 1).count()
}

fn message(result: crate::Result<Mesh>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn measures_of_a_cube_and_a_tetrahedron() {
    let (cube, tetrahedron) = (cube(), tetrahedron());
    assert_eq!((cube.area(), cube.volume()), (6.0, 1.0));
    assert_eq!(cube.bounds(), [[0.0; 3], [1.0; 3]]);
    close(tetrahedron.area(), 1.5 + 0.75_f64.sqrt(), 1e-15);
    close(tetrahedron.volume(), 1.0 / 6.0, 1e-15);
    let inside_out = cube.triangles.iter().map(|[a, b, c]| [*b, *a, *c]).collect();
    assert_eq!(Mesh::new(cube.vertices.clone(), inside_out).unwrap().volume(), -1.0);
    let far = cube.transformed(1.0, DVec3::Z, 0.0, DVec3::new(1e6, -2e6, 3e6)).unwrap();
    assert_eq!((far.area(), far.volume()), (6.0, 1.0));
    assert_eq!(far.bounds(), [[1e6, -2e6, 3e6], [1e6 + 1.0, -2e6 + 1.0, 3e6 + 1.0]]);
}

#[test]
fn equal_vertices_are_welded_in_order_of_use() {
    let vertices =
        vec![[9.0; 3], [1.0, 0.0, 0.0], [0.0, -0.0, 0.0], [0.0, 1.0, -0.0], [-0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0; 3]];
    let mesh = Mesh::new(vertices, vec![[3, 2, 1], [4, 5, 6]]).unwrap();
    assert_eq!(mesh.vertices, [[0.0, 1.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [1.0; 3]]);
    assert!(mesh.vertices.iter().flatten().all(|x| x.is_sign_positive()), "{mesh:?}");
    assert_eq!((mesh.triangles, mesh.left_out), (vec![[0, 1, 2], [1, 2, 3]], 0));
}

#[test]
fn degenerate_triangles_are_left_out() {
    let line = |x: f32| [x, 2.0 * x, 3.0 * x];
    let vertices =
        vec![line(0.0), line(1.0), line(2.5), [0.0, 1.0, 0.0], line(1.0), [2e-6, 0.0, 0.0], [1e6, 1e-6, 0.0], [1e6, 0.0, 0.0]];
    // A point twice; equal points; points on a line; and two needles, one on each side of the limit.
    let triangles = vec![[0, 0, 3], [0, 1, 4], [0, 1, 2], [0, 7, 6], [0, 5, 3], [0, 1, 3]];
    let mesh = Mesh::new(vertices.clone(), triangles).unwrap();
    assert_eq!((mesh.left_out, mesh.triangles.len()), (4, 2));
    assert_eq!(mesh.vertices, [vertices[0], vertices[5], vertices[3], vertices[1]]);
    let tiny: Vec<_> = tetrahedron().vertices.iter().map(|vertex| vertex.map(|x| x * 1e-45)).collect();
    assert_eq!(Mesh::new(tiny, tetrahedron().triangles).unwrap().left_out, 0);
    let huge: Vec<_> = tetrahedron().vertices.iter().map(|vertex| vertex.map(|x| x * 3e38)).collect();
    assert_eq!(Mesh::new(huge, tetrahedron().triangles).unwrap().left_out, 0);
}

#[test]
fn invalid_numbers_are_refused() {
    let corners = || vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let error = message(Mesh::new(corners(), vec![[0, 1, 2], [0, 1, 3]]));
    assert!(error.starts_with("mesh.triangles: [0, 1, 3] of triangle 1 with 3 vertices is not allowed"), "{error}");
    for wrong in [f32::NAN, f32::INFINITY] {
        let mut vertices = corners();
        vertices.push([0.0, wrong, 0.0]);
        let error = message(Mesh::new(vertices, vec![[0, 1, 2]]));
        assert!(error.starts_with(&format!("mesh.vertices: [0.0, {wrong:?}, 0.0] of vertex 3 is")), "{error}");
    }
    assert!(message(Mesh::new(vec![], vec![])).starts_with("mesh.triangles: no triangle"));
    assert!(message(Mesh::new(corners(), vec![[0, 1, 1]])).contains("1 triangles are all degenerate"));
}

#[test]
fn turns_by_quarters_are_exact() {
    let mesh = Mesh::new(vec![[1.0, 2.0, 3.0], [4.0, 5.0, 7.0], [0.1, 0.7, 0.2]], vec![[0, 1, 2]]).unwrap();
    let first = |axis, turn| mesh.transformed(1.0, axis, turn, DVec3::ZERO).unwrap().vertices[0];
    assert_eq!(first(DVec3::Z * 1e-200, 90.0), [-2.0, 1.0, 3.0]);
    assert_eq!(first(DVec3::Z * 1e300, 180.0), [-1.0, -2.0, 3.0]);
    assert_eq!(first(DVec3::Z, -90.0), [2.0, -1.0, 3.0]);
    assert_eq!(first(DVec3::X, 450.0), [1.0, -3.0, 2.0]);
    assert_eq!(first(DVec3::Y, -360.0), [1.0, 2.0, 3.0]);
    let on_axes = Mesh::new(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], vec![[0, 1, 2]]).unwrap();
    let turned = on_axes.transformed(1.0, DVec3::Z, 270.0, DVec3::ZERO).unwrap();
    assert_eq!(turned.vertices, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    let third = first(DVec3::ONE, 120.0);
    assert!([3.0, 1.0, 2.0].into_iter().zip(third).all(|(x, found): (f32, f32)| (x - found).abs() < 1e-6), "{third:?}");
    let eighth = first(DVec3::Z, 45.0);
    close(f64::from(eighth[0]), -0.5_f64.sqrt(), 1e-7);
    close(f64::from(eighth[1]), 3.0 * 0.5_f64.sqrt(), 1e-7);
}

#[test]
fn a_mesh_is_scaled_then_turned_then_shifted() {
    let cube = cube();
    let moved = cube.transformed(2.0, DVec3::Z, 90.0, DVec3::new(10.0, 20.0, 30.0)).unwrap();
    assert_eq!(moved.bounds(), [[8.0, 20.0, 30.0], [10.0, 22.0, 32.0]]);
    assert_eq!((moved.volume(), moved.triangles), (8.0, cube.triangles.clone()));
    let mirrored = cube.transformed(-1.0, DVec3::Z, 0.0, DVec3::ZERO).unwrap();
    assert_eq!((mirrored.volume(), mirrored.bounds()), (1.0, [[-1.0; 3], [0.0; 3]]));
    assert_eq!(cube.transformed(1.0, DVec3::Y, 0.0, DVec3::ZERO).unwrap(), cube);
}

#[test]
fn a_transformation_welds_and_refuses() {
    let cube = cube();
    let again = Mesh::new(cube.vertices.clone(), [cube.triangles.clone(), vec![[0, 0, 1]]].concat()).unwrap();
    assert_eq!(again.left_out, 1);
    // The spacing of f32 at 1e8 is 8, so that the cube of side 5 ends in one point in x.
    let flat = again.transformed(5.0, DVec3::Z, 0.0, DVec3::new(1e8 + 8.0 - 2.5, 0.0, 0.0)).unwrap();
    assert_eq!((flat.vertices.len(), flat.triangles.len(), flat.left_out), (4, 4, 9));
    let plain = |scale, axis, turn, at| message(cube.transformed(scale, axis, turn, at));
    for scale in [0.0, f64::NAN, f64::INFINITY] {
        assert!(plain(scale, DVec3::Z, 0.0, DVec3::ZERO).starts_with("mesh.scale: "));
    }
    for axis in [DVec3::ZERO, DVec3::NAN, DVec3::new(1.0, f64::INFINITY, 0.0)] {
        assert!(plain(1.0, axis, 0.0, DVec3::ZERO).starts_with("mesh.axis: "));
    }
    assert!(plain(1.0, DVec3::Z, f64::NAN, DVec3::ZERO).starts_with("mesh.turn: "));
    assert!(plain(1.0, DVec3::Z, 0.0, DVec3::NAN).starts_with("mesh.at: "));
    assert!(plain(1e39, DVec3::Z, 0.0, DVec3::ZERO).starts_with("mesh.vertices: "));
    assert!(plain(1e-50, DVec3::Z, 0.0, DVec3::ZERO).starts_with("mesh.triangles: "));
}

#[test]
fn a_written_mesh_is_read_again() {
    for mesh in [cube(), tetrahedron(), Mesh::sphere(2.0, 2).unwrap(), Mesh::helix(0.1, 0.5, -0.3, 2.5, 7).unwrap()] {
        let bytes = mesh.to_stl();
        assert_eq!(Mesh::parse(&bytes, MeshFormat::Stl).unwrap(), mesh);
        assert!(!bytes.starts_with(b"solid"));
    }
    let normal: Vec<f32> = cube().to_stl()[84..96].chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
    assert_eq!(normal, [0.0, 0.0, -1.0]);
}

#[test]
fn a_cylinder_is_an_open_tube() {
    for facets in [3, 4, 100] {
        let tube = Mesh::cylinder(2.0, 5.0, facets).unwrap();
        assert_eq!((tube.vertices.len(), tube.triangles.len(), tube.left_out), (2 * facets as usize, 2 * facets as usize, 0));
        assert_eq!(open_edges(&tube), 2 * facets as usize);
        let n = f64::from(facets);
        close(tube.area(), n * 2.0 * 2.0 * (PI / n).sin() * 5.0, 1e-6);
        let [least, greatest] = tube.bounds();
        assert_eq!((least[2], greatest[0], greatest[2]), (0.0, 2.0, 5.0));
        // Normals point away from the axis.
        assert!(tube.corners().all(|[a, b, c]| (b - a).cross(c - a).dot((a + b + c) * DVec3::new(1.0, 1.0, 0.0)) > 0.0));
    }
    close(Mesh::cylinder(2.0, 5.0, 100).unwrap().area(), TAU * 2.0 * 5.0 * (1.0 - 1.645e-4), 1e-6);
    for (radius, length, facets, field) in
        [(0.0, 1.0, 8, "radius"), (f64::NAN, 1.0, 8, "radius"), (1.0, -1.0, 8, "length"), (1.0, 1.0, 2, "facets")]
    {
        assert!(message(Mesh::cylinder(radius, length, facets)).starts_with(&format!("cylinder.{field}: ")));
    }
}

#[test]
fn a_sphere_is_closed_and_round() {
    let mut last = None;
    for subdivisions in 0..5 {
        let sphere = Mesh::sphere(3.0, subdivisions).unwrap();
        let triangles = 20 << (2 * subdivisions);
        assert_eq!((sphere.triangles.len(), sphere.vertices.len()), (triangles, triangles / 2 + 2));
        if subdivisions < 3 {
            assert_eq!(open_edges(&sphere), 0);
        }
        assert!(sphere.vertices.iter().all(|vertex| (super::position(*vertex).length() - 3.0).abs() < 1e-6));
        let missing = 1.0 - sphere.area() / (4.0 * PI * 9.0);
        let missing_volume = 1.0 - sphere.volume() / (4.0 / 3.0 * PI * 27.0);
        assert!(missing > 0.0 && missing_volume > missing && missing_volume < 2.0 * missing, "{missing} {missing_volume}");
        match last {
            None => close(missing, 0.238, 0.01),
            Some(last) => close(missing, last / 4.0, 0.21),
        }
        last = Some(missing);
    }
    assert_eq!(Mesh::sphere(1.0, 8).unwrap().triangles.len(), 1_310_720);
    assert!(message(Mesh::sphere(1.0, 9)).starts_with("sphere.subdivisions: 9 "));
    assert!(message(Mesh::sphere(-1.0, 2)).starts_with("sphere.radius: "));
}

/// The area of a screw flight: the integral of `turns` sqrt((2 pi r)² + pitch²) over the radius.
fn flight(inner: f64, outer: f64, pitch: f64, turns: f64) -> f64 {
    let step = (outer - inner) / 10_000.0;
    let radii = (0..10_000).map(|number| inner + (f64::from(number) + 0.5) * step);
    radii.map(|r| turns * (TAU * r).hypot(pitch) * step).sum()
}

#[test]
fn a_helix_is_a_screw_flight() {
    for (inner, pitch, turns) in [(0.5, 1.5, 3.0), (0.5, -1.5, 2.3), (0.0, 0.7, 1.0), (0.0, -2.0, 0.4), (1.9, 0.1, 1.0)] {
        let error = |facets| {
            let mesh = Mesh::helix(inner, 2.0, pitch, turns, facets).unwrap();
            mesh.area() / flight(inner, 2.0, pitch, turns) - 1.0
        };
        assert!(error(100).abs() < 2e-3 && error(400).abs() < error(100).abs() / 12.0, "{} {}", error(100), error(400));
        let mesh = Mesh::helix(inner, 2.0, pitch, turns, 200).unwrap();
        let (steps, slope) = ((turns * 200.0).round() as usize, |r: f64| pitch.abs().atan2(TAU * r));
        let rings = ((slope(inner) - slope(2.0)) / TAU * 200.0).ceil() as usize;
        let expected = (2 * steps * rings, (steps + 1) * (rings + 1), 0);
        assert_eq!((mesh.triangles.len(), mesh.vertices.len(), mesh.left_out), expected);
        let [least, greatest] = mesh.bounds();
        assert_eq!((least[2], greatest[2]), (0.0, (pitch.abs() * turns) as f32));
        // Normals point up, except at the axis, and y is positive first if the screw is right-handed.
        let least = if inner == 0.0 { 0.0 } else { f64::MIN_POSITIVE };
        assert!(mesh.corners().all(|[a, b, c]| (b - a).cross(c - a).z >= least));
        assert!(
            mesh.vertices.iter().any(|[_, y, z]| f64::from(*z) < 0.2 * pitch.abs() && f64::from(*y) * pitch.signum() > 0.5)
        );
    }
}

#[test]
fn a_flat_helix_is_a_ring_or_a_disc() {
    let ring = Mesh::helix(1.0, 2.0, 0.0, 1.0, 100).unwrap();
    assert_eq!((ring.vertices.len(), ring.triangles.len(), open_edges(&ring)), (200, 200, 200));
    close(ring.area(), 3.0 * PI, 1e-3);
    let disc = Mesh::helix(0.0, 2.0, 0.0, 1.0, 100).unwrap();
    assert_eq!((disc.vertices.len(), disc.triangles.len(), disc.left_out, open_edges(&disc)), (101, 100, 0, 100));
    close(disc.area(), 4.0 * PI, 1e-3);
    let error = |inner, outer, pitch, turns, facets| message(Mesh::helix(inner, outer, pitch, turns, facets));
    assert!(error(-1.0, 2.0, 1.0, 1.0, 9).starts_with("helix.inner_radius: "));
    assert!(error(2.0, 2.0, 1.0, 1.0, 9).starts_with("helix.outer_radius: "));
    assert!(error(1.0, 2.0, f64::NAN, 1.0, 9).starts_with("helix.pitch: "));
    assert!(error(1.0, 2.0, 1.0, 0.0, 9).starts_with("helix.turns: "));
    assert!(error(1.0, 2.0, 0.0, 1.5, 9).starts_with("helix.turns: "));
    assert!(error(1.0, 2.0, 1.0, 1e9, 9).starts_with("helix.turns: "));
    assert!(error(1.0, 2.0, 1.0, 1.0, 0).starts_with("helix.facets: "));
}
