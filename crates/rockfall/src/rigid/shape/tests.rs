//! Bounds, mass and hulls against known values and random samples.

use std::sync::Arc;

use glam::{DVec3, Quat, Vec3};

use crate::rigid::collide::place;
use crate::rigid::pose::Pose;
use crate::rigid::shape::{Core, Hull, Shape};

/// A stream of numbers in [0, 1).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 24) as f32
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
    }

    pub(crate) fn turn(&mut self) -> Quat {
        let axis = self.vector(1.0).normalize_or(Vec3::X);
        Quat::from_axis_angle(axis, self.between(0.0, 6.3)).normalize()
    }
}

pub(crate) fn cube_points() -> Vec<Vec3> {
    (0..8).map(|k| Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32)).collect()
}

pub(crate) fn hull(points: &[Vec3]) -> Shape {
    let hull = Hull::new(points).expect("a hull").0;
    Shape { core: Core::Hull(Arc::new(hull)), radius: 0.0 }
}

/// A right prism with a regular base.
pub(crate) fn prism(sides: usize, radius: f32, half: f32) -> Vec<Vec3> {
    let corner = |k: usize, y: f32| {
        let (sin, cos) = (k as f32 / sides as f32 * std::f32::consts::TAU).sin_cos();
        Vec3::new(radius * cos, y, radius * sin)
    };
    (0..sides).flat_map(|k| [corner(k, -half), corner(k, half)]).collect()
}

#[test]
fn a_cube_of_points_has_six_faces() {
    let mut points = cube_points();
    points.extend([Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.5, 0.0, 0.0), Vec3::splat(0.4), Vec3::ZERO]);
    let (hull, centre) = Hull::new(&points).expect("a cube");
    assert_eq!((hull.vertices.len(), hull.faces.len(), hull.edges.len()), (8, 6, 12));
    assert!((centre - Vec3::splat(0.5)).length() < 1e-6, "{centre}");
    let (volume, inertia) = Shape { core: Core::Hull(Arc::new(hull)), radius: 0.0 }.mass();
    assert!((volume - 1.0).abs() < 1e-6);
    assert!((inertia.x_axis - DVec3::new(1.0 / 6.0, 0.0, 0.0)).length() < 1e-6, "{inertia}");
}

/// Points in the middle of edges and faces are no vertices, even where they come first.
#[test]
fn only_corners_are_vertices() {
    let mut random = Random(6);
    for round in 0..300 {
        let (most_zeros, turn) = (1 + round % 3, random.turn());
        let lattice = (0..27).map(|k| Vec3::new((k % 3) as f32, (k / 3 % 3) as f32, (k / 9) as f32) - 1.0);
        let mut points: Vec<Vec3> =
            lattice.filter(|p| p.to_array().iter().filter(|x| **x == 0.0).count() <= most_zeros).collect();
        points.sort_by_key(|p| (p.length() * 1000.0) as u32);
        points.rotate_left((round / 3) % 12);
        points.iter_mut().for_each(|p| *p = turn * (*p * Vec3::new(3.0, 0.2, 1.0)));
        let hull = Hull::new(&points).expect("a box").0;
        assert_eq!((hull.vertices.len(), hull.faces.len(), hull.edges.len()), (8, 6, 12));
        assert!(hull.faces.iter().all(|(_, corners)| corners.len() == 4));
    }
}

#[test]
fn bad_points_are_refused() {
    let flat: Vec<Vec3> = cube_points().iter().map(|p| Vec3::new(p.x, p.y, 0.3 * p.x + 0.1 * p.y)).collect();
    assert!(Hull::new(&flat).unwrap_err().to_string().contains("one plane"));
    assert!(Hull::new(&[Vec3::X; 9]).unwrap_err().to_string().contains("one plane"));
    assert!(Hull::new(&cube_points()[..3]).unwrap_err().to_string().contains("expected 4 to"));
    let line: Vec<Vec3> = (0..9).map(|k| Vec3::new(k as f32, 0.1 * k as f32, 0.0)).collect();
    assert!(Hull::new(&line).is_err());
    let mut points = cube_points();
    points[3].x = f32::NAN;
    assert!(Hull::new(&points).unwrap_err().to_string().contains("finite"));
    let error = Hull::new(&prism(31, 1.0, 0.5)).unwrap_err().to_string();
    assert!(error.contains("33 faces"), "{error}");
    assert_eq!(Hull::new(&prism(30, 1.0, 0.5)).expect("32 faces").0.edges.len(), 90);
}

/// All points inside, all vertices among the points, all loops convex, and Euler's formula.
#[test]
fn hulls_of_random_points_are_convex() {
    let mut random = Random(7);
    let mut built = 0;
    for round in 0..400 {
        let size = 10f32.powi(round % 6 - 3);
        let stretch = Vec3::new(1.0, 1.0, if round % 3 == 0 { 0.01 } else { 1.0 });
        let shift = random.vector(10.0 * size);
        let points: Vec<Vec3> = (0..4 + round % 14).map(|_| shift + random.vector(size) * stretch).collect();
        let Ok((hull, centre)) = Hull::new(&points) else { continue };
        built += 1;
        assert_eq!(hull.vertices.len() + hull.faces.len(), hull.edges.len() + 2);
        for (normal, corners) in &hull.faces {
            let anchor = hull.vertices[corners[0] as usize];
            for point in &points {
                assert!((*point - centre - anchor).dot(*normal) < 1e-5 * size, "round {round}");
            }
            for corner in corners {
                assert!((hull.vertices[*corner as usize] - anchor).dot(*normal).abs() < 1e-5 * size);
            }
        }
        for [from, to, left, right] in &hull.edges {
            let has = |face: u8, corner: u8| hull.faces[face as usize].1.contains(&corner);
            assert!([left, right].iter().all(|face| has(**face, *from) && has(**face, *to)));
        }
    }
    assert!(built > 350, "{built}");
}

