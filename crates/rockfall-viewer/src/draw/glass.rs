//! Opacities of the boxes. Boxes between the camera and the bodies, like the near walls of a pit, are shown as glass.

use rockfall::Cuboid;
use rockfall::glam::{Mat3, Vec3};

/// Number of boxes up to which opacities are computed. More boxes are bricks rather than walls.
const MOST_BOXES: usize = 200;
/// Fraction of the bodies that a box hides when it begins to become transparent, and when it is fully transparent.
const FADES: [f32; 2] = [0.1, 0.25];

/// Returns the opacity of each box such that bodies at `positions` are visible from `eye`.
pub(crate) fn opacities(boxes: &[Cuboid], positions: &[Vec3], eye: Vec3) -> Vec<f32> {
    if boxes.len() > MOST_BOXES || positions.is_empty() {
        return vec![1.0; boxes.len()];
    }
    boxes.iter().map(|cuboid| opacity(cuboid, positions, eye)).collect()
}

fn opacity(cuboid: &Cuboid, positions: &[Vec3], eye: Vec3) -> f32 {
    let [i, j, k] = cuboid.edges;
    let into = Mat3::from_cols(i, j, k).inverse();
    let from = into * (eye - cuboid.corner);
    let hidden = positions.iter().filter(|position| crosses_unit_cube(from, into * (**position - cuboid.corner))).count();
    let share = hidden as f32 / positions.len() as f32;
    1.0 - ((share - FADES[0]) / (FADES[1] - FADES[0])).clamp(0.0, 1.0)
}

/// Whether the line between two points goes through the unit cube; false if either point is in the cube.
fn crosses_unit_cube(from: Vec3, to: Vec3) -> bool {
    let line = to - from;
    let inside = |point: Vec3| point.cmpge(Vec3::ZERO).all() && point.cmple(Vec3::ONE).all();
    if inside(from) || inside(to) {
        return false;
    }
    let (mut first, mut last) = (0.0_f32, 1.0_f32);
    for axis in 0..3 {
        let (start, along) = (from[axis], line[axis]);
        if along.abs() < 1e-12 {
            if !(0.0..=1.0).contains(&start) {
                return false;
            }
            continue;
        }
        let (one, two) = (-start / along, (1.0 - start) / along);
        first = first.max(one.min(two));
        last = last.min(one.max(two));
    }
    first < last
}

#[cfg(test)]
mod tests {
    use super::*;

    const EYE: Vec3 = Vec3::new(0.0, 1.0, 10.0);

    fn positions() -> Vec<Vec3> {
        (0..10).map(|k| Vec3::new(0.2 * k as f32 - 0.9, 0.3, 0.0)).collect()
    }

    #[test]
    fn only_walls_in_front_of_the_bodies_become_transparent() {
        let before = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0]);
        let behind = Cuboid::between([-5.0, 0.0, -4.0], [5.0, 2.0, -3.0]);
        let floor = Cuboid::between([-50.0, -1.0, -50.0], [50.0, 0.0, 50.0]);
        assert_eq!(opacities(&[before, behind, floor], &positions(), EYE), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_wall_that_hides_a_fifth_of_the_bodies_has_an_opacity_of_a_third() {
        let small = Cuboid::between([-0.7, 0.0, 3.0], [-0.44, 2.0, 4.0]);
        let opacity = opacities(&[small], &positions(), EYE)[0];
        assert!((opacity - 1.0 / 3.0).abs() < 1e-5, "{opacity}");
    }

    #[test]
    fn many_boxes_stay_opaque() {
        let wall = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0]);
        assert!(opacities(&[wall; MOST_BOXES + 1], &positions(), EYE).iter().all(|opacity| *opacity == 1.0));
    }
}
