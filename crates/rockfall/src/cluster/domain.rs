//! Which process owns which sphere, and which processes need a copy of it.

use std::ops::RangeInclusive;

use crate::scene::Sphere;

/// The division of the spheres of a scene into slabs along its longest axis, with equal numbers of moving spheres. It follows from
/// the positions alone, so that all processes find the same one.
#[derive(Debug, Default)]
pub(super) struct Domain {
    /// The axis that the slabs divide: 0, 1 or 2.
    pub(super) axis: usize,
    /// The process that owns each sphere, in insertion order. Fixed spheres belong to process 0, and every process has a copy.
    pub(super) owners: Vec<u32>,
    /// The least and the greatest coordinate of the spheres of each process, in units; an empty range without spheres.
    extents: Vec<RangeInclusive<f64>>,
}

impl Domain {
    /// Divides spheres among `size` processes.
    pub(super) fn of(spheres: &[Sphere], size: usize) -> Self {
        let axis = longest_axis(spheres);
        let place = |index: &u32| spheres[*index as usize].position.to_array()[axis];
        let mut order: Vec<u32> = (0..spheres.len() as u32).filter(|index| !spheres[*index as usize].fixed).collect();
        order.sort_unstable_by(|a, b| place(a).total_cmp(&place(b)).then(a.cmp(b)));
        let mut owners = vec![0; spheres.len()];
        let mut extents = Vec::with_capacity(size);
        for rank in 0..size {
            let own = &order[rank * order.len() / size..(rank + 1) * order.len() / size];
            own.iter().for_each(|index| owners[*index as usize] = rank as u32);
            let ends = own.first().zip(own.last()).map(|(first, last)| f64::from(place(first))..=f64::from(place(last)));
            extents.push(ends.unwrap_or(f64::INFINITY..=f64::NEG_INFINITY));
        }
        Self { axis, owners, extents }
    }

    /// The mean thickness of the slabs, in units; 0 without moving spheres.
    pub(super) fn thickness(&self) -> f64 {
        let start = self.extents.iter().map(|extent| *extent.start()).fold(f64::INFINITY, f64::min);
        let end = self.extents.iter().map(|extent| *extent.end()).fold(f64::NEG_INFINITY, f64::max);
        (end - start).max(0.0) / self.extents.len() as f64
    }

    /// Whether a process that does not own a sphere needs a copy of it: the sphere moves, and is within `depth` units of a sphere that the
    /// process owns, as far as the axis tells.
    pub(super) fn needs_copy(&self, rank: usize, sphere: &Sphere, depth: f64) -> bool {
        let place = f64::from(sphere.position.to_array()[self.axis]);
        let extent = &self.extents[rank];
        // Rounding of positions.
        let depth = depth * (1.0 + 1e-5) + 1e-6 * place.abs();
        !sphere.fixed && place >= extent.start() - depth && place <= extent.end() + depth
    }
}

/// The axis along which the moving spheres extend furthest; the first of equals.
fn longest_axis(spheres: &[Sphere]) -> usize {
    let moving = || spheres.iter().filter(|sphere| !sphere.fixed).map(|sphere| sphere.position.to_array());
    let extent = |axis: usize| {
        let ends = moving().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], at| [low.min(at[axis]), high.max(at[axis])]);
        ends[1] - ends[0]
    };
    (1..3).fold(0, |best, axis| if extent(axis) > extent(best) { axis } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slabs_have_equal_numbers_along_the_longest_axis() {
        let spheres: Vec<Sphere> = (0..10_u8).map(|k| Sphere::new([0.0, 10.0 - f32::from(k), 0.5], 0.1)).collect();
        let domain = Domain::of(&spheres, 3);
        assert_eq!(domain.axis, 1);
        assert_eq!(domain.thickness(), 3.0);
        assert_eq!(domain.owners, [2, 2, 2, 2, 1, 1, 1, 0, 0, 0]);
        assert!(domain.needs_copy(0, &spheres[6], 1.0) && !domain.needs_copy(0, &spheres[5], 1.0));
    }

    #[test]
    fn a_process_without_spheres_needs_no_copies() {
        let spheres = [Sphere::new([0.0; 3], 1.0), Sphere::new([3.0, 0.0, 0.0], 1.0).fixed()];
        let domain = Domain::of(&spheres, 3);
        assert_eq!(domain.owners, [2, 0]);
        assert!(!domain.needs_copy(0, &spheres[0], 1e30) && !domain.needs_copy(2, &spheres[1], 1e30));
    }
}
