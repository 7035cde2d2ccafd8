//! The axis along which spheres are divided, and places on it.

use std::ops::RangeInclusive;

use crate::scene::{Scene, Sphere};

/// Parts of a period in which gaps between spheres are looked for.
const BINS: usize = 1024;

/// An axis, and how places on it are measured: by the coordinate, or in a periodic scene by the way around the ring of its images.
#[derive(Debug)]
pub(super) struct Line {
    /// 0, 1 or 2.
    pub(super) axis: usize,
    /// The length that the moving spheres take up, in units.
    length: f64,
    ring: Option<Ring>,
}

/// A periodic axis.
#[derive(Debug)]
struct Ring {
    /// Where places begin: in the middle of the widest gap between spheres.
    start: f64,
    period: f64,
    /// The greatest coordinate of a moving sphere, of any sign.
    furthest: f64,
}

impl Line {
    /// The axis along which slabs of `size` processes have the fewest copies: along which the moving spheres extend furthest, for each face
    /// between two slabs. The first of equals. Images of a sheared scene slide along the flow, so it is never that axis.
    pub(super) fn longest(scene: &Scene, size: usize) -> Self {
        let flow = scene.shear().map(|shear| shear.flow);
        let mut lines = (0..3).filter(|axis| Some(*axis) != flow).map(|axis| Self::of(scene, axis));
        let first = lines.next().unwrap_or_else(|| Self::of(scene, 0));
        lines.fold(first, |best, line| if line.length_per_face(size) > best.length_per_face(size) { line } else { best })
    }

    fn of(scene: &Scene, axis: usize) -> Self {
        let places = scene.spheres().iter().filter(|sphere| !sphere.fixed).map(|sphere| sphere.centre()[axis]);
        if let Some([from, to]) = scene.periodic()[axis] {
            return Self::around(axis, [from, to].map(f64::from), places);
        }
        let ends = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        Self { axis, length: (ends[1] - ends[0]).max(0.0), ring: None }
    }

    /// A periodic axis, with these coordinates of the moving spheres.
    fn around(axis: usize, [from, to]: [f64; 2], places: impl Iterator<Item = f64>) -> Self {
        let period = to - from;
        let mut is_taken = vec![false; BINS];
        let mut furthest = 0.0_f64;
        for at in places {
            let bin = wrapped(at - from, period) / period * BINS as f64;
            is_taken[(bin as usize).min(BINS - 1)] = true;
            furthest = furthest.max(at.abs());
        }
        let [end, empty] = widest_gap(&is_taken);
        let length = period * (BINS - empty) as f64 / BINS as f64;
        let start = from + period * (end as f64 - 0.5 * empty as f64) / BINS as f64;
        Self { axis, length, ring: Some(Ring { start, period, furthest }) }
    }

    /// The length divided by the number of faces between slabs. A ring without a gap has one more.
    fn length_per_face(&self, size: usize) -> f64 {
        let is_closed = self.ring.as_ref().is_some_and(|ring| self.length >= ring.period);
        let faces = if is_closed { size } else { size - 1 };
        self.length / faces.max(1) as f64
    }

    /// The place of a sphere, in units. On a ring, from 0 to the period.
    pub(super) fn place(&self, sphere: &Sphere) -> f64 {
        match &self.ring {
            None => f64::from(sphere.position.to_array()[self.axis]),
            Some(Ring { start, period, .. }) => wrapped(sphere.centre()[self.axis] - start, *period),
        }
    }

    /// The distance of a place from a range of places; infinite for an empty range.
    pub(super) fn distance(&self, place: f64, range: &RangeInclusive<f64>) -> f64 {
        let [below, above] = [range.start() - place, place - range.end()];
        match &self.ring {
            _ if range.is_empty() => f64::INFINITY,
            _ if below <= 0.0 && above <= 0.0 => 0.0,
            None => below.max(above),
            Some(ring) => wrapped(below, ring.period).min(wrapped(above, ring.period)),
        }
    }

    /// What rounding of positions may change in the distance of a sphere from another one that is near, in units. Images that are near
    /// on a ring may have any coordinates.
    pub(super) fn rounding(&self, sphere: &Sphere) -> f64 {
        1e-6 * self.ring.as_ref().map_or(f64::from(sphere.position.to_array()[self.axis].abs()), |ring| ring.furthest)
    }
}

/// A length without whole periods, from 0 to the period.
fn wrapped(length: f64, period: f64) -> f64 {
    (length - period * (length / period).floor()).max(0.0)
}

