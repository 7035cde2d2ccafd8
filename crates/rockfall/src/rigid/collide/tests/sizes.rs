//! Contacts of degenerate, huge and tiny shapes.

use glam::{Quat, Vec3};

use crate::rigid::collide::tests::{check, check_swap, describe, shapes};
use crate::rigid::collide::{collide, nearest, reference};
use crate::rigid::pose::Pose;
use crate::rigid::shape::tests::{Random, hull, prism};
use crate::rigid::shape::{Core, Shape};

/// All kinds in all quarter turns, with coordinates that make edges parallel and faces coplanar.
#[test]
fn aligned_shapes_give_numbers() {
    let cube: Vec<Vec3> =
        prism(4, 0.5 * 2f32.sqrt(), 0.5).iter().map(|p| Quat::from_rotation_y(0.25 * std::f32::consts::PI) * *p).collect();
    let half = Vec3::splat(0.5);
    let shapes = [
        Shape::ball(0.5),
        Shape::capsule(0.5, 0.25),
        Shape::cuboid(half),
        Shape { radius: 0.25, ..Shape::cuboid(half) },
        Shape::cuboid(Vec3::new(0.5, 0.005, 0.5)),
        Shape {
            core: Core::Face { u: Vec3::X * 0.5, v: Vec3::Y * 0.5, is_triangle: false, one_sided: false, is_facet: false },
            radius: 0.0,
        },
        hull(&cube),
        hull(&prism(8, 0.5, 0.5)),
        Shape { core: Core::HalfSpace, radius: 0.0 },
    ];
    let quarter = std::f32::consts::FRAC_PI_2;
    for (a, b) in shapes.iter().flat_map(|a| shapes.iter().map(move |b| (a, b))) {
        for k in 0..27 * 8 {
            let place = Vec3::new((k % 3) as f32, (k / 3 % 3) as f32, (k / 9 % 3) as f32) * 0.5;
            let turn =
                Quat::from_rotation_x((k / 27 % 2) as f32 * quarter) * Quat::from_rotation_y((k / 54) as f32 * 0.5 * quarter);
            let pose = Pose::new(place, turn);
            let found = collide(a, b, &pose, 0.1);
            if let Some(found) = &found {
                let checked = std::panic::catch_unwind(|| check(a, b, &pose, 0.1, found));
                assert!(checked.is_ok(), "{}", describe(a, b, &pose));
            }
            let points = [reference::vertices(a, &Pose::IDENTITY), reference::vertices(b, &pose)];
            if points.iter().all(|points| !points.is_empty()) && !(is_flat(a) && is_flat(b)) {
                let gap = reference::gap(&points[0], &points[1]) as f32 - a.radius - b.radius;
                // Sharp shapes whose corners just touch have no direction, and no contact.
                let is_clear = !(-0.001..0.02).contains(&gap) && gap < 0.09;
                assert!(!is_clear || found.is_some(), "missed {gap}: {}", describe(a, b, &pose));
                assert!(gap < 0.11 || found.is_none(), "far {gap}: {}", describe(a, b, &pose));
            }
        }
    }
}

/// Boxes from 1 mm to 100 m with edges of 1 to 100, a static one of up to 1 km.
#[test]
fn huge_and_tiny_boxes_meet() {
    let mut random = Random(21);
    let mut met = 0;
    for round in 0..3000 {
        let mut half = |low: f32| {
            let size = 10f32.powf(random.between(low, 1.7));
            Vec3::new(1.0, 10f32.powf(random.between(-2.0, 0.0)), 10f32.powf(random.between(-2.0, 0.0))) * size
        };
        let large = if round % 3 == 0 { Vec3::new(500.0, 500.0, 500.0) } else { half(-1.3) };
        let small = half(-1.3);
        let to_shape = |half: Vec3, as_hull: bool| {
            let corners: Vec<Vec3> =
                (0..8).map(|k| half * (Vec3::new((k & 1) as f32, (k >> 1 & 1) as f32, (k >> 2) as f32) * 2.0 - 1.0)).collect();
            if as_hull { hull(&corners) } else { Shape::cuboid(half) }
        };
        let (a, b) = (to_shape(large, round % 5 == 0), to_shape(small, round % 7 == 0));
        // The middle of b near a place of the surface of a.
        let mut place = Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0)) * large;
        let axis = (random.unit() * 3.0) as usize % 3;
        place[axis] = large[axis] + small.min_element() * random.between(0.2, 1.5);
        let pose = Pose::new(
            place,
            if round % 2 == 0 { random.turn() } else { Quat::from_axis_angle(Vec3::AXES[axis], random.unit()) },
        );
        let reach = 0.05 * small.min_element();
        let gap = reference::gap(&reference::vertices(&a, &Pose::IDENTITY), &reference::vertices(&b, &pose)) as f32;
        let found = collide(&a, &b, &pose, reach);
        let noise = 1e-5 * (a.extent() + b.extent());
        let slack = 0.08 * gap.abs() + 0.04 * large.min_element().min(small.min_element()) + noise;
        let result = std::panic::catch_unwind(|| {
            match &found {
                None => assert!(gap > reach - slack, "missed"),
                Some(found) => {
                    check(&a, &b, &pose, reach, found);
                    assert!((found.least() - gap).abs() <= slack, "least {}", found.least());
                }
            }
            if gap < reach - slack {
                check_swap(&a, &b, &pose, reach, &found);
            }
        });
        assert!(result.is_ok(), "round {round}: gap {gap} reach {reach} slack {slack} {found:?}\n{}", describe(&a, &b, &pose));
        met += found.is_some() as u32;
    }
    assert!(met > 1000, "{met}");
}

