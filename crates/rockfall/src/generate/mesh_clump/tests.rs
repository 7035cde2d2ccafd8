use glam::DQuat;

use super::*;

/// Ten times as coarse as usual.
fn coarse(spheres: u32) -> MeshClump {
    MeshClump { cells: 100_000, ..MeshClump::new(spheres) }
}

/// A box from the origin, with outward triangles.
fn block(size: [f32; 3]) -> Mesh {
    let corner = |bits: u32| [0, 1, 2].map(|axis| if bits >> axis & 1 == 1 { size[axis] } else { 0.0 });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

/// An ellipsoid with these half axes along turned axes, away from the origin.
fn ellipsoid(half: DVec3) -> Mesh {
    let ball = Mesh::sphere(1.0, 4).unwrap();
    let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -0.8, 0.4));
    let moved = |vertex: &[f32; 3]| {
        let point = turn * (half * DVec3::from_array(vertex.map(f64::from))) + DVec3::new(5.0, -2.0, 3.0);
        point.as_vec3().to_array()
    };
    Mesh::new(ball.vertices.iter().map(moved).collect(), ball.triangles).unwrap()
}

#[track_caller]
fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected}");
}

#[test]
fn mass_centre_and_inertia_are_those_of_the_mesh() {
    let clump = MeshClump { density: 3.0, ..coarse(2) }.fit(&block([1.0, 2.0, 4.0])).unwrap();
    near(clump.solid.mass, 24.0, 1e-9);
    let expected = [[0.5, 1.0, 2.0].to_vec(), [40.0, 34.0, 10.0, 0.0, 0.0, 0.0].to_vec()].concat();
    let found = [clump.solid.centre.to_vec(), clump.solid.inertia.to_vec()].concat();
    found.iter().zip(expected).for_each(|(found, expected)| near(*found, expected, 1e-9));
    let given = clump.shape.mass_properties_of().unwrap();
    near(given.mass, 24.0, 1e-5);
    // An ellipsoid whose axes are turned, from a mesh with 5,120 triangles.
    let half = DVec3::new(1.0, 2.0, 3.0);
    let clump = coarse(2).fit(&ellipsoid(half)).unwrap();
    let mass = clump.solid.mass;
    near(mass, 4.0 / 3.0 * std::f64::consts::PI * 6.0, 0.01 * mass);
    let moments = ascending(clump.solid);
    for (found, [a, b]) in moments.iter().zip([[1.0, 2.0], [1.0, 3.0], [2.0, 3.0]]) {
        near(*found, mass / 5.0 * (a * a + b * b), 0.01 * found);
    }
    near(clump.solid.centre[0], 5.0, 1e-3);
    // Triangles that are all clockwise give the same body.
    let mut mirrored = block([1.0, 2.0, 4.0]);
    mirrored.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    assert_eq!(coarse(2).fit(&mirrored).unwrap().solid, coarse(2).fit(&block([1.0, 2.0, 4.0])).unwrap().solid);
}

#[test]
fn one_sphere_is_the_largest_one_inside() {
    let ball = coarse(1).fit(&Mesh::sphere(0.5, 5).unwrap()).unwrap();
    near(f64::from(ball.shape.spheres[0].radius), 0.5, 0.005);
    near(ball.volume_error, 0.0, 0.02);
    let cube = coarse(1).fit(&block([2.0; 3])).unwrap();
    near(f64::from(cube.shape.spheres[0].radius), 1.0, 0.01);
    near(cube.volume_error, std::f64::consts::FRAC_PI_6 - 1.0, 0.005);
}

#[test]
fn more_spheres_make_the_errors_smaller() {
    for (mesh, last) in [(block([1.0; 3]), 0.12), (ellipsoid(DVec3::new(1.0, 2.0, 3.0)), 0.12), (block([1.0, 2.0, 0.5]), 0.16)]
    {
        let fits = [1, 4, 16, 64, 256].map(|spheres| coarse(spheres).fit(&mesh).unwrap());
        for pair in fits.windows(2) {
            let [few, many] = [&pair[0], &pair[1]];
            assert!(many.volume_error > few.volume_error && many.volume_error < 0.005, "{few} {many}");
            let worst = |fit: &MeshClumpFit| fit.inertia_errors.map(f64::abs).into_iter().fold(0.0, f64::max);
            assert!(worst(many) < worst(few), "{few} {many}");
            // The first spheres are the same.
            assert_eq!(few.shape.spheres[..], many.shape.spheres[..few.shape.spheres.len()]);
        }
        assert!(fits[4].volume_error.abs() < last, "{}", fits[4]);
    }
}

