//! The witness itself against closed forms: surfaces of several shapes (docs/physics section 2.11).

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rockfall::Integrator;
use rockfall::glam::DVec3;

use crate::closed::{close, kinetic, run, world};
use crate::geometry::Thing;
use crate::known::{SMOOTH, parse};
use crate::world::World;

/// Flush boxes with the upper side y = 0, cut at random.
fn tiles(rng: &mut Pcg64Mcg) -> String {
    let (mut text, mut x) = (String::new(), -0.5_f64);
    while x < 19.5 {
        let next = (x + (rng.random_range(6..64) as f64) / 64.0).min(19.5);
        let cut = f64::from(rng.random_range(-64..64)) / 64.0;
        for (low, high) in [(-5.0, cut), (cut, 5.0)] {
            text += &format!("B {x} -1 {low}  {} 0 0  0 1 0  0 0 {}\n", next - x, high - low);
        }
        x = next;
    }
    text
}

/// A frictionless ball keeps its velocity on tiles, and gets no collision.
#[test]
fn a_ball_keeps_its_velocity_on_tiles() {
    for integrator in [Integrator::Rk4, Integrator::SymplecticEuler, Integrator::VelocityVerlet] {
        let floor = tiles(&mut Pcg64Mcg::seed_from_u64(1));
        let scene = parse(&format!("set gravity 9.81\nset friction 0\nS 1 0.3 0.09019 0  3 0 0.3  0 0 0 1 0.1 0\n{floor}"));
        let mut world = World::of(&scene, integrator, 0.005);
        for _ in 0..1_200 {
            let pressed = world.step(false);
            assert!(pressed.len() < 2 && pressed.iter().all(|contact| !contact.collides));
        }
        close(world.balls[0].v.distance(DVec3::new(3.0, 0.0, 0.3)), 0.0, 1e-5);
    }
}

/// Grooves keep both walls, a corner keeps its three walls, and a ball on a cross of cuts has one contact.
#[test]
fn walls_count_and_tiles_do_not() {
    for degrees in [5.0_f64, 15.0, 30.0, 45.0, 60.0, 75.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let wall = |side: f64| format!("B 0 0 -5  {} {} 0  {} {} 0  0 0 10\n", 4.0 * side * cos, 4.0 * sin, side * sin, -cos);
        let ball = format!("S 1 0 {} 0  0 0 0  0 0 0 1 0.5\n", 0.49 / cos);
        assert_eq!(world(&format!("{ball}{}{}", wall(1.0), wall(-1.0)), 0.01).touches().len(), 2, "{degrees} degrees");
    }
    let corner = "B -1 -1 -1  4 0 0  0 1 0  0 0 4\nB -1 -0.5 -1  1 0 0  0 3 0  0 0 4\nB -1 -0.5 -1  4 0 0  0 3 0  0 0 1\n";
    assert_eq!(world(&format!("{corner}S 1 0.4 0.45 0.48  0 0 0  0 0 0 1 0.5\n"), 0.01).touches().len(), 3);
    let cross =
        "B 0 -1 0 1 0 0 0 1 0 0 0 1\nB -1 -1 0 1 0 0 0 1 0 0 0 1\nB 0 -1 -1 1 0 0 0 1 0 0 0 1\nB -1 -1 -1 1 0 0 0 1 0 0 0 1\n";
    for ball in ["0 0.4 0", "0.1 0.4 -0.1", "-0.1 -0.05 0.1"] {
        let touches = world(&format!("{cross}S 1 {ball}  0 0 0  0 0 0 1 0.5\n"), 0.01).touches();
        assert!(touches.len() == 1 && matches!(touches[0].0.b, Thing::Block(_)), "{touches:?}");
        close(touches[0].1.n.distance(DVec3::NEG_Y), 0.0, 1e-12);
    }
}

/// Smooth elastic hits of tiles keep the kinetic energy.
#[test]
fn hits_of_tiles_keep_the_energy() {
    let mut rng = Pcg64Mcg::seed_from_u64(2);
    let (mut aside, mut worst) = (0, 0.0_f64);
    for _ in 0..400 {
        let [x, z] = [rng.random_range(2.0..15.0), rng.random_range(-2.0..2.0)];
        let v = DVec3::new(rng.random_range(-6.0..6.0), rng.random_range(-8.0..-1.0), rng.random_range(-6.0..6.0));
        let (radius, dt) = (rng.random_range(0.1..0.6), rng.random_range(0.004..0.02));
        let y = radius + rng.random_range(0.01..0.1);
        let ball = format!("S 1 {x} {y} {z}  {} {} {}  0 0 0  1 {radius}\n", v.x, v.y, v.z);
        let mut world = world(&format!("{SMOOTH}{}{ball}", tiles(&mut rng)), dt);
        let before = kinetic(&world);
        run(&mut world, 0.25 / v.y.abs());
        let after = world.balls[0].v;
        assert!(after.y > 0.0, "the ball must hit the floor");
        close(kinetic(&world) / before, 1.0, 1e-6);
        let turned = (after - v * DVec3::new(1.0, -1.0, 1.0)).length() / v.length();
        aside += usize::from(turned > 1e-5);
        worst = worst.max(turned);
    }
    println!("{aside} of 400 hits turned the velocity along the floor, by at most {worst} of the speed");
}
