//! Contacts judged by nature: against distances by trying everything, and by what swaps and moves must not change.

mod figures;
mod sizes;

use glam::{Quat, Vec3};

use crate::rigid::collide::{Manifold, collide, nearest, reference};
use crate::rigid::pose::Pose;
use crate::rigid::shape::tests::{Random, hull, prism};
use crate::rigid::shape::{Core, Shape};

pub(super) fn separations(manifold: &Manifold) -> impl Iterator<Item = f32> {
    manifold.points[..manifold.count].iter().map(|point| (point.on_b - point.on_a).dot(manifold.normal))
}

/// What holds for all manifolds: unit normals, points on both surfaces and within reach, ids that differ.
pub(super) fn check(a: &Shape, b: &Shape, pose: &Pose, reach: f32, found: &Manifold) {
    let scale = pose.position.length()
        + if a.extent() < 1e9 { a.extent() } else { 0.0 }
        + if b.extent() < 1e9 { b.extent() } else { 0.0 };
    let width = a.width().min(b.width()).min(1e9);
    let tolerance = 1e-5 * scale + 1e-4 * width;
    assert!((1..=4).contains(&found.count));
    assert!((found.normal.length() - 1.0).abs() < 1e-5, "{}", found.normal);
    for (index, point) in found.points[..found.count].iter().enumerate() {
        assert!(point.on_a.is_finite() && point.on_b.is_finite());
        let gap = (point.on_b - point.on_a).dot(found.normal);
        assert!(gap <= reach + tolerance, "{gap} beyond {reach}");
        let aside = (point.on_b - point.on_a).reject_from_normalized(found.normal).length();
        assert!(aside <= tolerance, "points are {aside} aside of the normal");
        assert!(found.points[..index].iter().all(|other| other.id != point.id), "{:x} twice", point.id);
        for (shape, place) in [(a, point.on_a), (b, pose.inner(point.on_b))] {
            if let Some(near) = nearest(&shape.core, place) {
                let off = near.place.distance(place);
                let is_inside = off > shape.radius + tolerance && shape.radius == 0.0;
                assert!(!is_inside, "a point is {off} from the surface of {shape:?}");
                // Capsules side by side may be askew by 1 % of their radii.
                assert!(off <= 1.001 * shape.radius + tolerance, "{off} {shape:?}");
            }
        }
    }
}

/// Both orders of a pair agree.
pub(super) fn check_swap(a: &Shape, b: &Shape, pose: &Pose, reach: f32, found: &Option<Manifold>) {
    let back = pose.relative(&Pose::IDENTITY);
    let other = collide(b, a, &back, reach);
    assert_eq!(found.is_some(), other.is_some(), "only one order has contacts");
    if let (Some(found), Some(other)) = (found, other) {
        let tolerance = 1e-5 * (pose.position.length() + 1.0);
        check(b, a, &back, reach, &other);
        assert!((found.least() - other.least()).abs() <= tolerance + 0.01 + 0.1 * found.least().abs(), "{found:?} {other:?}");
    }
}

/// Shapes of all kinds with about unit size.
pub(super) fn shapes(random: &mut Random) -> Vec<Shape> {
    let half = Vec3::new(random.between(0.1, 1.0), random.between(0.1, 1.0), random.between(0.1, 1.0));
    let points: Vec<Vec3> = (0..8).map(|_| random.vector(0.8)).collect();
    let (u, v) =
        (Vec3::new(random.between(0.3, 1.0), random.between(-0.2, 0.2), 0.0), Vec3::new(0.1, random.between(0.3, 1.0), 0.0));
    vec![
        Shape::ball(random.between(0.1, 1.0)),
        Shape::capsule(random.between(0.1, 1.0), random.between(0.1, 0.5)),
        Shape::cuboid(half),
        Shape { core: Core::Box { half: half * 0.7 }, radius: random.between(0.02, 0.3) },
        Shape { core: Core::Face { u, v, is_triangle: false, one_sided: false, is_facet: false }, radius: 0.0 },
        Shape { core: Core::Face { u, v, is_triangle: false, one_sided: false, is_facet: false }, radius: 0.1 },
        Shape { core: Core::Face { u, v, is_triangle: true, one_sided: false, is_facet: false }, radius: 0.0 },
        hull(&points),
        hull(&prism(3 + random.between(0.0, 6.0) as usize, 0.7, 0.5)),
        Shape { radius: 0.15, ..hull(&points) },
    ]
}

pub(super) fn describe(a: &Shape, b: &Shape, pose: &Pose) -> String {
    let name = |shape: &Shape| match &shape.core {
        Core::Hull(hull) => format!("hull {:?}+{}", hull.vertices, shape.radius),
        core => format!("{core:?}+{}", shape.radius),
    };
    format!("{} / {} / {pose:?}", name(a), name(b))
}

/// Whether a pair of kinds takes part in a test.
type Filter = fn(&Shape, &Shape) -> bool;

