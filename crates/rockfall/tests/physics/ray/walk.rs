//! Ray queries against a walk along the ray in small steps that tests at each step which bodies contain the point.

use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rockfall::glam::{DVec3, Quat, Vec3};
use rockfall::{Backend, Body, Cuboid, Polygon, Rod, Scene, Sphere};

use crate::common::*;

/// Length of a step. The walk may miss a body that the ray is in for less than a step.
const STEP: f64 = 1e-3;
const REACH: f64 = 12.0;

/// 1 if a point is inside a body, else 0. For a polygon, the side of it (1 or -1) on which the point lies, or 0 beside
/// it. Computed from distances alone.
fn side(scene: &Scene, body: Body, p: DVec3) -> i8 {
    let place = |id| scene.sphere(id).expect("a sphere").position.as_dvec3();
    let within = |inside: bool| i8::from(inside);
    match body {
        Body::Sphere(id) => within(p.distance(place(id)) < f64::from(scene.sphere(id).expect("a sphere").radius)),
        Body::Rod(id) => {
            let rod = scene.rod(id).expect("a rod");
            let (one, two) = (place(rod.end1), place(rod.end2));
            let t = ((p - one).dot(two - one) / one.distance_squared(two)).clamp(0.0, 1.0);
            within(p.distance(one.lerp(two, t)) < f64::from(rod.radius))
        }
        Body::Box(id) => {
            let cuboid = scene.cuboid(id).expect("a box");
            let t = p - cuboid.corner.as_dvec3();
            let mut edges = cuboid.edges.iter().map(|edge| edge.as_dvec3());
            within(edges.all(|edge| (0.0..=edge.length_squared()).contains(&t.dot(edge))))
        }
        Body::Polygon(id) => {
            let polygon = scene.polygon(id).expect("a polygon");
            let [left, right] = [polygon.left, polygon.right].map(Vec3::as_dvec3);
            let (t, normal) = (p - polygon.corner.as_dvec3(), left.cross(right));
            let area = normal.length_squared();
            // Both oblique parameters, by Cramer's rule.
            let (a, b) = (t.cross(right).dot(normal) / area, left.cross(t).dot(normal) / area);
            let beside = !(0.0..=1.0).contains(&a) || !(0.0..=1.0).contains(&b);
            if beside { 0 } else { if t.dot(normal) > 0.0 { 1 } else { -1 } }
        }
        _ => unreachable!("the scene has no other kinds"),
    }
}

/// The first body that the walk enters or, for a polygon, crosses, and the distance.
fn walk(scene: &Scene, bodies: &[Body], origin: DVec3, unit: DVec3) -> Option<(Body, f64)> {
    let mut before: Vec<i8> = bodies.iter().map(|body| side(scene, *body, origin)).collect();
    for step in 1..(REACH / STEP) as u32 {
        let t = f64::from(step) * STEP;
        for (body, before) in bodies.iter().zip(&mut before) {
            let now = side(scene, *body, origin + t * unit);
            let came_in = match body {
                Body::Polygon(_) => now * *before < 0,
                _ => now > *before,
            };
            if came_in {
                return Some((*body, t));
            }
            *before = now;
        }
    }
    None
}

fn random_scene(random: &mut rand_pcg::Pcg32) -> Scene {
    let mut scene = Scene::new();
    let mut number = |low: f32, high: f32| random.random_range(low..high);
    let mut ids = Vec::new();
    for _ in 0..6 {
        let place = [number(-3.0, 3.0), number(-3.0, 3.0), number(-3.0, 3.0)];
        ids.push(scene.add_sphere(Sphere::new(place, number(0.1, 0.8))).expect("a valid sphere"));
    }
    for ends in ids.windows(2).step_by(2) {
        scene.add_rod(Rod::new(ends[0], ends[1], number(0.05, 0.9))).expect("a valid rod");
    }
    for _ in 0..2 {
        let turn = Quat::from_xyzw(number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0), number(0.1, 1.0)).normalize();
        let corner = Vec3::new(number(-3.0, 3.0), number(-3.0, 3.0), number(-3.0, 3.0));
        let mut edge = |axis: Vec3| turn * axis * number(0.3, 2.0);
        let [i, j, k] = [edge(Vec3::X), edge(Vec3::Y), edge(Vec3::Z)];
        scene.add_box(Cuboid::new(corner, i, j, k)).expect("a valid box");
        let skew = j + number(-0.5, 0.5) * i;
        scene.add_polygon(Polygon::new(-corner, i * 2.0, skew * 2.0)).expect("a valid polygon");
    }
    scene
}

fn direction(random: &mut rand_pcg::Pcg32) -> Vec3 {
    let mut number = || random.random_range(-1.0_f32..1.0);
    Vec3::new(number(), number(), number())
}

/// The query must hit the body that the walk enters, at the same distance, or an earlier body that the walk has missed.
#[test]
fn rays_hit_the_bodies_that_a_walk_along_them_enters() {
    let mut hits = [0_u32; 4];
    for seed in 0..12 {
        let mut random = rand_pcg::Pcg32::seed_from_u64(seed);
        let scene = random_scene(&mut random);
        let bodies: Vec<Body> = (scene.sphere_ids().map(Body::Sphere))
            .chain(scene.rod_ids().map(Body::Rod))
            .chain(scene.box_ids().map(Body::Box))
            .chain(scene.polygon_ids().map(Body::Polygon))
            .collect();
        let mut simulation = simulation(scene.clone(), Backend::Cpu);
        for _ in 0..25 {
            // Every other ray starts among the bodies, some inside one.
            let origin = direction(&mut random) * if random.next_u32() % 2 == 0 { 6.0 } else { 2.0 };
            let towards = direction(&mut random) * 2.0 - origin;
            let hit = simulation.cast_ray(origin, towards).expect("a valid ray");
            let (origin, unit) = (origin.as_dvec3(), towards.as_dvec3().normalize());
            let walked = walk(&scene, &bodies, origin, unit);
            let context = format!("seed {seed}, from {origin} along {unit}: {hit:?}, the walk: {walked:?}");
            let Some(hit) = hit else {
                assert_eq!(walked, None, "{context}");
                continue;
            };
            let distance = f64::from(hit.distance);
            let stepped_over = walked.is_none_or(|(_, t)| distance < t - 2.0 * STEP);
            if stepped_over {
                // The ray is inside the body for less than a step.
                let just = |t: f64| side(&scene, hit.body, origin + t * unit);
                assert!(just(distance + 1e-5) != just(distance - 1e-5) && just(distance + STEP) == 0, "{context}");
                continue;
            }
            let (body, t) = walked.expect("the walk must have entered a body");
            assert!(body == hit.body && (t - distance).abs() <= STEP + 1e-5, "{context}");
            assert!(hit.normal.as_dvec3().dot(unit) <= 1e-6, "{context}: the normal must point against the ray");
            hits[match hit.body {
                Body::Sphere(_) => 0,
                Body::Rod(_) => 1,
                Body::Box(_) => 2,
                _ => 3,
            }] += 1;
        }
    }
    assert!(hits.iter().all(|count| *count >= 10), "rays must hit all kinds: {hits:?}");
}
