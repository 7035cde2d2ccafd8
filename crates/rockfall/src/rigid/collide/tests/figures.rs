//! Single contacts whose points are known.

use glam::{Quat, Vec3};

use crate::rigid::collide::tests::{check, check_swap, separations};
use crate::rigid::collide::{collide, reference};
use crate::rigid::pose::Pose;
use crate::rigid::shape::tests::{Random, hull, prism};
use crate::rigid::shape::{Core, Shape};

const EIGHTH: f32 = std::f32::consts::FRAC_PI_4;

fn half_space() -> Shape {
    Shape { core: Core::HalfSpace, radius: 0.0 }
}

fn square(one_sided: bool) -> Shape {
    Shape { core: Core::Face { u: Vec3::X, v: Vec3::Y, is_triangle: false, one_sided, is_facet: false }, radius: 0.0 }
}

fn at(x: f32, y: f32, z: f32) -> Pose {
    Pose::new(Vec3::new(x, y, z), Quat::IDENTITY)
}

#[test]
fn a_box_on_a_box_has_the_corners_of_the_overlap() {
    let (a, b) = (Shape::cuboid(Vec3::new(1.0, 0.5, 2.0)), Shape::cuboid(Vec3::new(1.0, 0.5, 1.0)));
    let pose = at(0.5, 1.01, 0.2);
    let found = collide(&a, &b, &pose, 0.05).expect("contacts");
    assert_eq!((found.count, found.normal), (4, Vec3::Y));
    for corner in [(-0.5, -0.8), (1.0, -0.8), (-0.5, 1.2), (1.0, 1.2)] {
        let corner = Vec3::new(corner.0, 0.51, corner.1);
        assert!(found.points.iter().any(|point| point.on_b.distance(corner) < 1e-5), "{found:?}");
    }
    assert!(separations(&found).all(|gap| (gap - 0.01).abs() < 1e-5));
}

/// Turned by 45 degrees about the normal, faces overlap in an octagon, of which four corners stay.
#[test]
fn a_turned_box_on_a_box_has_four_points_around_its_centre() {
    let (a, b) = (Shape::cuboid(Vec3::new(1.0, 0.5, 1.0)), Shape::cuboid(Vec3::new(1.0, 0.5, 1.0)));
    for (a, b) in [(a.clone(), b.clone()), (hull(&prism(4, 2f32.sqrt(), 0.5)), b)] {
        let pose = Pose::new(Vec3::new(0.0, 0.99, 0.0), Quat::from_rotation_y(if a.is_round() { 0.0 } else { EIGHTH }));
        let found = collide(&a, &b, &pose, 0.05).expect("contacts");
        assert_eq!(found.count, 4);
        assert!(separations(&found).all(|gap| (gap + 0.01).abs() < 1e-5));
        let middle = found.points.iter().map(|point| point.on_a).sum::<Vec3>() / 4.0;
        assert!(Vec3::new(middle.x, 0.0, middle.z).length() < 0.35, "{middle}");
        check(&a, &b, &pose, 0.05, &found);
    }
}

#[test]
fn crossing_edges_have_one_point() {
    let cube = Shape::cuboid(Vec3::ONE);
    let other = hull(&prism(4, 2f32.sqrt(), 1.0).iter().map(|p| Quat::from_rotation_y(EIGHTH) * *p).collect::<Vec<_>>());
    for (a, b) in [(&cube, &cube), (&cube, &other), (&other, &cube), (&other, &other)] {
        // An edge of a along z on top, an edge of b along x below.
        let stand = Quat::from_rotation_z(EIGHTH);
        let lie = Quat::from_rotation_x(EIGHTH);
        for gap in [0.02, -0.02] {
            let pose = Pose::new(stand.inverse() * Vec3::new(0.3, 2.0 * 2f32.sqrt() + gap, 0.1), stand.inverse() * lie);
            let found = collide(a, b, &pose, 0.1).expect("a contact");
            assert_eq!(found.count, 1);
            assert!((found.least() - gap).abs() < 1e-5);
            assert!((stand * found.normal).distance(Vec3::Y) < 1e-5, "{}", found.normal);
            assert!((stand * found.points[0].on_a).distance(Vec3::new(0.0, 2f32.sqrt(), 0.1)) < 1e-5);
            check_swap(a, b, &pose, 0.1, &Some(found));
        }
    }
}