/// The least separation is the distance by trying everything, up to the preference for faces.
fn try_all(rounds: u32, filter: Filter) {
    let mut random = Random(11);
    let (mut tried, mut touched) = (0, 0);
    for _ in 0..rounds {
        let (first, second) = (shapes(&mut random), shapes(&mut random));
        for (a, b) in first.iter().flat_map(|a| second.iter().map(move |b| (a, b))) {
            if !filter(a, b) {
                continue;
            }
            let mut pose = Pose::new(random.vector(1.0).normalize_or(Vec3::X), random.turn());
            pose.position *= random.between(0.2, 1.0) * (a.extent() + b.extent());
            let reach = random.between(0.0, 0.4);
            let gap = reference::gap(&reference::vertices(a, &Pose::IDENTITY), &reference::vertices(b, &pose));
            let gap = gap as f32 - a.radius - b.radius;
            let found = collide(a, b, &pose, reach);
            let text = || format!("gap {gap} reach {reach} found {found:?}\n{}", describe(a, b, &pose));
            let result = std::panic::catch_unwind(|| {
                let size = a.width().max(0.05).min(b.width().max(0.05));
                let slack = 0.08 * gap.abs() + 0.03 * size;
                match &found {
                    None => assert!(gap > reach - slack, "missed"),
                    Some(found) => {
                        check(a, b, &pose, reach, found);
                        assert!((found.least() - gap).abs() <= slack, "least {} gap {gap}", found.least());
                    }
                }
                check_swap(a, b, &pose, reach, &found);
            });
            assert!(result.is_ok(), "{}", text());
            touched += found.is_some() as u32;
            tried += 1;
        }
    }
    assert!(touched > tried / 4, "{touched} of {tried}");
}

fn is_sharp_box(shape: &Shape) -> bool {
    matches!(shape.core, Core::Box { .. }) && shape.radius == 0.0
}

#[test]
fn separations_of_boxes_are_distances() {
    try_all(3000, |a, b| is_sharp_box(a) && is_sharp_box(b));
}

#[test]
fn separations_of_balls_are_distances() {
    try_all(300, |a, b| matches!(a.core, Core::Point) || matches!(b.core, Core::Point));
}

fn is_polyhedron(shape: &Shape) -> bool {
    matches!(shape.core, Core::Box { .. } | Core::Hull(_) | Core::Face { .. })
}

fn is_face(shape: &Shape) -> bool {
    matches!(shape.core, Core::Face { .. })
}

#[test]
fn separations_of_polyhedra_are_distances() {
    try_all(30, |a, b| is_polyhedron(a) && is_polyhedron(b) && !is_face(a) && !is_face(b));
}

#[test]
fn separations_of_faces_are_distances() {
    try_all(40, |a, b| is_polyhedron(a) && is_polyhedron(b) && is_face(a) != is_face(b));
}

fn is_capsule(shape: &Shape) -> bool {
    matches!(shape.core, Core::Segment { .. })
}

#[test]
fn separations_of_capsules_are_distances() {
    try_all(60, |a, b| is_capsule(a) || is_capsule(b));
}

/// A measurement: run with `--ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn time_of_pairs() {
    let mut random = Random(1);
    let half = Vec3::new(0.25, 0.15, 0.2);
    let brick = Shape::cuboid(half);
    let kinds = [
        ("boxes", brick.clone(), brick.clone()),
        ("box and capsule", brick.clone(), Shape::capsule(0.2, 0.15)),
        ("box and ball", brick.clone(), Shape::ball(0.2)),
        ("rounded boxes", Shape { radius: 0.02, ..brick.clone() }, Shape { radius: 0.02, ..brick.clone() }),
        ("prisms of 6", hull(&prism(6, 0.2, 0.2)), hull(&prism(6, 0.2, 0.2))),
        ("prisms of 30", hull(&prism(30, 0.2, 0.2)), hull(&prism(30, 0.2, 0.2))),
    ];
    for (name, a, b) in &kinds {
        // Neighbours in a pile: nearly aligned, most of them with a common face, some diagonal.
        let poses: Vec<Pose> = (0..2000)
            .map(|k| {
                let step = Vec3::new((k % 3) as f32 - 1.0, (k / 3 % 3) as f32 - 1.0, (k / 9 % 3) as f32 - 1.0);
                let step = if step == Vec3::ZERO { Vec3::Y } else { step };
                let tilt = Quat::from_scaled_axis(random.vector(if k % 4 == 0 { 1.0 } else { 0.01 }));
                Pose::new(step * 2.0 * half + random.vector(0.02), tilt)
            })
            .collect();
        for reach in [0.01, 0.05] {
            let mut time = f64::INFINITY;
            let mut count = 0;
            for _ in 0..50 {
                let start = std::time::Instant::now();
                count = poses.iter().filter(|pose| collide(a, b, pose, reach).is_some()).count();
                time = time.min(start.elapsed().as_secs_f64() / poses.len() as f64);
            }
            println!("{name}, reach {reach}: {:.0} ns a pair, {} % touch", time * 1e9, count * 100 / poses.len());
        }
    }
}
