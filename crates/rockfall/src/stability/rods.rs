//! Finds rods that do not do what their author wants: rods that jump to another length, rods that hold nothing, and rods along
//! which springs pull too hard for RK4.

use std::collections::HashSet;

use glam::DVec3;

use crate::scene::Body;
use crate::scene::{BondedSets, RodId, Scene, SphereId};
use crate::settings::Integrator;
use crate::stability::{nearest, rounded_down};

/// Largest difference between the length of a rod and the distance of its ends that causes no warning, as a share of the larger
/// one.
const DIFFERENT: f64 = 0.01;
/// Rounding error of a distance, as a share of the largest coordinate.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
/// Radius and distance of the ends of a rod are taken for swapped fields if they differ by less than this share.
const SWAPPED: f64 = 0.1;
/// Largest share of the angular momentum of a rod that RK4 may lose in a second.
const LOST: f64 = 0.001;

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

    /// A message about the rod of fixed length along which springs and tethers pull or push hardest at the start, if RK4 loses too
    /// much of its angular momentum with a time step of `dt` seconds (docs/physics section 5.4, (6)).
    pub(super) fn strained_rod(&self, dt: f32, integrator: Integrator) -> Option<String> {
        let attached = self.springs().len() + self.tethers().len();
        if integrator != Integrator::Rk4 || attached == 0 || self.rods().iter().all(|rod| rod.length.is_none()) {
            return None;
        }
        let accelerations = self.spring_accelerations();
        let strain = |ends: [SphereId; 2], length: f32| -> Option<(f64, [SphereId; 2])> {
            let [Ok(a), Ok(b)] = ends.map(|id| self.spheres.index(id)) else { return None };
            let [one, two] = [a, b].map(|index| self.spheres()[index]);
            let axis = (two.position.as_dvec3() - one.position.as_dvec3()).normalize_or_zero();
            let along = axis.dot(accelerations[b] - accelerations[a]).abs() / f64::from(length);
            (!one.fixed && !two.fixed).then_some((along, ends))
        };
        // Rods of implied bodies are parts of rigid bodies, which keep it.
        let frames: HashSet<RodId> = self.bodies_to_imply().into_iter().flat_map(|body| body.rods).collect();
        let loose = self.rod_ids().zip(self.rods()).filter(|(id, _)| !frames.contains(id));
        let strains = loose.filter_map(|(_, rod)| strain([rod.end1, rod.end2], rod.length?));
        let (strain, ends) = strains.reduce(|most, next| if next.0 > most.0 { next } else { most })?;
        let lost = |dt: f64| strain.powi(2) * dt.powi(3) / 6.0;
        let largest_dt = (6.0 * LOST / strain.powi(2)).cbrt();
        let [a, b] = ends.map(|id| self.name_of(Body::Sphere(id)));
        (f64::from(dt) > largest_dt).then(|| {
            format!(
                "springs pull or push along the rod from {a} to {b}, and with rk4 it loses {} % of its angular momentum per second; \
                 the largest time step that works is {} s, or use --integrator velocity-verlet",
                nearest(100.0 * lost(dt.into())),
                rounded_down(largest_dt)
            )
        })
    }

    /// The acceleration of each sphere by springs and tethers at the start.
    fn spring_accelerations(&self) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; self.spheres().len()];
        let place = |index: usize| self.spheres()[index].position.as_dvec3();
        let pull = |d: DVec3, stiffness: f32, length: f32| {
            f64::from(stiffness) * (d.length() - f64::from(length)) * d.normalize_or_zero()
        };
        for spring in self.springs() {
            if let [Ok(a), Ok(b)] = [spring.a, spring.b].map(|id| self.spheres.index(id)) {
                let force = pull(place(b) - place(a), spring.stiffness, spring.length);
                forces[a] += force;
                forces[b] -= force;
            }
        }
        for tether in self.tethers() {
            if let Ok(index) = self.spheres.index(tether.sphere) {
                forces[index] += pull(tether.point.as_dvec3() - place(index), tether.stiffness, tether.length);
            }
        }
        let accelerated = forces.into_iter().zip(self.spheres());
        accelerated.map(|(force, sphere)| if sphere.fixed { DVec3::ZERO } else { force / f64::from(sphere.mass) }).collect()
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