#[test]
fn balls_meet_everything() {
    let ball = Shape::ball(0.5);
    let found = collide(&ball, &Shape::ball(0.25), &at(0.0, 0.0, 0.8), 0.1).expect("a contact");
    assert_eq!((found.normal, found.points[0].on_a), (Vec3::Z, Vec3::new(0.0, 0.0, 0.5)));
    assert!((found.least() - 0.05).abs() < 1e-6);
    assert_eq!(collide(&ball, &ball, &Pose::IDENTITY, 0.1).expect("concentric").normal, Vec3::Y);
    assert!(collide(&ball, &ball, &at(1.2, 0.0, 0.0), 0.1).is_none());
    // Inside a box and a hull: out of the nearest face.
    for block in [Shape::cuboid(Vec3::ONE), hull(&prism(4, 2f32.sqrt(), 1.0))] {
        let found = collide(&block, &ball, &at(0.0, -0.7, 0.1), 0.1).expect("inside");
        assert!(found.normal.distance(-Vec3::Y) < 1e-6, "{found:?}");
        assert!((found.least() + 0.8).abs() < 1e-6);
    }
    // From its axis a capsule has no direction of its own.
    let inside = collide(&Shape::capsule(1.0, 0.2), &ball, &at(0.0, 0.5, 0.0), 0.1).expect("inside");
    assert!((inside.least() + 0.7).abs() < 1e-6 && inside.normal.y == 0.0);
    let found = collide(&half_space(), &ball, &at(3.0, 0.45, 1.0), 0.1).expect("a contact");
    assert_eq!((found.normal, found.points[0].on_a), (Vec3::Y, Vec3::new(3.0, 0.0, 1.0)));
    assert!((collide(&ball, &half_space(), &at(0.0, -0.45, 1.0), 0.1).expect("a contact").normal + Vec3::Y).length() < 1e-6);
}

#[test]
fn one_sided_faces_have_one_side() {
    let movers = [Shape::ball(0.3), Shape::capsule(0.4, 0.3), Shape::cuboid(Vec3::splat(0.3)), hull(&prism(5, 0.3, 0.3))];
    for mover in &movers {
        let turn = Quat::from_rotation_z(0.3);
        for (z, expected) in [(0.2, Some(1.0)), (-0.2, None)] {
            let pose = Pose::new(Vec3::new(0.1, 0.2, z), turn);
            let one = collide(&square(true), mover, &pose, 0.05);
            assert_eq!(one.map(|found| found.normal.z), expected, "{mover:?}");
            let two = collide(&square(false), mover, &pose, 0.05).expect("two sides");
            assert!((two.normal.z - z.signum()).abs() < 1e-6, "{mover:?} {two:?}");
            check_swap(&square(false), mover, &pose, 0.05, &Some(two));
            check_swap(&square(true), mover, &pose, 0.05, &one);
        }
        assert!(collide(&square(true), mover, &at(5.0, 0.0, 0.1), 0.05).is_none());
    }
}

/// The nearest of many points of a cone, by search.
fn nearest_by_search(half: f32, [low, high]: [f32; 2], point: Vec3) -> f32 {
    let along = (0..=400).map(|k| k as f32 / 400.0);
    let on_edge = |share: f32| (low + (high - low) * share, (2.0 * share - 1.0) * half);
    let away = |(radius, y): (f32, f32)| {
        let around = (0..720).map(|k| (std::f32::consts::TAU * k as f32 / 720.0).sin_cos());
        around.map(|(z, x)| point.distance(Vec3::new(radius * x, y, radius * z))).fold(f32::INFINITY, f32::min)
    };
    along.map(on_edge).map(away).fold(f32::INFINITY, f32::min)
}

