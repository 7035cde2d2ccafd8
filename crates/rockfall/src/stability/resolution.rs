//! Finds bodies that are too small for their distance from the origin, because positions are f32.

use std::fmt;

use crate::scene::Scene;
use crate::settings::Precision;
use crate::stability::nearest;

/// Largest distance between two neighbouring f32 positions that causes no warning, in radii.
const COARSE: f64 = 0.01;

/// A warning that positions cannot be represented finely enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coarse {
    /// Index of the worst sphere, in order of addition.
    pub sphere: usize,
    /// Its largest coordinate, in units.
    pub distance: f64,
    /// Distance between two neighbouring f32 numbers of this size, in units.
    pub resolution: f64,
    /// Its radius, in units.
    pub radius: f64,
    /// Whether the scene may have [`Precision::Double`].
    pub suits_double: bool,
}

impl fmt::Display for Coarse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = nearest(100.0 * self.resolution / self.radius);
        let [distance, resolution, radius] = [self.distance, self.resolution, self.radius].map(nearest);
        write!(
            f,
            "positions are too coarse: {distance} units from the origin, f32 resolves {resolution} units, {percent} % of the \
             radius {radius} units of sphere number {}: move the scene nearer to the origin, to within {} units{}",
            self.sphere,
            nearest(COARSE * self.radius / f64::from(f32::EPSILON)),
            if self.suits_double { ", or set precision double" } else { "" },
        )
    }
}

impl Scene {
    /// Returns a warning if the positions of a moving sphere are multiples of more than 1 % of its radius, for the sphere for
    /// which they are coarsest. With [`Precision::Double`] there is none.
    pub fn coarse(&self) -> Option<Coarse> {
        if self.settings.precision == Precision::Double {
            return None;
        }
        let movers = self.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed);
        let coarse = movers.map(|(index, sphere)| {
            let distance = sphere.position.abs().max_element();
            let resolution = f64::from(distance.next_up()) - f64::from(distance);
            let radius = sphere.radius.into();
            Coarse { sphere: index, distance: distance.into(), resolution, radius, suits_double: false }
        });
        let worst = coarse.max_by(|a, b| (a.resolution / a.radius).total_cmp(&(b.resolution / b.radius)))?;
        let suits_double = self.obstacle_to_double().is_none();
        (worst.resolution > COARSE * worst.radius).then_some(Coarse { suits_double, ..worst })
    }
}
