//! Finds bodies that are too small or too stiff for their distance from the origin, because positions are f32.

use crate::scene::{Scene, Sphere};
use crate::settings::{ContactLaw, Precision, Settings};
use crate::stability::{Crowd, nearest};

/// Largest distance between two neighbouring f32 positions that causes no warning, in radii.
const COARSE: f64 = 0.01;

/// The same in overlaps at rest of a body that carries its own weight alone. In columns of five balls, all overlaps at rest were correct
/// to 0.3 of that overlap below this bound. At twice the bound they were wrong by 0.3 to 1.3 of it, and from 14 times the bound
/// on the balls did not stay in contact.
const COARSE_OVERLAP: f64 = 0.5;

/// A warning that positions cannot be represented finely enough.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Coarse {
    /// Index of the worst sphere, in order of addition.
    pub sphere: usize,
    /// Its largest coordinate, in units.
    pub distance: f64,
    /// Distance between two neighbouring f32 numbers of this size, in units.
    pub resolution: f64,
    /// Its radius, in units.
    pub radius: f64,
    /// The contact law, and the overlap at rest that the resolution exceeds, in units: that of this sphere on one like it, under its
    /// own weight. `None` if the resolution exceeds 1 % of the radius.
    pub overlap: Option<(ContactLaw, f64)>,
    /// Whether the scene may have [`Precision::Double`].
    pub suits_double: bool,
}

impl Coarse {
    /// The resolution over the largest one that causes no warning.
    fn excess(&self) -> f64 {
        self.resolution / self.overlap.map_or(COARSE * self.radius, |(_, overlap)| COARSE_OVERLAP * overlap)
    }
}

impl Coarse {
    /// A message that names the sphere as the scene text does.
    pub fn describe(&self, scene: &Scene) -> String {
        let [distance, resolution, radius] = [self.distance, self.resolution, self.radius].map(nearest);
        let sphere = scene.name_of_sphere(self.sphere);
        let share = match self.overlap {
            None => {
                let percent = nearest(100.0 * self.resolution / self.radius);
                format!("{percent} % of the radius {radius} units of {sphere}")
            }
            Some((law, overlap)) => format!(
                "too much for the overlap of {} units of {sphere} at rest on one like it, under its own weight alone (contact law {law})",
                nearest(overlap),
            ),
        };
        // The distance at which the resolution is the largest that causes no warning.
        let within = nearest(self.resolution / self.excess() / f64::from(f32::EPSILON));
        let remedy = if self.suits_double { ", or set precision double" } else { "" };
        format!(
            "positions are too coarse: {distance} units from the origin, f32 resolves {resolution} units, {share}: move the scene \
             nearer to the origin, to within {within} units{remedy}"
        )
    }
}

impl Scene {
    /// Returns a warning if the positions of a moving sphere are multiples of more than 1 % of its radius, or of more than half of
    /// its overlap at rest, for the sphere for which they are coarsest. With [`Precision::Double`] there is none.
    ///
    /// The overlap at rest is that of the sphere on one of its size, mass and material under its own weight: G / Cc with the law of the
    /// thesis, and as in [`Scene::soft_material`] with laws with history. Spheres that carry others overlap more. Spheres that springs,
    /// tethers or forces hold have none.
    pub fn coarse(&self) -> Option<Coarse> {
        if self.settings.precision == Precision::Double {
            return None;
        }
        let suits_double = self.obstacle_to_double().is_none();
        let of_radius = |(index, sphere): (usize, &Sphere)| {
            let distance = sphere.position.abs().max_element();
            let resolution = f64::from(distance.next_up()) - f64::from(distance);
            let (distance, radius) = (distance.into(), sphere.radius.into());
            Coarse { sphere: index, distance, resolution, radius, overlap: None, suits_double }
        };
        let movers = || self.spheres().iter().enumerate().filter(|(_, sphere)| !sphere.fixed);
        let worst = movers().map(of_radius).max_by(|a, b| a.excess().total_cmp(&b.excess()))?;
        if worst.excess() > 1.0 {
            return Some(worst);
        }
        let (sets, settings) = (self.sets_at_rest(), self.resolved_settings());
        if settings.gravity == 0.0 || self.crowd() == Crowd::None {
            return None;
        }
        let overlapping = movers().filter(|(index, _)| !sets.is_held(*index)).filter_map(|(index, sphere)| {
            let overlap = self.overlap_alone(sphere, &settings)?;
            Some(Coarse { overlap: Some((settings.contact_law, overlap)), ..of_radius((index, sphere)) })
        });
        overlapping.max_by(|a, b| a.excess().total_cmp(&b.excess())).filter(|worst| worst.excess() > 1.0)
    }

    /// Overlap of a sphere on one like it under its own weight; `None` if there is no force against overlaps, or an unknown one.
    fn overlap_alone(&self, sphere: &Sphere, settings: &Settings) -> Option<f64> {
        let gravity = f64::from(settings.gravity.abs());
        if settings.contact_law == ContactLaw::Thesis {
            let force = f64::from(settings.contact_force);
            return (force > 0.0).then(|| gravity / force);
        }
        Some(self.overlap_under(sphere, f64::from(sphere.mass) * gravity)?.0)
    }
}