/// A common motion of both shapes changes nothing.
#[test]
fn contacts_move_with_the_shapes() {
    let mut random = Random(4);
    for _ in 0..20 {
        let (first, second) = (shapes(&mut random), shapes(&mut random));
        for (a, b) in first.iter().flat_map(|a| second.iter().map(move |b| (a, b))) {
            let pose = Pose::new(random.vector(0.6), random.turn());
            let motion = Pose::new(random.vector(3.0), random.turn());
            let moved = motion.relative(&motion.compose(&pose));
            let (one, two) = (collide(a, b, &pose, 0.1), collide(a, b, &moved, 0.1));
            if let (Some(one), Some(two)) = (&one, &two) {
                assert!((one.least() - two.least()).abs() < 0.02 + 0.1 * one.least().abs(), "{}", describe(a, b, &pose));
            } else {
                let found = one.or(two).map_or(0.1, |found| found.least());
                assert!((found - 0.1).abs() < 1e-3, "{}", describe(a, b, &pose));
            }
        }
    }
}

/// Random shapes in any pose, sizes and ratios: only numbers.
#[test]
fn contacts_are_finite() {
    let mut random = Random(77);
    let mut touched = 0;
    for round in 0..400 {
        let (first, second) = (shapes(&mut random), shapes(&mut random));
        for (a, b) in first.iter().flat_map(|a| second.iter().map(move |b| (a, b))) {
            let size = 10f32.powi(-(round % 5));
            let tilt = if round % 3 == 0 { Quat::from_scaled_axis(random.vector(1e-6)) } else { random.turn() };
            let pose = Pose::new(random.vector(size), tilt);
            if let Some(found) = collide(a, b, &pose, random.between(-0.1, 1.0)) {
                assert!(found.normal.is_finite() && (found.normal.length() - 1.0).abs() < 1e-4, "{}", describe(a, b, &pose));
                let points = &found.points[..found.count];
                assert!(points.iter().all(|point| point.on_a.is_finite() && point.on_b.is_finite()));
                touched += 1;
            }
        }
    }
    assert!(touched > 15_000, "{touched}");
}

/// Balls and capsules from 1 mm to 10 m on boxes, hulls and faces of up to 1 km.
#[test]
fn round_shapes_of_all_sizes_meet() {
    let mut random = Random(31);
    let mut met = 0;
    for round in 0..1500 {
        let size = 10f32.powf(random.between(-1.0, 2.7));
        let half = Vec3::new(1.0, 10f32.powf(random.between(-2.0, 0.0)), 10f32.powf(random.between(-2.0, 0.0))) * size;
        let ground = match round % 3 {
            0 => Shape::cuboid(half),
            1 => hull(&prism(3 + round % 20, 1.0, 1.0).iter().map(|p| *p * half).collect::<Vec<_>>()),
            _ => Shape {
                core: Core::Face {
                    u: half * Vec3::X,
                    v: half * Vec3::Y,
                    is_triangle: false,
                    one_sided: false,
                    is_facet: false,
                },
                radius: 0.0,
            },
        };
        let radius = 10f32.powf(random.between(-3.0, 1.0)).min(0.5 * size);
        let mover =
            if round % 4 == 0 { Shape::ball(radius) } else { Shape::capsule(radius * random.between(0.01, 20.0), radius) };
        // A place on the surface, and the mover about as far away as its radius.
        let out = random.vector(1.0) * half * 2.0;
        let Some(near) = nearest(&ground.core, out) else { continue };
        let turn = if round % 5 == 0 { Quat::IDENTITY } else { random.turn() };
        let pose = Pose::new(near.place + near.normal * mover.extent() * random.between(-0.2, 1.05), turn);
        let gap =
            reference::gap(&reference::vertices(&ground, &Pose::IDENTITY), &reference::vertices(&mover, &pose)) as f32 - radius;
        let reach = 0.1 * radius;
        let found = collide(&ground, &mover, &pose, reach);
        // Capsules through a flat face leave it on the side of their middle.
        let is_through = is_flat(&ground) && gap < -radius;
        let noise = 1e-5 * (ground.extent() + mover.extent());
        let slack = 0.06 * (gap + radius).abs() + 0.02 * radius + noise;
        let result = std::panic::catch_unwind(|| match &found {
            None => assert!(gap > reach - slack, "missed"),
            Some(found) => {
                check(&ground, &mover, &pose, reach, found);
                assert!(is_through || (found.least() - gap).abs() <= slack, "least {}", found.least());
                if gap < reach - slack && !is_through {
                    check_swap(&ground, &mover, &pose, reach, &Some(*found));
                }
            }
        });
        assert!(result.is_ok(), "round {round}: gap {gap} slack {slack} {found:?}\n{}", describe(&ground, &mover, &pose));
        met += found.is_some() as u32;
    }
    assert!(met > 500, "{met}");
}

fn is_flat(shape: &Shape) -> bool {
    matches!(shape.core, Core::Face { .. })
}
