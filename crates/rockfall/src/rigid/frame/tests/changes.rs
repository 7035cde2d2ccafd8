//! What changes between frames: masses, kinds of bodies and the length of a frame.

use std::f32::consts::TAU;

use glam::Vec3;

use super::scene::{DT, G, Scene, close};
use crate::rigid::frame::{advance, kinetic_energy};
use crate::rigid::world::{Body, Kind};

/// g / w² of contacts between bodies, with S = 4.
fn unit_sink(dt: f32) -> f32 {
    let w = TAU * 0.18 * 4.0 / dt;
    G / (w * w)
}

fn set_mass(body: &mut Body, mass: f32) {
    let factor = mass * body.inverse_mass;
    body.inverse_mass = 1.0 / mass;
    body.moments *= factor;
    body.inverse_inertia *= 1.0 / factor;
    body.set_spin(body.spin);
}

/// Problem 50. With the masses m and M a point between two cubes has K = 4 / m + 4 / M, and one on the floor 4 / m at twice the frequency.
/// So 9 more units of mass on top sink by 11 - 2 at the top contact, 18 at each of the three others, and 9 / 4 on the floor, times g / w².
#[test]
fn mass_on_a_stack_changes_while_it_stands() {
    let mut scene = Scene::stack(5);
    scene.run(3.0);
    let before = scene.at(5).y;
    let wanted = (9.0 + 3.0 * 18.0 + 9.0 / 4.0) * unit_sink(DT);
    set_mass(&mut scene.world.bodies[5], 10.0);
    let mut lowest = before;
    for _ in 0..300 {
        scene.step();
        lowest = lowest.min(scene.at(5).y);
    }
    close(before - scene.at(5).y, wanted, 1e-4);
    assert!(scene.at(5).y - lowest < 1e-4, "overshoot of {}", scene.at(5).y - lowest);
    set_mass(&mut scene.world.bodies[5], 1.0);
    let mut highest = 0.0_f32;
    for _ in 0..300 {
        scene.step();
        highest = highest.max(scene.at(5).y);
    }
    close(scene.at(5).y, before, 1e-4);
    assert!(highest - before < 1e-4, "overshoot of {}", highest - before);
}

/// Problem 50: blocks of a fixed body do not conflict, and those of a body that gets mass do.
#[test]
fn body_that_gets_mass_has_blocks_of_different_colours() {
    let mut scene = Scene::new(0.5, 0.0);
    scene.floor();
    let mut middle = 0;
    for row in 0..8 {
        for k in 0..8 {
            let x = k as f32 - 0.5 * (row % 2) as f32;
            let at = Vec3::new(x, 0.5 * row as f32 + 0.25, 0.0);
            let brick = scene.cuboid(Vec3::new(0.5, 0.25, 0.25), at);
            middle = if (row, k) == (3, 4) { brick } else { middle };
        }
    }
    let loose = scene.world.bodies[middle].clone();
    let fixed = Body::fixed(Kind::Kinematic, loose.pose);
    scene.world.bodies[middle] = Body { radius: loose.radius, width: loose.width, ..fixed };
    scene.run(0.5);
    let colours_of = |scene: &Scene| {
        let blocks = scene.world.history.colours.iter();
        let own = blocks.filter(|([a, b], _)| [*a, *b].contains(&(middle as u32)));
        let mut colours: Vec<u8> = own.map(|(_, colour)| *colour).collect();
        colours.sort_unstable();
        colours
    };
    let fixed = colours_of(&scene);
    assert!(fixed.len() >= 4 && fixed.windows(2).any(|two| two[0] == two[1]), "{fixed:?}");
    scene.world.bodies[middle] = loose;
    for _ in 0..3 {
        scene.step();
        let colours = colours_of(&scene);
        assert!(colours.len() >= 4 && colours.windows(2).all(|two| two[0] != two[1]), "{colours:?}");
    }
    scene.run(5.0);
    assert!(kinetic_energy(&scene.world) < 1e-3, "{}", kinetic_energy(&scene.world));
}

/// Problem 53. Sinks are in proportion to the square of the substep: a stack of ten comes to N (N - 1) / 2 · 2 + N / 4, times g / w².
#[test]
fn stack_finds_its_new_rest_after_a_change_of_the_frame() {
    for factor in [0.5, 2.0] {
        let mut scene = Scene::stack(10);
        scene.run(5.0);
        let sink = |dt: f32| (90.0 + 2.5) * unit_sink(dt);
        let before = scene.at(10).y;
        let (mut fastest, mut beyond) = (0.0_f32, 0.0_f32);
        let wanted = sink(DT) - sink(factor * DT);
        for _ in 0..(5.0 / (factor * DT)) as u32 {
            advance(&mut scene.world, factor * DT, 4);
            fastest = fastest.max(scene.velocity(10).length());
            beyond = beyond.max((scene.at(10).y - before - wanted) * wanted.signum());
        }
        let moved = scene.at(10).y - before;
        close(moved, wanted, 0.02 * wanted.abs());
        assert!(fastest <= 0.16, "{fastest}");
        assert!(beyond < 0.02 * wanted.abs(), "{beyond}");
        assert!(kinetic_energy(&scene.world) < 1e-6);
    }
}
