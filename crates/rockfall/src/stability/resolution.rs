//! Finds bodies that are too small or too stiff for their distance from the origin, because positions are f32.

use std::fmt;

use glam::Vec3;

use crate::scene::{Scene, Sphere};
use crate::settings::{ContactLaw, Precision, Settings};
use crate::stability::{Crowd, nearest};

/// Largest distance between two neighbouring f32 positions that causes no warning, in radii.
const COARSE: f64 = 0.01;

/// The same in overlaps at rest of a body that carries its own weight alone. In columns of five balls, all overlaps at rest were correct
/// to 0.3 of that overlap below this bound. From 14 times the bound on they were wrong by several times that overlap.
const COARSE_OVERLAP: f64 = 0.5;

/// Bounds of `precision auto` for single precision: the same distance in radii, and in overlaps at rest.
const FINE: f64 = 0.001;
const FINE_OVERLAP: f64 = 0.05;

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
        format!(
            "positions are too coarse: {distance} units from the origin, f32 resolves {resolution} units, {share}: move the scene \
             nearer to the origin, to within {within} units, or set precision double"
        )
    }
}

/// The precision of a scene, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ChosenPrecision {
    /// The precision, never [`Precision::Auto`].
    pub precision: Precision,
    /// What decides, if the setting is [`Precision::Auto`] and something needs [`Precision::Double`].
    pub reason: Option<PrecisionReason>,
}

/// Why a scene needs [`Precision::Double`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PrecisionReason {
    /// Neighbouring f32 coordinates are too far apart.
    Coarse {
        /// The largest coordinate of the scene, in units.
        distance: f64,
        /// Distance between two neighbouring f32 numbers of this size, in units.
        resolution: f64,
        /// The length that it is compared with, in units: an overlap at rest, or a radius.
        length: f64,
        /// Whether that length is an overlap at rest.
        is_overlap: bool,
    },
    /// The contact law has a history: springs that are shortened where a contact slides.
    History,
    /// The scene is periodic.
    Periodic,
}

impl fmt::Display for ChosenPrecision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.precision)?;
        match self.reason {
            None => Ok(()),
            Some(PrecisionReason::History) => {
                f.write_str(", because grains creep where rounding moves the springs of this contact law")
            }
            Some(PrecisionReason::Periodic) => f.write_str(", because the scene is periodic"),
            Some(PrecisionReason::Coarse { distance, resolution, length, is_overlap }) => {
                let [distance, resolution, length] = [distance, resolution, length].map(nearest);
                let of = if is_overlap { "an overlap at rest" } else { "a radius" };
                write!(
                    f,
                    ", because f32 resolves {resolution} units at {distance} units from the origin, and {of} is {length} units"
                )
            }
        }
    }
}

impl Scene {
    /// The precision of the settings. For [`Precision::Auto`] it is chosen: [`Precision::Double`] for contact laws with history, and where
    /// the distance between neighbouring f32 numbers at the largest coordinate of the scene exceeds 0.1 % of the radius or 5 % of the
    /// overlap at rest of a moving sphere (as in [`Scene::coarse`], with smaller bounds). Frames of the contact law `rigid` are in single
    /// precision.
    pub fn chosen_precision(&self) -> ChosenPrecision {
        if self.settings.precision != Precision::Auto {
            return ChosenPrecision { precision: self.settings.precision, reason: None };
        }
        let reason = self.needs_double();
        let precision = if reason.is_some() { Precision::Double } else { Precision::Single };
        ChosenPrecision { precision, reason }
    }

    fn needs_double(&self) -> Option<PrecisionReason> {
        if self.is_rigid() {
            return None;
        }
        if self.contact_law().has_history() {
            return Some(PrecisionReason::History);
        }
        if self.is_periodic() {
            return Some(PrecisionReason::Periodic);
        }
        let corners =
            self.boxes().iter().flat_map(|cuboid| [cuboid.corner, cuboid.corner + cuboid.edges.into_iter().sum::<Vec3>()]);
        let faces = self.polygons().iter().flat_map(|face| [face.corner, face.corner + face.left + face.right]);
        let centres = self.spheres().iter().map(|sphere| sphere.position);
        let distance = corners.chain(faces).chain(centres).map(|place| place.abs().max_element()).fold(0.0, f32::max);
        let resolution = f64::from(distance.next_up()) - f64::from(distance);
        let too_coarse = |length: f64, is_overlap: bool| {
            let bound = length * if is_overlap { FINE_OVERLAP } else { FINE };
            let reason = PrecisionReason::Coarse { distance: distance.into(), resolution, length, is_overlap };
            (resolution > bound).then_some(reason)
        };
        let movers = || self.spheres().iter().filter(|sphere| !sphere.fixed);
        let smallest = movers().map(|sphere| sphere.radius).min_by(f32::total_cmp)?;
        if let Some(reason) = too_coarse(smallest.into(), false) {
            return Some(reason);
        }
        if self.settings.gravity == 0.0 {
            return None;
        }
        let overlaps = movers().filter_map(|sphere| self.overlap_alone(sphere, &self.settings));
        too_coarse(overlaps.min_by(f64::total_cmp)?, true)
    }

    /// Returns a warning if the positions of a moving sphere are multiples of more than 1 % of its radius, or of more than half of
    /// its overlap at rest, for the sphere for which they are coarsest. With [`Precision::Double`], given or chosen, there is none.
    ///
    /// The overlap at rest is that of the sphere on one of its size, mass and material under its own weight: G / Cc with the law of the
    /// thesis, and as in [`Scene::soft_material`] with laws with history. Spheres that carry others overlap more. Spheres that springs,
    /// tethers or forces hold have none.
    pub fn coarse(&self) -> Option<Coarse> {
        if self.chosen_precision().precision == Precision::Double {
            return None;
        }
        let of_radius = |(index, sphere): (usize, &Sphere)| {
            let distance = sphere.position.abs().max_element();
            let resolution = f64::from(distance.next_up()) - f64::from(distance);
            let (distance, radius) = (distance.into(), sphere.radius.into());
            Coarse { sphere: index, distance, resolution, radius, overlap: None }
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
            Some(Coarse { overlap: Some((self.contact_law(), overlap)), ..of_radius((index, sphere)) })
        });
        overlapping.max_by(|a, b| a.excess().total_cmp(&b.excess())).filter(|worst| worst.excess() > 1.0)
    }

    /// Overlap of a sphere on one like it under its own weight; `None` if there is no force against overlaps, or an unknown one.
    fn overlap_alone(&self, sphere: &Sphere, settings: &Settings) -> Option<f64> {
        let gravity = f64::from(settings.gravity.abs());
        if self.contact_law() == ContactLaw::Thesis {
            let force = f64::from(settings.contact_force);
            return (force > 0.0).then(|| gravity / force);
        }
        Some(self.overlap_under(sphere, f64::from(sphere.mass) * gravity)?.0)
    }
}