/// Mass of rounded shapes against sums over points of a grid.
#[test]
fn mass_agrees_with_samples() {
    let shapes = [
        Shape::ball(0.7),
        Shape::capsule(0.6, 0.4),
        Shape::cuboid(Vec3::new(0.3, 0.9, 0.5)),
        Shape { core: Core::Box { half: Vec3::new(0.3, 0.7, 0.5) }, radius: 0.25 },
        hull(&prism(5, 0.8, 0.6)),
        Shape { radius: 0.2, ..hull(&prism(5, 0.6, 0.5)) },
    ];
    for shape in &shapes {
        let (volume, inertia) = shape.mass();
        let mut random = Random(1);
        let (count, size) = (80, 1.2137);
        let cell = (2.0 * size / count as f64).powi(3);
        let (mut sum, mut moments) = (0.0, DVec3::ZERO);
        for index in 0..count * count * count {
            let cells = [index % count, index / count % count, index / count / count];
            let p = DVec3::from_array(cells.map(|k| size * (2.0 * (k as f64 + random.unit() as f64) / count as f64 - 1.0)));
            if place(shape, p.as_vec3()).is_some_and(|place| place.distance <= 0.0) {
                sum += cell;
                moments += cell * p * p;
            }
        }
        let expected = DVec3::new(moments.y + moments.z, moments.z + moments.x, moments.x + moments.y);
        assert!((sum / volume - 1.0).abs() < 0.002, "{shape:?}: {sum} {volume}");
        let got = DVec3::new(inertia.x_axis.x, inertia.y_axis.y, inertia.z_axis.z);
        assert!(((got - expected) / expected).abs().max_element() < 0.005, "{shape:?}: {got} {expected}");
    }
}

#[test]
fn bounds_touch_the_shape() {
    let mut random = Random(3);
    let shapes = [
        Shape::ball(0.7),
        Shape::capsule(0.6, 0.4),
        Shape { core: Core::Box { half: Vec3::new(0.3, 0.7, 0.5) }, radius: 0.25 },
        Shape {
            core: Core::Face {
                u: Vec3::new(1.0, 0.5, 0.0),
                v: Vec3::new(-0.2, 0.9, 0.0),
                is_triangle: false,
                one_sided: false,
                is_facet: false,
            },
            radius: 0.1,
        },
        hull(&prism(7, 0.8, 0.6)),
    ];
    for shape in &shapes {
        let pose = Pose::new(random.vector(5.0), random.turn());
        let bounds = shape.aabb(&pose);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            // A ball far out along an axis is as far from the shape as from the bound, to second order.
            let far = 2000.0;
            let face = if axis.min_element() < 0.0 { bounds.min } else { bounds.max };
            let centre = pose.position + axis * far;
            let gap = place(shape, pose.inner(centre)).expect("a place").distance;
            assert!((gap - (centre - face).dot(axis)).abs() < 2e-3, "{shape:?} {axis} {gap}");
        }
        assert!(bounds.max.distance(pose.position) <= 2.0 * shape.extent());
    }
    let plane = Shape { core: Core::HalfSpace, radius: 0.0 };
    let bounds = plane.aabb(&Pose::new(Vec3::new(0.0, 2.0, 0.0), Quat::IDENTITY));
    assert_eq!((bounds.max.y, bounds.min.y), (2.0, f32::NEG_INFINITY));
    let side = plane.aabb(&Pose::new(Vec3::X, Quat::from_rotation_z(std::f32::consts::FRAC_PI_2)));
    assert!((side.min.x - 1.0).abs() < 1e-6 && side.max == Vec3::INFINITY);
    assert_eq!(plane.aabb(&Pose::new(Vec3::X, Quat::from_rotation_z(0.3))).max, Vec3::INFINITY);
    assert_eq!((plane.extent(), plane.mass().0), (f32::INFINITY, 0.0));
    assert!((hull(&prism(4, 2f32.sqrt(), 3.0)).width() - 2.0).abs() < 1e-5);
}

/// A rounded box in closed form and as a hull.
#[test]
fn a_rounded_hull_weighs_as_much_as_a_rounded_box() {
    let half = Vec3::new(0.5, 0.3, 0.2);
    let corners: Vec<Vec3> = cube_points().iter().map(|p| (*p * 2.0 - 1.0) * half).collect();
    for radius in [0.01, 0.3, 3.0] {
        let (volume, inertia) = Shape { core: Core::Box { half }, radius }.mass();
        let (other, about) = Shape { radius, ..hull(&corners) }.mass();
        assert!((other / volume - 1.0).abs() < 1e-6, "{other} {volume}");
        let error = (about - inertia) * (1.0 / inertia.x_axis.x);
        assert!(error.to_cols_array().iter().all(|part| part.abs() < 1e-3), "{error}");
    }
}