#[test]
fn balls_touch_cones_and_bowls_at_the_nearest_place_on_one_side() {
    let mut random = Random(11);
    let ball = Shape::ball(0.3);
    let (mut touched, mut free) = (0, 0);
    for _ in 0..60 {
        let (half, radii) = (random.between(0.3, 2.0), [random.between(0.4, 2.0), random.between(0.0, 2.0)]);
        let centre = random.vector(2.0);
        let distance = nearest_by_search(half, radii, centre);
        let [inner, outer] = [true, false].map(|inside| {
            let wall = Shape { core: Core::Cone { half, radii, inside }, radius: 0.0 };
            let pose = Pose::new(centre, Quat::IDENTITY);
            let found = collide(&wall, &ball, &pose, 10.0);
            check_swap(&wall, &ball, &pose, 10.0, &found);
            found
        });
        // One side has it, the other has none.
        assert!(inner.is_some() != outer.is_some(), "{half} {radii:?} {centre}");
        let found = inner.or(outer).expect("a place");
        assert!((found.least() + 0.3 - distance).abs() < 1e-2, "{half} {radii:?} {centre}: {found:?} for {distance}");
        *if inner.is_some() { &mut touched } else { &mut free } += 1;
        // A box touches facets instead.
        let wall = Shape { core: Core::Cone { half, radii, inside: true }, radius: 0.0 };
        assert!(collide(&wall, &Shape::cuboid(Vec3::ONE), &Pose::new(centre, Quat::IDENTITY), 10.0).is_none());
    }
    assert!(touched > 10 && free > 10, "{touched} {free}");
    let bowl = Shape { core: Core::Bowl { radius: 2.0 }, radius: 0.0 };
    let found = collide(&bowl, &ball, &at(0.0, -1.8, 0.0), 0.0).expect("a contact");
    assert!((found.least() + 0.1).abs() < 1e-6 && found.normal == Vec3::Y, "{found:?}");
    assert!(collide(&bowl, &ball, &at(0.0, -2.1, 0.0), 1.0).is_none());
    assert!(collide(&bowl, &ball, &at(0.0, 0.0, 0.0), 2.0).is_some(), "at the centre it has some direction");
}

#[test]
fn capsules_lie_on_two_points() {
    let capsule = Shape::capsule(0.5, 0.2);
    let lie = Quat::from_rotation_z(2.0 * EIGHTH);
    let grounds = [
        (half_space(), 0.0),
        (Shape::cuboid(Vec3::new(2.0, 0.3, 2.0)), 0.3),
        (hull(&prism(6, 2.0, 0.3)), 0.3),
        (Shape { radius: 0.1, ..Shape::cuboid(Vec3::new(2.0, 0.3, 2.0)) }, 0.4),
    ];
    for (ground, top) in &grounds {
        for (sink, tilt) in [(0.01, 0.0), (-0.01, 0.0), (0.01, 0.01), (0.25, 0.0)] {
            let pose = Pose::new(Vec3::new(0.1, top + 0.2 - sink, 0.2), Quat::from_rotation_z(tilt) * lie);
            let found = collide(ground, &capsule, &pose, 0.05).expect("contacts");
            assert_eq!(found.count, 2, "{ground:?} {sink} {tilt}");
            let middle = separations(&found).sum::<f32>() / 2.0;
            assert!((middle + sink).abs() < 1e-5, "{ground:?}: {middle} for {sink}");
            check_swap(ground, &capsule, &pose, 0.05, &Some(found));
        }
        // It stands on one end.
        let found = collide(ground, &capsule, &at(0.1, top + 0.7, 0.2), 0.05).expect("a contact");
        assert_eq!(found.count, 1);
    }
    // Over the border: the second point is at the border.
    let pose = Pose::new(Vec3::new(2.0, 0.5, 0.0), lie);
    let found = collide(&grounds[1].0, &capsule, &pose, 0.05).expect("contacts");
    let far = found.points[..2].iter().map(|point| point.on_a.x).fold(0.0, f32::max);
    assert!(found.count == 2 && (far - 2.0).abs() < 1e-5, "{found:?}");
}

