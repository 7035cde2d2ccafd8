//! Finds rods that do not do what their author wants: rods that jump to another length, and rods that hold nothing.

use crate::scene::{BondedSets, RodId, Scene, SphereId};
use crate::simulation::Body;
use crate::stability::nearest;

/// Largest difference between the length of a rod and the distance of its ends that causes no warning, as a share of the larger
/// one.
const DIFFERENT: f64 = 0.01;
/// Rounding error of a distance, as a share of the largest coordinate.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
/// Radius and distance of the ends of a rod are taken for swapped fields if they differ by less than this share.
const SWAPPED: f64 = 0.1;

/// A rod that is likely a mistake.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct OddRod {
    /// The rod.
    pub rod: RodId,
    /// Its two spheres.
    pub ends: [SphereId; 2],
    /// Its radius, in units.
    pub radius: f64,
    /// Distance of the centres of its spheres, in units.
    pub distance: f64,
    /// Its fixed length in units, which differs from the distance. `None`: it has no length, one end is fixed, and nothing
    /// holds the other one.
    pub length: Option<f64>,
}

impl Scene {
    /// Returns the rods that are likely mistakes, in order of addition.
    ///
    /// The length of a rod should not differ by more than 1 % from the distance of its ends: the first step moves the ends to
    /// that length at once. A rod without a length holds nothing. It is reported if one of its ends is fixed and nothing else
    /// (rods of fixed length, springs, tethers) holds the other end.
    pub fn odd_rods(&self) -> Vec<OddRod> {
        let mut sets: Option<BondedSets> = None;
        let mut odd = Vec::new();
        for (rod, id) in self.rods().iter().zip(self.rod_ids()) {
            let ends = [rod.end1, rod.end2];
            let [Ok(a), Ok(b)] = ends.map(|id| self.spheres.index(id)) else { continue };
            let [one, two] = [a, b].map(|index| self.spheres()[index]);
            let distance = one.position.as_dvec3().distance(two.position.as_dvec3());
            let length = rod.length.map(f64::from);
            let is_odd = match length {
                _ if one.fixed && two.fixed => false,
                Some(length) => {
                    let farthest = one.position.abs().max(two.position.abs()).max_element();
                    (length - distance).abs() > DIFFERENT * length.max(distance) + ROUNDING * f64::from(farthest)
                }
                None if one.fixed != two.fixed => {
                    let sets = sets.get_or_insert_with(|| self.bonded_sets(|rod| rod.length.is_some()));
                    !sets.is_held(if one.fixed { b } else { a })
                }
                None => false,
            };
            if is_odd {
                odd.push(OddRod { rod: id, ends, radius: rod.radius.into(), distance, length });
            }
        }
        odd
    }
}

impl OddRod {
    /// A message that names both ends and gives the length and the distance.
    pub fn describe(&self, scene: &Scene) -> String {
        let [a, b] = self.ends.map(|id| scene.name_of(Body::Sphere(id)));
        let distance = nearest(self.distance);
        let Some(length) = self.length else {
            return format!(
                "the rod from {a} to {b} has no length, so it holds nothing; its ends are {distance} units apart: `R end1 end2 \
                 radius {distance}` keeps them there"
            );
        };
        let swapped = (self.radius - self.distance).abs() < SWAPPED * self.distance && length < self.radius;
        let hint = if swapped { "; radius and length may be swapped, expected `R end1 end2 radius length`" } else { "" };
        format!(
            "the rod from {a} to {b} has a length of {} units, but its ends are {distance} units apart: the first step moves them \
             at once{hint}",
            nearest(length)
        )
    }
}
