//! Tests of surveys.

use rockfall::{Cuboid, Rod, Sphere, Tether};

use super::*;

/// A survey of `states` states of spheres of radius 0.5, whose places follow from body and state. The floor is at y = -1.
fn survey(bodies: usize, states: usize, floor: bool, place: impl Fn(usize, usize) -> Vec3) -> Survey {
    let scene = |state: usize| {
        let mut scene = Scene::new();
        for body in 0..bodies {
            let mut sphere = Sphere::new(place(body, state), 0.5);
            sphere.velocity = (place(body, state + 1) - place(body, state)) / 0.1;
            scene.add_sphere(sphere).unwrap();
        }
        if floor {
            scene.add_box(Cuboid::between([-9.0, -2.0, -9.0], [9.0, -1.0, 9.0])).unwrap();
        }
        scene
    };
    let mut survey = Survey::new(&scene(0));
    (1..states).for_each(|state| survey.add(&scene(state)));
    survey
}

fn row(body: usize) -> Vec3 {
    Vec3::new(2.0 * body as f32, 0.0, 0.0)
}

/// The place after a free fall.
fn fallen(state: usize) -> f32 {
    -0.5 * (state * state) as f32
}

#[test]
fn the_extent_is_that_of_all_states() {
    let survey = survey(3, 5, false, |body, state| row(body) + Vec3::new(0.0, state as f32, 0.0));
    assert_eq!(survey.extent(), Some(Extent { min: Vec3::splat(-0.5), max: Vec3::new(4.5, 4.5, 0.5) }));
}

#[test]
fn one_of_few_bodies_that_falls_for_ever_is_left_out() {
    let falls = |which: usize| move |body, state| row(body) + Vec3::Y * if body == which { fallen(state) } else { 0.0 };
    for bodies in [3, 10] {
        for which in 0..bodies {
            let extent = survey(bodies, 60, false, falls(which)).extent().unwrap();
            assert!(extent.min.y > -20.0 && extent.max.x - extent.min.x < 2.0 * bodies as f32, "{bodies} {which} {extent:?}");
        }
    }
    // A pendulum beside it is enough.
    let mut scene = Scene::new();
    let bob = scene.add_sphere(Sphere::new([0.0, -2.0, 0.0], 0.5)).unwrap();
    scene.add_tether(Tether::new(bob, [0.0, 0.0, 0.0], 1.0)).unwrap();
    let mut fallen = Sphere::new([2.0, -4000.0, 0.0], 0.5);
    fallen.velocity.y = -280.0;
    scene.add_sphere(fallen).unwrap();
    assert!(Survey::new(&scene).extent().unwrap().size() < 4.0);
}

/// A state shortly after the start: small balls one above the other, which fall with the same velocity.
#[test]
fn balls_that_fall_together_are_shown() {
    for floor in [false, true] {
        let mut scene = Scene::new();
        for (height, velocity) in [(4.0, -1.0), (8.0, -1.0), (8.5, -1.0)] {
            let mut ball = Sphere::new([0.0, height, 0.0], 0.05);
            ball.velocity.y = velocity;
            scene.add_sphere(ball).unwrap();
        }
        if floor {
            scene.add_box(Cuboid::between([-2.0, -1.0, -2.0], [2.0, 0.0, 2.0])).unwrap();
        }
        assert_eq!(Survey::new(&scene).extent().unwrap().min.y, 3.95, "{floor}");
    }
    // What falls onto a floor is shown also if it alone falls.
    let place = |body: usize, state: usize| Vec3::Y * if body == 0 { 60.0 + fallen(state) } else { 80.0 + 0.01 * state as f32 };
    assert_eq!(survey(2, 6, true, place).extent().unwrap().min.y, 47.0);
}

#[test]
fn one_of_two_bodies_that_moves_to_a_side_is_shown() {
    let place = |body: usize, state: usize| 2.0 * body as f32 * Vec3::Y + Vec3::X * if body == 0 { state as f32 } else { 0.0 };
    assert_eq!(survey(2, 21, false, place).extent().unwrap().max.x, 20.5);
    assert!(survey(2, 200, false, place).extent().unwrap().max.x < 2.0);
}

#[test]
fn some_of_many_bodies_that_fall_for_ever_are_left_out() {
    let place = |body: usize, state| {
        Vec3::new((body % 10) as f32, (body / 10) as f32, 0.0)
            + if body % 50 == 7 { Vec3::new(3.0, 10.0 * fallen(state), 0.0) } else { Vec3::ZERO }
    };
    let extent = survey(200, 40, false, place).extent().unwrap();
    assert!(extent.size() < 45.0 && extent.min.y > -15.0, "{extent:?}");
}

#[test]
fn bodies_below_the_floor_are_left_out_even_if_they_are_the_half() {
    let place = |body, state| row(body) + Vec3::Y * if body == 0 { fallen(state) } else { 0.0 };
    let extent = survey(2, 30, true, place).extent().unwrap();
    // The first part of the fall is shown.
    assert!((-4.0..-0.9).contains(&extent.min.y), "{extent:?}");
    // If all are below, there is nothing else to show.
    assert!(survey(2, 2, true, |body, _| row(body) - 100.0 * Vec3::Y).extent().unwrap().max.y < -90.0);
}

#[test]
fn bodies_that_spread_out_or_come_from_afar_are_shown() {
    let extent = survey(4, 20, false, |body, state| (body as f32 - 1.5) * state as f32 * Vec3::X).extent().unwrap();
    assert_eq!((extent.min.x, extent.max.x), (-29.0, 29.0));
    let thrown = |body: usize, state: usize| row(body) + Vec3::X * if body == 0 { -(19.0 - state as f32) } else { 0.0 };
    assert_eq!(survey(6, 20, false, thrown).extent().unwrap().min.x, -19.5);
    assert_eq!(survey(30, 20, false, thrown).extent().unwrap().min.x, -19.5);
}

