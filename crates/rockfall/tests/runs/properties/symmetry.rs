//! Results do not depend on the position and rotation of a whole scene, nor on the unit of mass.

use glam::{Quat, Vec3};
use proptest::prelude::*;
use rockfall::{Backend, Cuboid, Polygon, Scene, Sphere, SphereState};

use super::things::{Outcome, Thing, check, direction, simulation, thing, vector, weightless};

const DT: f32 = 0.004;

/// A few bodies.
fn few() -> impl Strategy<Value = Vec<Thing>> {
    prop::collection::vec(thing(1.5, 2.0), 2..8)
}

/// Rotation and shift of a whole scene.
#[derive(Clone, Copy, Debug)]
struct Placed {
    turn: Quat,
    shift: Vec3,
}

impl Placed {
    fn point(&self, place: Vec3) -> Vec3 {
        self.turn * place + self.shift
    }

    fn sphere(&self, mut sphere: Sphere) -> Sphere {
        sphere.position = self.point(sphere.position);
        sphere.velocity(self.turn * sphere.velocity).angular_momentum(self.turn * sphere.angular_momentum)
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

/// Asserts that a moved scene gives the moved result. The tolerance covers the rounding of positions of up to `size`
/// units in six stages, times Cc dt = 4/s for velocities, and the larger error of badly conditioned normals.
fn assert_moved(placed: Placed, things: &[Thing], size: f32) -> Outcome {
    let identity = Placed { turn: Quat::IDENTITY, shift: Vec3::ZERO };
    let (expected, found) = (after(identity.scene(things), 1), after(placed.scene(things), 1));
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
fn a_shifted_scene_gives_the_shifted_result() {
    check(150, (few(), vector(8.0)), |(things, shift)| -> Outcome {
        let turn = Quat::IDENTITY;
        assert_moved(Placed { turn, shift }, &things, 10.0)
    });
}

#[test]
fn a_rotated_scene_gives_the_rotated_result() {
    check(150, (few(), direction(), 0.1_f32..3.0), |(things, axis, angle)| -> Outcome {
        let turn = Quat::from_axis_angle(axis, angle);
        assert_moved(Placed { turn, shift: Vec3::ZERO }, &things, 3.0)
    });
}

/// Only ratios of masses count. A power of two changes no rounding, so the motion is bitwise identical.
#[test]
fn the_unit_of_mass_does_not_matter() {
    let identity = Placed { turn: Quat::IDENTITY, shift: Vec3::ZERO };
    check(60, (few(), prop::sample::select(vec![0.25_f32, 8.0])), |(things, factor)| -> Outcome {
        let heavier: Vec<_> = things
            .iter()
            .map(|thing| {
                thing.map(|sphere| sphere.mass(factor * sphere.mass).angular_momentum(factor * sphere.angular_momentum))
            })
            .collect();
        for (a, b) in after(identity.scene(&things), 10).iter().zip(&after(identity.scene(&heavier), 10)) {
            prop_assert_eq!(a.position, b.position);
            prop_assert_eq!(a.velocity, b.velocity);
            prop_assert_eq!(a.orientation, b.orientation);
            prop_assert_eq!(factor * a.angular_momentum, b.angular_momentum);
        }
        Ok(())
    });
}