#[test]
fn parallel_capsules_have_two_points_and_crossing_ones_one() {
    let capsule = Shape::capsule(0.5, 0.2);
    let found = collide(&capsule, &capsule, &at(0.39, 0.4, 0.0), 0.05).expect("contacts");
    assert_eq!(found.count, 2);
    let ends = [found.points[0].on_a.y, found.points[1].on_a.y];
    assert!((ends[0] + 0.1).abs() < 1e-6 && (ends[1] - 0.5).abs() < 1e-6, "{ends:?}");
    assert!(separations(&found).all(|gap| (gap + 0.01).abs() < 1e-6));
    let cross = Pose::new(Vec3::new(0.39, 0.1, 0.1), Quat::from_rotation_x(1.0));
    let found = collide(&capsule, &capsule, &cross, 0.05).expect("a contact");
    assert_eq!(found.count, 1);
    assert!((found.least() + 0.01).abs() < 1e-6 && found.normal.distance(Vec3::X) < 1e-6);
    // Askew by more than 1 % of the radius: they touch at the nearest end only.
    let askew = Pose::new(Vec3::new(0.39, 0.2, 0.0), Quat::from_rotation_x(0.05));
    assert_eq!(collide(&capsule, &capsule, &askew, 0.05).expect("a contact").count, 1);
    // Along the edge of a box, diagonally off it.
    let pose = at(1.0 + 0.12, 0.8, 1.0 + 0.12);
    let found = collide(&Shape::cuboid(Vec3::ONE), &capsule, &pose, 0.05).expect("contacts");
    assert_eq!(found.count, 2, "{found:?}");
    // Axes that are one, and axes that cross.
    for pose in [Pose::IDENTITY, at(0.0, 0.3, 0.0), Pose::new(Vec3::ZERO, Quat::from_rotation_x(1.0))] {
        let found = collide(&capsule, &capsule, &pose, 0.05).expect("a contact");
        assert!((found.least() + 0.4).abs() < 1e-5, "{found:?}");
    }
}

/// Of many vertices of a hull on the ground, four stay, the deepest among them, and they hold the middle between them.
#[test]
fn the_ground_keeps_the_deepest_vertices() {
    let mut random = Random(2);
    let ground = half_space();
    for round in 0..200 {
        let shape = if round % 2 == 0 { hull(&prism(30, 1.0, 0.2)) } else { Shape::cuboid(random.vector(1.0).abs() + 0.1) };
        let tilt = Quat::from_scaled_axis(random.vector(if round % 4 < 2 { 1e-3 } else { 1.0 }));
        let mut pose = Pose::new(Vec3::ZERO, tilt);
        let lowest = shape.aabb(&pose).min.y;
        pose.position.y = -lowest - 0.01;
        let found = collide(&ground, &shape, &pose, 0.1).expect("contacts");
        assert!((found.least() + 0.01).abs() < 2e-3, "{}", found.least());
        check(&ground, &shape, &pose, 0.1, &found);
        check_swap(&ground, &shape, &pose, 0.1, &Some(found));
        if round % 4 == 0 {
            assert_eq!(found.count, 4);
            let middle = found.points.iter().map(|point| point.on_a).sum::<Vec3>() / 4.0;
            assert!(middle.length() < 0.3, "{middle}");
        }
    }
}

/// Points count up to the reach, for every kind.
#[test]
fn contacts_begin_at_the_reach() {
    let half = Vec3::splat(0.5);
    let blocks = [
        Shape::ball(0.5),
        Shape { radius: 0.1, ..Shape::capsule(0.4, 0.5) },
        Shape::cuboid(half),
        Shape { radius: 0.1, ..Shape::cuboid(half - 0.1) },
        hull(&prism(6, 1.0, 0.5)),
        Shape { radius: 0.1, ..hull(&prism(6, 1.0, 0.4)) },
        half_space(),
    ];
    for (a, b) in blocks.iter().flat_map(|a| blocks[..6].iter().map(move |b| (a, b))) {
        let top = if a.extent().is_finite() { 0.5 } else { 0.0 };
        let pose = at(0.001, top + 0.54, 0.002);
        let found = collide(a, b, &pose, 0.041).expect("within reach");
        assert!((found.least() - 0.04).abs() < 1e-3, "{a:?} {b:?} {found:?}");
        check_swap(a, b, &pose, 0.041, &Some(found));
        assert!(collide(a, b, &pose, 0.037).is_none(), "{a:?} {b:?}");
    }
}

