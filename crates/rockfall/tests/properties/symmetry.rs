//! Where a scene lies, how it is turned and in which unit mass is measured is nobody's business.

use glam::{Quat, Vec3};
use proptest::prelude::*;
use rockfall::{Backend, Cuboid, Polygon, Scene, Sphere, SphereState};

use crate::things::{Outcome, Thing, check, direction, simulation, thing, vector, weightless};

const DT: f32 = 0.004;

/// A few things, a box and a polygon.
fn few() -> impl Strategy<Value = Vec<Thing>> {
    prop::collection::vec(thing(1.5, 2.0), 2..8)
}

/// A scene moved as a whole.
#[derive(Clone, Copy, Debug)]
struct Placed {
    turn: Quat,
    shift: Vec3,
}

impl Placed {
    fn point(&self, place: Vec3) -> Vec3 {
        self.turn * place + self.shift
    }

    fn sphere(&self, sphere: Sphere) -> Sphere {
        Sphere {
            position: self.point(sphere.position),
            velocity: self.turn * sphere.velocity,
            angular_momentum: self.turn * sphere.angular_momentum,
            ..sphere
        }
    }

    fn scene(&self, things: &[Thing]) -> Scene {
        let moved: Vec<_> = things.iter().map(|thing| thing.map(|sphere| self.sphere(sphere))).collect();
        let mut scene = weightless(&moved);
        let [i, j, k] = [Vec3::X, 1.5 * Vec3::Y, 2.0 * Vec3::Z].map(|edge| self.turn * edge);
        let corner = self.point(Vec3::new(-1.2, -1.4, -0.8));
        scene.add_box(Cuboid::new(corner, i, j, k)).unwrap();
        let [left, right] = [Vec3::new(0.2, 0.3, 3.0), Vec3::new(3.0, 0.0, 0.4)].map(|edge| self.turn * edge);
        let corner = self.point(Vec3::new(-1.0, -0.6, -1.5));
        scene.add_polygon(Polygon::new(corner, left, right)).unwrap();
        scene.settings.gravity = 9.81;
        scene.settings.gravity_direction = (self.turn * Vec3::NEG_Y).normalize();
        scene
    }
}

fn after(scene: Scene, steps: u64) -> Vec<SphereState> {
    let mut simulation = simulation(scene, Backend::Cpu);
    simulation.run(steps, DT).unwrap();
    simulation.spheres().unwrap()
}

/// Rounding of places of up to `size` units, six stages of it, through Cc dt = 4/s into the velocities; and what a
/// badly conditioned normal makes of that.
fn assert_moved(placed: Placed, things: &[Thing], size: f32) -> Outcome {
    let still = Placed { turn: Quat::IDENTITY, shift: Vec3::ZERO };
    let (expected, found) = (after(still.scene(things), 1), after(placed.scene(things), 1));
    for (e, f) in expected.iter().zip(&found) {
        let (place, velocity) = (placed.point(e.position), placed.turn * e.velocity);
        prop_assert!(f.position.distance(place) < 1e-5 * size, "{place} {} {e:?}", f.position);
        prop_assert!(f.velocity.distance(velocity) < 1e-4 * size, "{velocity} {} {e:?}", f.velocity);
        let spin = placed.turn * e.angular_momentum;
        prop_assert!(f.angular_momentum.distance(spin) < 1e-4 * size, "{spin} {} {e:?}", f.angular_momentum);
    }
    Ok(())
}

#[test]
fn a_scene_elsewhere_moves_alike() {
    check(150, (few(), vector(8.0)), |(things, shift)| -> Outcome {
        let turn = Quat::IDENTITY;
        assert_moved(Placed { turn, shift }, &things, 10.0)
    });
}

#[test]
fn a_scene_turned_moves_alike() {
    check(150, (few(), direction(), 0.1_f32..3.0), |(things, axis, angle)| -> Outcome {
        let turn = Quat::from_axis_angle(axis, angle);
        assert_moved(Placed { turn, shift: Vec3::ZERO }, &things, 3.0)
    });
}

/// Only ratios of masses count. A power of two changes no rounding, so the motion is the same to the last bit.
#[test]
fn the_unit_of_mass_does_not_matter() {
    let still = Placed { turn: Quat::IDENTITY, shift: Vec3::ZERO };
    check(60, (few(), prop::sample::select(vec![0.25_f32, 8.0])), |(things, factor)| -> Outcome {
        let heavier: Vec<_> = things
            .iter()
            .map(|thing| {
                thing.map(|sphere| Sphere {
                    mass: factor * sphere.mass,
                    angular_momentum: factor * sphere.angular_momentum,
                    ..sphere
                })
            })
            .collect();
        for (a, b) in after(still.scene(&things), 10).iter().zip(&after(still.scene(&heavier), 10)) {
            prop_assert_eq!(a.position, b.position);
            prop_assert_eq!(a.velocity, b.velocity);
            prop_assert_eq!(a.orientation, b.orientation);
            prop_assert_eq!(factor * a.angular_momentum, b.angular_momentum);
        }
        Ok(())
    });
}