/// A pendulum with a rod of length 1, in `states` states of its swing, without or with many balls around its pivot.
fn pendulum(states: usize, [pivot, ball]: [f32; 2], balls: usize) -> Survey {
    let scene = |state: usize| {
        let mut scene = Scene::new();
        let (sin, cos) = (0.2 * state as f32).sin_cos();
        let mut fixed = Sphere::new([0.0, 2.0, 0.0], pivot);
        fixed.fixed = true;
        let mut bob = Sphere::new([sin, 2.0 - cos, 0.0], ball);
        bob.velocity = Vec3::new(cos, sin, 0.0);
        let [fixed, bob] = [fixed, bob].map(|sphere| scene.add_sphere(sphere).unwrap());
        scene.add_rod(Rod::new(fixed, bob, 0.01)).unwrap();
        for k in 0..balls {
            scene.add_sphere(Sphere::new([0.01 * k as f32, 2.2, 0.0], 0.001)).unwrap();
        }
        scene
    };
    let mut survey = Survey::new(&scene(0));
    (1..states).for_each(|state| survey.add(&scene(state)));
    survey
}

#[test]
fn a_body_that_is_bonded_to_one_in_view_is_shown() {
    for radii in [[0.02, 0.05], [0.02, 0.1], [0.04, 0.1], [0.04, 0.2], [0.05, 0.05]] {
        for (states, balls) in [(1, 0), (8, 0), (1, 30), (8, 30)] {
            let extent = pendulum(states, radii, balls).extent().unwrap();
            assert!((extent.min.y - 1.0 + radii[1]).abs() < 1e-5, "{radii:?} {states} {balls}: {extent:?}");
        }
    }
    // A pair that falls for ever is left out, even if it began above a fixed ball.
    let mut scene = Scene::new();
    let pair = [0.0, 1.0].map(|x| {
        let mut sphere = Sphere::new([x, -500.0, 0.0], 0.1);
        sphere.velocity.y = -100.0;
        scene.add_sphere(sphere).unwrap()
    });
    scene.add_rod(Rod::new(pair[0], pair[1], 0.01)).unwrap();
    for k in 0..3 {
        scene.add_sphere(Sphere::new([k as f32, 0.0, 0.0], 0.1)).unwrap();
    }
    assert!(Survey::new(&scene).extent().unwrap().min.y > -1.0);
}

#[test]
fn a_body_that_does_not_move_away_is_shown() {
    for bodies in [2, 10, 40] {
        let place = |body, _| if body == 0 { Vec3::new(0.0, -4000.0, 0.0) } else { row(body) };
        for states in [1, 5] {
            assert_eq!(survey(bodies, states, false, place).extent().unwrap().min.y, -4000.5, "{bodies} {states}");
        }
        // It hangs below the lowest static object.
        assert_eq!(survey(bodies, 3, true, place).extent().unwrap().min.y, -4000.5);
    }
}

#[test]
fn a_ball_that_falls_beside_a_small_fixed_one_is_shown_while_it_is_near() {
    let scene = |time: f32| {
        let mut scene = Scene::new();
        let mut small = Sphere::new([0.0, 0.0, 0.0], 0.01);
        small.fixed = true;
        scene.add_sphere(small).unwrap();
        let mut ball = Sphere::new([0.5, 1.0 - 5.0 * time * time, 0.0], 0.05);
        ball.velocity.y = -10.0 * time;
        scene.add_sphere(ball).unwrap();
        scene
    };
    let lowest = |end: f32| {
        let mut survey = Survey::new(&scene(0.0));
        (1..=20).for_each(|k| survey.add(&scene(end * k as f32 / 20.0)));
        survey.extent().unwrap().min.y
    };
    assert!((lowest(0.7) + 1.5).abs() < 0.01);
    assert!(lowest(10.0) > -1.0);
}

#[test]
fn a_huge_fixed_sphere_is_a_ground() {
    let mut scene = Scene::new();
    for k in 0..3 {
        scene.add_sphere(Sphere::new([k as f32, 0.5, 0.0], 0.5)).unwrap();
    }
    let mut ground = Sphere::new([0.0, -100.0, 0.0], 100.0);
    ground.fixed = true;
    scene.add_sphere(ground).unwrap();
    assert_eq!(Survey::new(&scene).extent(), Some(Extent { min: Vec3::new(-0.5, 0.0, -0.5), max: Vec3::new(2.5, 1.0, 0.5) }));
}

#[test]
fn no_body_of_a_heap_that_spreads_out_is_left_out() {
    // A tower of 26 balls, of which the upper ones roll away on the floor.
    let place = |body: usize, state: usize| {
        let rolled = if body < 20 { 0.0 } else { (body as f32 - 19.0) * state as f32 / 15.0 };
        Vec3::new((body % 5) as f32 + rolled, (body / 5) as f32 - if body < 20 { 0.0 } else { 0.3 * state as f32 }, 0.0)
    };
    let last = place(24, 15).x;
    assert!((survey(26, 16, true, place).extent().unwrap().max.x - last - 0.5).abs() < 1e-5);
}

#[test]
fn the_start_of_a_fall_below_the_floor_is_shown() {
    // Both balls roll over the edge of the floor, whose bottom is at y = -2.
    let place =
        |body: usize, state: usize| row(body) + Vec3::new(state as f32, if state > 8 { fallen(state - 8) } else { 0.0 }, 0.0);
    let lowest = survey(2, 20, true, place).extent().unwrap().min.y;
    assert!((-2.0 - 0.3 * 22.0 - 0.5..-4.0).contains(&lowest), "{lowest}");
}