#[test]
fn spheres_are_inside_and_overlap_as_asked() {
    let mesh = ellipsoid(DVec3::new(1.0, 2.0, 3.0));
    let nearest = Nearest::new(&mesh);
    for overlap in [0.0, 0.3, 0.6] {
        let fit = MeshClump { overlap, min_radius: 0.15, ..coarse(40) }.fit(&mesh).unwrap();
        let spheres = &fit.shape.spheres;
        assert!(spheres.len() > 5, "{fit}");
        for (number, sphere) in spheres.iter().enumerate() {
            let room = nearest.distance(sphere.centre.as_dvec3());
            assert!(f64::from(sphere.radius) <= room + 1e-5 && sphere.radius >= 0.15, "{sphere:?} {room}");
            for other in &spheres[..number] {
                let distance = sphere.centre.distance(other.centre);
                assert!(distance >= sphere.radius + (1.0 - overlap) * other.radius - 1e-5, "{overlap}: {sphere:?} {other:?}");
            }
        }
    }
}

#[test]
fn wrong_meshes_and_numbers_are_refused() {
    let cube = block([1.0; 3]);
    let wrong = |clump: MeshClump, mesh: &Mesh| clump.fit(mesh).unwrap_err().to_string();
    assert!(wrong(coarse(0), &cube).starts_with("spheres: 0 is not allowed, expected a whole number from 1 to 1000"));
    assert!(wrong(coarse(1001), &cube).starts_with("spheres: 1001 is not allowed"));
    assert!(wrong(MeshClump { overlap: 1.0, ..coarse(1) }, &cube).contains("overlap: 1 is not allowed"));
    assert!(wrong(MeshClump { min_radius: f32::NAN, ..coarse(1) }, &cube).contains("min_radius: NaN"));
    assert!(wrong(MeshClump { min_radius: 0.6, ..coarse(1) }, &cube).contains("less than the radius of the largest sphere"));
    assert!(wrong(MeshClump { density: 0.0, ..coarse(1) }, &cube).contains("density: 0"));
    assert!(wrong(MeshClump { cells: 5, ..coarse(1) }, &cube).contains("cells: 5"));
    let open = Mesh::new(cube.vertices.clone(), cube.triangles[1..].to_vec()).unwrap();
    let message = wrong(coarse(1), &open);
    assert!(
        message.contains("not closed, with 3 open edges such as from [") && message.contains("expected a closed mesh"),
        "{message}"
    );
    let mut turned = cube.clone();
    turned.triangles[0].swap(0, 1);
    assert!(wrong(coarse(1), &turned).contains("3 edges between triangles of opposite sense"));
    let flat = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2], [0, 2, 1]]).unwrap();
    assert!(wrong(coarse(1), &flat).contains("expected a mesh that encloses a volume"));
}

#[test]
fn the_scene_runs_and_the_clump_comes_to_rest_on_the_floor() {
    for size in [0.01, 1.0, 100.0] {
        let fit = coarse(20).fit(&block([size, 2.0 * size, size])).unwrap();
        let scene = fit.scene(3).unwrap();
        assert_ne!(scene.to_text(), fit.scene(4).unwrap().to_text());
        let read = Scene::parse(&scene.to_text(), std::path::Path::new("clump")).unwrap();
        assert_eq!(read.scene.counts(), scene.counts());
        let (dt, steps) = (scene.run.dt.unwrap(), scene.run.steps.unwrap());
        let options = crate::Options::new().backend(crate::Backend::Cpu);
        let mut simulation = crate::Simulation::with_options(read.scene, options).unwrap();
        simulation.run(steps, dt).unwrap();
        let scene = simulation.sync().unwrap();
        let body = &scene.bodies()[0];
        let low = scene.spheres().iter().map(|sphere| sphere.position.y - sphere.radius).fold(f32::MAX, f32::min);
        assert!(low.abs() < 0.02 * size, "{size}: {low}");
        assert!(body.velocity.length() < 0.1 * size.sqrt(), "{size}: {}", body.velocity);
    }
}

#[test]
fn the_distance_from_a_triangle_has_its_three_cases() {
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let found = |x: f64, y: f64, z: f64| nearest::distance(triangle, DVec3::new(x, y, z));
    near(found(0.2, 0.3, -0.7), 0.7, 1e-12);
    near(found(0.5, -3.0, 4.0), 5.0, 1e-12);
    near(found(4.0, -4.0, 0.0), 5.0, 1e-12);
    near(found(1.0, 1.0, 0.0), 0.5_f64.sqrt(), 1e-12);
}
