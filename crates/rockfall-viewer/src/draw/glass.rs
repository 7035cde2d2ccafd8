//! Boxes that stand between the camera and what is looked at: the near walls of a pit are shown as glass.

use rockfall::Cuboid;
use rockfall::glam::{Mat3, Vec3};

/// Beyond so many boxes none is tried: they are bricks then, not walls.
const MOST_BOXES: usize = 200;
/// Places along each side of what is looked at, to which the camera should see.
const PLACES: u32 = 4;
/// A box that hides this part of the places begins to fade, and one that hides that part has faded.
const FADES: [f32; 2] = [0.02, 0.12];

/// How opaque each box is, seen from `eye`, for what lies between two corners to be visible.
pub(crate) fn opacities(boxes: &[Cuboid], shown: Option<(Vec3, Vec3)>, eye: Vec3) -> Vec<f32> {
    match shown {
        Some((min, max)) if boxes.len() <= MOST_BOXES => boxes.iter().map(|cuboid| opacity(cuboid, min, max, eye)).collect(),
        _ => vec![1.0; boxes.len()],
    }
}

fn opacity(cuboid: &Cuboid, min: Vec3, max: Vec3, eye: Vec3) -> f32 {
    let [i, j, k] = cuboid.edges;
    let axes = Mat3::from_cols(i, j, k);
    let into = axes.inverse();
    let from = into * (eye - cuboid.corner);
    let part = |place: u32| (place as f32 + 0.5) / PLACES as f32;
    let mut hidden = 0;
    for place in 0..PLACES.pow(3) {
        let at = Vec3::new(part(place % PLACES), part(place / PLACES % PLACES), part(place / PLACES.pow(2)));
        let to = into * (min + at * (max - min) - cuboid.corner);
        hidden += u32::from(enters(from, to));
    }
    let share = hidden as f32 / PLACES.pow(3) as f32;
    1.0 - ((share - FADES[0]) / (FADES[1] - FADES[0])).clamp(0.0, 1.0)
}

/// Whether a line between two points outside of the unit cube goes through it. What is inside is not hidden: it rests in it.
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

    const SHOWN: Option<(Vec3, Vec3)> = Some((Vec3::new(-1.0, 0.0, -1.0), Vec3::ONE));
    const EYE: Vec3 = Vec3::new(0.0, 1.0, 10.0);

    #[test]
    fn walls_before_fade_and_floors_and_walls_behind_do_not() {
        let before = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0]);
        let behind = Cuboid::between([-5.0, 0.0, -4.0], [5.0, 2.0, -3.0]);
        let floor = Cuboid::between([-50.0, -1.0, -50.0], [50.0, 0.0, 50.0]);
        assert_eq!(opacities(&[before, behind, floor], SHOWN, EYE), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_wall_that_hides_little_fades_a_little() {
        let low = Cuboid::between([-5.0, 0.0, 1.5], [-0.2, 0.35, 2.0]);
        let opacity = opacities(&[low], SHOWN, EYE)[0];
        assert!(opacity > 0.0 && opacity < 1.0, "{opacity}");
    }

    #[test]
    fn many_boxes_are_bricks() {
        let wall = Cuboid::between([-5.0, 0.0, 3.0], [5.0, 2.0, 4.0]);
        assert!(opacities(&[wall; MOST_BOXES + 1], SHOWN, EYE).iter().all(|opacity| *opacity == 1.0));
    }
}
