//! Boxes that stand between the camera and the bodies: the near walls of a pit are shown as glass.

use rockfall::Cuboid;
use rockfall::glam::{Mat3, Vec3};

/// Beyond so many boxes none is tried: they are bricks then, not walls.
const MOST_BOXES: usize = 200;
/// A box that hides this part of the bodies begins to fade, and one that hides that part has faded.
const FADES: [f32; 2] = [0.1, 0.25];

/// How opaque each box is, seen from `eye`, for bodies at these places to be visible.
pub(crate) fn opacities(boxes: &[Cuboid], places: &[Vec3], eye: Vec3) -> Vec<f32> {
    if boxes.len() > MOST_BOXES || places.is_empty() {
        return vec![1.0; boxes.len()];
    }
    boxes.iter().map(|cuboid| opacity(cuboid, places, eye)).collect()
}

fn opacity(cuboid: &Cuboid, places: &[Vec3], eye: Vec3) -> f32 {
    let [i, j, k] = cuboid.edges;
    let into = Mat3::from_cols(i, j, k).inverse();
    let from = into * (eye - cuboid.corner);
    let hidden = places.iter().filter(|place| enters(from, into * (**place - cuboid.corner))).count();
    let share = hidden as f32 / places.len() as f32;
    1.0 - ((share - FADES[0]) / (FADES[1] - FADES[0])).clamp(0.0, 1.0)
}

/// Whether a line between two points outside of the unit cube goes through it.
fn enters(from: Vec3, to: Vec3) -> bool {
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

    fn places() -> Vec<Vec3> {
        (0..10).map(|k| Vec3::new(0.2 * k as f32 - 0.9, 0.3, 0.0)).collect()
    }

    #[test]
    fn walls_before_fade_and_floors_and_walls_behind_do_not() {
        let before = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0]);
        let behind = Cuboid::between([-5.0, 0.0, -4.0], [5.0, 2.0, -3.0]);
        let floor = Cuboid::between([-50.0, -1.0, -50.0], [50.0, 0.0, 50.0]);
        assert_eq!(opacities(&[before, behind, floor], &places(), EYE), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_wall_that_hides_two_in_ten_fades_by_two_thirds() {
        let small = Cuboid::between([-0.7, 0.0, 3.0], [-0.44, 2.0, 4.0]);
        let opacity = opacities(&[small], &places(), EYE)[0];
        assert!((opacity - 1.0 / 3.0).abs() < 1e-5, "{opacity}");
    }

    #[test]
    fn many_boxes_are_bricks() {
        let wall = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0]);
        assert!(opacities(&[wall; MOST_BOXES + 1], &places(), EYE).iter().all(|opacity| *opacity == 1.0));
    }
}