/// The longest run of bins of a ring that are not taken: the bin after its end, and its length.
fn widest_gap(is_taken: &[bool]) -> [usize; 2] {
    let mut best = [0, 0];
    let mut empty = 0;
    // Twice around, because a gap may lie across the end.
    for (bin, is_taken) in is_taken.iter().chain(is_taken).enumerate() {
        empty = if *is_taken { 0 } else { empty + 1 };
        if empty > best[1] {
            best = [bin + 1, empty];
        }
    }
    [best[0], best[1].min(is_taken.len())]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shear;

    /// Spheres at these places, in a box that is periodic along some axes.
    fn scene_of(places: &[[f32; 3]], periods: [Option<[f32; 2]>; 3]) -> Scene {
        let mut scene = Scene::new();
        for place in places {
            scene.add_sphere(Sphere::new(*place, 0.1)).unwrap();
        }
        (0..3).for_each(|axis| scene.set_periodic(axis, periods[axis]).unwrap());
        scene
    }

    #[test]
    fn a_gap_may_lie_across_the_end() {
        let taken = |bins: &str| bins.chars().map(|bin| bin == 'x').collect::<Vec<bool>>();
        assert_eq!(widest_gap(&taken("xx..x...x.x")), [8, 3]);
        assert_eq!(widest_gap(&taken("..x.x....")), [11, 6]);
        assert_eq!(widest_gap(&taken("xxx")), [0, 0]);
        assert_eq!(widest_gap(&taken("...")), [6, 3]);
    }

    /// Grains that lie across a face of the box take up little of it. Those that have left it take up no more of it than before.
    #[test]
    fn the_longest_axis_is_that_of_the_images() {
        let bounds = Some([0.0, 8.0]);
        let heap = [[0.1, 0.0, 0.0], [-0.1, 1.0, 0.0], [7.9, 0.5, 0.0], [80.2, 0.5, 0.1]];
        let line = Line::longest(&scene_of(&heap, [bounds, None, None]), 2);
        assert_eq!((line.axis, line.length), (1, 1.0));
        let line = Line::of(&scene_of(&heap, [bounds, None, None]), 0);
        assert!(line.length < 0.32, "{line:?}");
        let places = heap.map(|[x, ..]| line.place(&Sphere::new([x, 0.0, 0.0], 0.1)));
        assert!(places.iter().all(|place| (place - 4.0).abs() < 0.3), "{places:?}");
    }

    /// With two processes, a full ring has two faces and a row one.
    #[test]
    fn a_full_ring_counts_its_faces() {
        let places: Vec<[f32; 3]> = (0..4000_u16).map(|k| [0.002 * f32::from(k), 0.0015 * f32::from(k), 0.0]).collect();
        let scene = scene_of(&places, [Some([0.0, 8.0]), None, None]);
        assert_eq!([2, 3, 4, 9].map(|size| Line::longest(&scene, size).axis), [1, 1, 0, 0]);
    }

    #[test]
    fn the_flow_of_a_shear_is_no_axis_of_slabs() {
        let places: Vec<[f32; 3]> = (0..4000_u16).map(|k| [0.003, 0.002, 0.001].map(|step| step * f32::from(k))).collect();
        let mut scene = scene_of(&places, [12.0, 8.0, 4.0].map(|length| Some([0.0, length])));
        let axis = |scene: &Scene| Line::longest(scene, 3).axis;
        assert_eq!(axis(&scene), 0);
        scene.set_shear(Some(Shear::new(1, 0, 0.5))).unwrap();
        assert_eq!(axis(&scene), 1);
        scene.set_shear(Some(Shear::new(2, 1, 0.5))).unwrap();
        assert_eq!(axis(&scene), 0);
    }

    #[test]
    fn distances_on_a_ring_go_both_ways() {
        let line = Line::of(&scene_of(&[[0.0; 3], [2.0, 0.0, 0.0]], [Some([0.0, 8.0]), None, None]), 0);
        for (place, range, wanted) in [
            (1.0, 0.5..=2.0, 0.0),
            (0.25, 0.5..=2.0, 0.25),
            (3.0, 0.5..=2.0, 1.0),
            (7.0, 0.5..=2.0, 1.5),
            (0.0, 5.0..=8.0, 0.0),
            (8.0, 0.0..=1.0, 0.0),
            (0.5, 5.0..=8.0, 0.5),
            (0.5, f64::INFINITY..=f64::NEG_INFINITY, f64::INFINITY),
        ] {
            assert_eq!(line.distance(place, &range), wanted, "{place} {range:?}");
        }
    }
}
