//! Necks of JKR cohesion that are too long, or too short-lived for the time step (docs/physics section 4.13).

use std::f64::consts::PI;

use crate::scene::Scene;
use crate::stability::{at_most, nearest};

/// Part of the smallest radius above which the distance at which contacts tear is not small.
const LONG: f64 = 0.1;
/// Steps in half a period of a contact that oscillates about its rest.
const STEPS: f64 = 20.0;

impl Scene {
    /// Warnings about contacts with JKR cohesion, for a time step of `dt` seconds. There are none in scenes without them.
    pub(super) fn neck_concerns(&self, dt: f32) -> Vec<String> {
        let neck = self.neck();
        if neck == 0.0 {
            return Vec::new();
        }
        let mut found = Vec::new();
        if neck > LONG {
            let percent = nearest(100.0 * neck);
            found.push(format!(
                "cohesion=jkr: contacts tear at a distance of up to {percent} % of the smallest radius; the theory holds for distances \
                 much shorter than the radius, so use a larger young or a smaller surface_energy"
            ));
        }
        if let Some((seconds, sphere)) = self.neck_time().filter(|(seconds, _)| STEPS * f64::from(dt) > seconds * (1.0 + 1e-6))
        {
            found.push(format!(
                "cohesion=jkr: a neck of {} oscillates with half a period of {} s, for which the time step is too long: its energy \
                 is not kept; at most {} s is advised",
                self.name_of_sphere(sphere),
                nearest(seconds),
                at_most(seconds / STEPS)
            ));
        }
        found
    }

    /// Shortest half period of a moving sphere in contact with one of equal size and mass, about the overlap without a force,
    /// and the index of the sphere.
    fn neck_time(&self) -> Option<(f64, usize)> {
        if !self.has_necks() {
            return None;
        }
        let numbers = 1..=self.materials().len() as u16;
        // For each material and its partners: k and E*.
        let partners: Vec<Vec<(f64, f64)>> = numbers
            .clone()
            .map(|one| {
                let with = |other| Some((self.neck_constant(one, other)?, f64::from(self.moduli(one, other)?[0])));
                numbers.clone().filter_map(with).collect()
            })
            .collect();
        let times = self.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed).filter_map(|(index, sphere)| {
            let number = usize::from(self.material_number(sphere.material).ok()?).checked_sub(1)?;
            let (mass, radius) = (0.5 * f64::from(sphere.mass), 0.5 * f64::from(sphere.radius));
            let of = |(constant, young): &(f64, f64)| {
                // dF/dd = 2 E* a (u³ - 3) / (u³ - 1) with u³ = 6 and a = k R*^(2/3) u².
                let stiffness = 1.2 * young * constant * radius.powf(2.0 / 3.0) * 6.0_f64.powf(2.0 / 3.0);
                PI * (mass / stiffness).sqrt()
            };
            let shortest = partners[number].iter().map(of).fold(f64::INFINITY, f64::min);
            shortest.is_finite().then_some((shortest, index))
        });
        times.min_by(|one, other| one.0.total_cmp(&other.0))
    }
}
