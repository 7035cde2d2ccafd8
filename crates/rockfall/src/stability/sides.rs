//! The contacts of a flat side of a rigid body, which add up (docs/physics.md section 6.2).

use std::collections::HashSet;

use glam::{DMat3, DQuat, DVec3};

use crate::scene::{BoxPart, Kinetics, Scene, Shape};

/// Spheres of a side whose heights differ by less than this fraction of their radius touch a wall together.
const FLAT: f64 = 0.05;

impl Scene {
    /// By how much the contacts of the flattest side of a rigid body are stiffer than a single contact, with the law of the thesis; at least
    /// 1. The sides are those along the axes of the shape and along its principal axes.
    pub(super) fn stiffness_of_sides(&self) -> f64 {
        let shapes: HashSet<_> = self.bodies().iter().map(|body| body.shape).collect();
        let forms = shapes.into_iter().filter_map(|id| Some((self.shape(id).ok()?, self.shape_mass(id).ok()?)));
        let sides = forms.flat_map(|(shape, kinetics)| {
            let axes = [DMat3::IDENTITY, DMat3::from_quat(kinetics.axes)];
            let directions = axes.into_iter().flat_map(|axes| [0, 1, 2].map(|axis| axes.col(axis)));
            directions.flat_map(|n| [n, -n]).map(|n| stiffness_of_side(shape, kinetics, n)).collect::<Vec<_>>()
        });
        sides.fold(1.0, f64::max)
    }
}

/// The same for the side of a shape in the direction `n`.
fn stiffness_of_side(shape: &Shape, kinetics: &Kinetics, n: DVec3) -> f64 {
    let inverse = kinetics.inverse_tensor(DQuat::IDENTITY);
    let is_solid = |number: usize| matches!(shape.box_of_sphere(number), Some(BoxPart::Solid(_)));
    let spheres = shape.all_spheres().into_iter().enumerate().filter(|(number, _)| !is_solid(*number));
    let reaches: Vec<(DVec3, f64, f64)> = spheres
        .map(|(_, sphere)| (sphere.centre.as_dvec3() - kinetics.centre, f64::from(sphere.radius)))
        .map(|(arm, radius)| (arm, radius, arm.dot(n) + radius))
        .collect();
    let furthest = reaches.iter().map(|(.., reach)| *reach).fold(f64::NEG_INFINITY, f64::max);
    let (mut masses, mut moment) = (0.0, DVec3::ZERO);
    for (arm, ..) in reaches.into_iter().filter(|(_, radius, reach)| furthest - reach < FLAT * radius) {
        let across = arm.cross(n);
        let mass = 1.0 / (1.0 / kinetics.mass + across.dot(inverse * across));
        masses += mass;
        moment += mass * across;
    }
    (masses * masses / kinetics.mass + moment.dot(inverse * moment)) / masses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cuboid, Placement};

    fn stiffness(shape: Shape) -> f64 {
        let mut scene = Scene::new();
        let shape = scene.add_shape(shape).unwrap();
        scene.add_body(Placement::new(shape)).unwrap();
        scene.stiffness_of_sides()
    }

    #[test]
    fn contacts_of_a_flat_side_add_up() {
        assert_eq!(Scene::new().stiffness_of_sides(), 1.0);
        let one = stiffness(Shape::new().sphere([0.0; 3], 1.0));
        assert!((one - 1.0).abs() < 1e-9, "{one}");
        // Each corner of a cube has a quarter of its mass. The rounding makes the lever a little shorter.
        let cube = stiffness(Shape::new().rounding(0.001).cuboid(Cuboid::between([0.0; 3], [1.0; 3])));
        assert!((cube - 1.0).abs() < 0.01, "{cube}");
        // A row of small balls of mass 1, whose moment is that of five points at -2 to 2, which is 10: sum of 1 / (1 / 5 + x^2 / 10) / 5.
        let row = (0..5_u8).fold(Shape::new(), |row, k| row.sphere([f32::from(k) - 2.0, 0.0, 0.0], 0.01).mass(5.0));
        let expected = [4.0, 1.0, 0.0, 1.0, 4.0].map(|squared: f64| 1.0 / (1.0 + 0.5 * squared)).iter().sum::<f64>();
        assert!((stiffness(row) - expected).abs() < 0.01, "{expected}");
    }
}
