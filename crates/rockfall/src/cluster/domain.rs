//! Which process owns which sphere, and which processes need a copy of it.

use std::ops::RangeInclusive;

use crate::cluster::line::Line;
use crate::scene::{Scene, Sphere};

/// The division of the spheres of a scene into slabs along its longest axis, with equal numbers of moving spheres. It follows from
/// the positions and the periods alone, so that all processes find the same one.
#[derive(Debug)]
pub(super) struct Domain {
    /// The axis that the slabs divide.
    line: Line,
    /// The process that owns each sphere, in insertion order. Fixed spheres belong to process 0, and every process has a copy.
    pub(super) owners: Vec<u32>,
    /// The least and the greatest place of the spheres of each process; an empty range without spheres.
    extents: Vec<RangeInclusive<f64>>,
}

impl Domain {
    /// Divides the spheres of a scene among `size` processes.
    pub(super) fn of(scene: &Scene, size: usize) -> Self {
        let line = Line::longest(scene, size);
        let spheres = scene.spheres();
        let moving = spheres.iter().zip(0_u32..).filter(|(sphere, _)| !sphere.fixed);
        let mut order: Vec<(f64, u32)> = moving.map(|(sphere, index)| (line.place(sphere), index)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut owners = vec![0; spheres.len()];
        let mut extents = Vec::with_capacity(size);
        for rank in 0..size {
            let own = &order[rank * order.len() / size..(rank + 1) * order.len() / size];
            own.iter().for_each(|(_, index)| owners[*index as usize] = rank as u32);
            let ends = own.first().zip(own.last()).map(|(first, last)| first.0..=last.0);
            extents.push(ends.unwrap_or(f64::INFINITY..=f64::NEG_INFINITY));
        }
        Self { line, owners, extents }
    }

    /// The axis that the slabs divide: 0, 1 or 2.
    pub(super) fn axis(&self) -> usize {
        self.line.axis
    }

    /// The mean thickness of the slabs, in units; 0 without moving spheres.
    pub(super) fn thickness(&self) -> f64 {
        let start = self.extents.iter().map(|extent| *extent.start()).fold(f64::INFINITY, f64::min);
        let end = self.extents.iter().map(|extent| *extent.end()).fold(f64::NEG_INFINITY, f64::max);
        (end - start).max(0.0) / self.extents.len() as f64
    }

    /// Whether a process that does not own a sphere needs a copy of it: the sphere moves, and is within `depth` units of a sphere that the
    /// process owns, as far as the axis tells. On a periodic axis, the nearest image counts.
    pub(super) fn needs_copy(&self, rank: usize, sphere: &Sphere, depth: f64) -> bool {
        let depth = depth * (1.0 + 1e-5) + self.line.rounding(sphere);
        !sphere.fixed && self.line.distance(self.line.place(sphere), &self.extents[rank]) <= depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene_of(spheres: impl IntoIterator<Item = Sphere>) -> Scene {
        let mut scene = Scene::new();
        for sphere in spheres {
            scene.add_sphere(sphere).unwrap();
        }
        scene
    }

    #[test]
    fn slabs_have_equal_numbers_along_the_longest_axis() {
        let scene = scene_of((0..10_u8).map(|k| Sphere::new([0.0, 10.0 - f32::from(k), 0.5], 0.1)));
        let domain = Domain::of(&scene, 3);
        assert_eq!(domain.axis(), 1);
        assert_eq!(domain.thickness(), 3.0);
        assert_eq!(domain.owners, [2, 2, 2, 2, 1, 1, 1, 0, 0, 0]);
        let spheres = scene.spheres();
        assert!(domain.needs_copy(0, &spheres[6], 1.0) && !domain.needs_copy(0, &spheres[5], 1.0));
    }

    #[test]
    fn a_process_without_spheres_needs_no_copies() {
        for bounds in [None, Some([0.0, 9.0])] {
            let mut scene = scene_of([Sphere::new([0.0; 3], 1.0), Sphere::new([3.0, 0.0, 0.0], 1.0).fixed()]);
            scene.set_periodic(0, bounds).unwrap();
            let domain = Domain::of(&scene, 3);
            assert_eq!(domain.owners, [2, 0]);
            let spheres = scene.spheres();
            assert!(!domain.needs_copy(0, &spheres[0], 1e30) && !domain.needs_copy(2, &spheres[1], 1e30));
        }
    }

    /// The state has any image of a sphere, so slabs are those of the images in the box.
    #[test]
    fn slabs_are_a_ring_along_a_periodic_axis() {
        let places = [0.5, 12.0, -8.0, 3.5, 25.5, 5.5, -4.0, -76.5, 8.5, 9.5];
        let mut scene = scene_of(places.map(|x| Sphere::new([x, 0.0, 0.0], 0.1)));
        scene.set_periodic(0, Some([-0.5, 10.0])).unwrap();
        let domain = Domain::of(&scene, 3);
        assert_eq!(domain.owners, [0, 0, 0, 1, 1, 1, 2, 2, 2, 2]);
        let needs = |rank: usize, depth: f64| -> Vec<usize> {
            let copies = scene
                .spheres()
                .iter()
                .enumerate()
                .filter(|(index, sphere)| domain.owners[*index] as usize != rank && domain.needs_copy(rank, sphere, depth));
            copies.map(|(index, _)| index).collect()
        };
        assert_eq!([needs(0, 1.5), needs(1, 1.5), needs(2, 1.5)], [vec![3, 9], vec![2, 6], vec![0, 5]]);
        assert_eq!(needs(1, 4.0), [0, 1, 2, 6, 7, 8, 9]);
    }
}