/// Boxes of a lattice touch their neighbours across faces with four points, and those across edges and corners not at all.
#[test]
fn boxes_of_a_lattice_touch_across_faces() {
    let mut random = Random(12);
    let half = Vec3::new(0.5, 0.4, 0.3);
    let cube = Shape::cuboid(half);
    for k in (0..27).filter(|k| *k != 13) {
        let step = Vec3::new((k % 3) as f32, (k / 3 % 3) as f32, (k / 9) as f32) - 1.0;
        for _ in 0..20 {
            let pose = Pose::new(2.0 * step * half + random.vector(1e-5), Quat::from_scaled_axis(random.vector(1e-5)));
            let count = collide(&cube, &cube, &pose, 0.05).map_or(0, |found| found.count);
            let expected = if step.abs().element_sum() == 1.0 { 4 } else { 0 };
            assert_eq!(count, expected, "{step}");
        }
    }
}

/// In a stack of equal boxes, ids stay whichever edge is a little ahead.
#[test]
fn ids_stay_in_a_stack() {
    let mut random = Random(10);
    let cube = Shape::cuboid(Vec3::new(0.5, 0.4, 0.3));
    let mut known = Vec::new();
    for _ in 0..200 {
        let pose = Pose::new(Vec3::new(0.0, 0.8, 0.0) + random.vector(1e-5), Quat::from_scaled_axis(random.vector(1e-5)));
        let found = collide(&cube, &cube, &pose, 0.05).expect("contacts");
        known.push(found.points.map(|point| point.id));
    }
    assert!(known.iter().all(|ids| *ids == known[0]));
    assert!(known[0][3] != 0);
}

/// The lowest point counts, though the face that is most against the reference face does not have it.
#[test]
fn the_lowest_corner_touches() {
    let points = [
        [0.3110456, -0.34887546, 0.13064502],
        [-0.49927717, 0.13098149, 0.18774389],
        [0.29553342, -0.7569996, -0.5524207],
        [-0.36865306, 0.6399996, -0.28059232],
        [0.4295829, -0.7070004, 0.43579698],
        [-0.11421735, 0.655022, -0.5545541],
        [0.17224842, 0.36299297, 0.54543966],
        [0.08516049, -0.06896164, 0.44340664],
    ];
    let stone = hull(&points.map(Vec3::from));
    let block = Shape::cuboid(Vec3::new(0.18307455, 0.10545145, 0.3097869));
    let turn = Quat::from_xyzw(0.011588301, -0.12087897, -0.045676835, 0.9915481);
    let pose = Pose::new(Vec3::new(0.1871932, 0.32877067, -0.33221972), turn);
    let expected = reference::gap(&reference::vertices(&stone, &Pose::IDENTITY), &reference::vertices(&block, &pose)) as f32;
    let found = collide(&stone, &block, &pose, 0.1).expect("contacts");
    assert!((found.least() - expected).abs() < 0.01, "{} {expected}", found.least());
}

/// Ids of a resting contact stay when the box moves by less than its margin.
#[test]
fn ids_stay_in_a_resting_contact() {
    let mut random = Random(9);
    let ground = Shape::cuboid(Vec3::new(50.0, 0.5, 50.0));
    for block in [Shape::cuboid(Vec3::new(0.5, 0.4, 0.3)), hull(&prism(6, 0.5, 0.4))] {
        let ids = |pose: &Pose| {
            let found = collide(&ground, &block, pose, 0.05).expect("contacts");
            let mut ids: Vec<u32> = found.points[..found.count].iter().map(|point| point.id).collect();
            ids.sort_unstable();
            ids
        };
        let place = Vec3::new(3.0, 0.9, -7.0);
        let first = ids(&Pose::new(place, Quat::from_rotation_y(0.3)));
        assert_eq!(first.len(), 4);
        for _ in 0..200 {
            let tilt = Quat::from_scaled_axis(random.vector(1e-4));
            let pose = Pose::new(place + random.vector(1e-3), tilt * Quat::from_rotation_y(0.3));
            assert_eq!(ids(&pose), first);
        }
    }
}
