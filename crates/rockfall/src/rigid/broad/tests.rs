//! Pairs against trying all.

use glam::Vec3;

use crate::rigid::broad::{Aabb, pairs};
use crate::rigid::shape::tests::Random;

fn all_pairs(boxes: &[Aabb], may_touch: impl Fn(usize, usize) -> bool) -> Vec<(u32, u32)> {
    let is_apart = |a: &Aabb, b: &Aabb| (0..3).any(|k| a.min[k] > b.max[k] || b.min[k] > a.max[k]);
    let all = (0..boxes.len()).flat_map(|a| (a + 1..boxes.len()).map(move |b| (a, b)));
    all.filter(|(a, b)| !is_apart(&boxes[*a], &boxes[*b]) && may_touch(*a, *b)).map(|(a, b)| (a as u32, b as u32)).collect()
}

fn around(middle: Vec3, half: Vec3) -> Aabb {
    Aabb { min: middle - half, max: middle + half }
}

#[test]
fn pairs_agree_with_trying_all() {
    let mut random = Random(5);
    let mut total = 0;
    for round in 0..300 {
        let count = [3, 20, 200, 1500][round % 4];
        let spread = random.between(0.1, 30.0);
        let sizes = 10f32.powf(random.between(0.0, 4.0));
        let shift = random.vector(1.0) * 10f32.powf(random.between(0.0, 5.0));
        let mut boxes: Vec<Aabb> = (0..count)
            .map(|_| {
                let half = (random.vector(1.0).abs() + 0.01) * sizes.powf(-random.unit());
                around(shift + random.vector(spread), half)
            })
            .collect();
        if round % 2 == 0 {
            boxes[1] = around(Vec3::ZERO, Vec3::splat(1000.0));
            boxes[2] = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::new(f32::INFINITY, shift.y, f32::INFINITY) };
            boxes[count / 2] = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
            boxes[count - 1] = around(shift, Vec3::ZERO);
        }
        let may_touch = |a: usize, b: usize| {
            assert!(a < b);
            a % 7 != b % 5
        };
        let found = pairs(&boxes, may_touch);
        assert_eq!(found, all_pairs(&boxes, may_touch), "round {round}");
        total += found.len();
    }
    assert!(total > 100_000, "{total}");
}

/// Touching boxes of one size whose middles lie on borders of cells, far from the origin too.
#[test]
fn boxes_of_a_lattice_find_their_neighbours() {
    for shift in [0.0, 1000.0, -1e6] {
        let boxes: Vec<Aabb> = (0..1000)
            .map(|k| Vec3::new((k % 10) as f32, (k / 10 % 10) as f32, (k / 100) as f32) + shift)
            .map(|middle| around(middle, Vec3::splat(0.5)))
            .collect();
        // Neighbours in a lattice of 10: 26 around, less at the borders.
        assert_eq!(pairs(&boxes, |_, _| true).len(), (28 * 28 * 28 - 1000) / 2, "{shift}");
    }
}

#[test]
fn no_boxes_have_no_pairs() {
    assert!(pairs(&[], |_, _| true).is_empty());
    let point = Aabb { min: Vec3::ZERO, max: Vec3::ZERO };
    assert_eq!(pairs(&[point; 40], |_, _| true).len(), 780);
    let none = Aabb { min: Vec3::NAN, max: Vec3::NAN };
    assert!(pairs(&[none; 40], |_, _| true).is_empty());
}

/// A measurement: run with `--ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn a_pile_of_100_000_boxes() {
    let mut random = Random(1);
    let mut boxes: Vec<Aabb> = (0..100_000)
        .map(|k| Vec3::new((k % 50) as f32, (k / 2500) as f32, (k / 50 % 50) as f32))
        .map(|middle| around(middle + random.vector(0.1), Vec3::splat(0.52) + random.vector(0.1).abs()))
        .collect();
    boxes.push(around(Vec3::new(25.0, -500.0, 25.0), Vec3::splat(500.0)));
    boxes.push(Aabb { min: Vec3::NEG_INFINITY, max: Vec3::new(f32::INFINITY, -0.5, f32::INFINITY) });
    for _ in 0..5 {
        let start = std::time::Instant::now();
        let found = pairs(&boxes, |_, _| true);
        println!("{} pairs in {:.1?}, {} threads", found.len(), start.elapsed(), rayon::current_num_threads());
    }
}
