//! Inlets, which insert spheres or rigid bodies while a simulation runs, and outlets, which remove them (docs/physics section 2.15).

use std::fmt;

use glam::{DVec3, Vec3};

use super::tag::check_name;
use super::{MaterialId, Placement, Scene, ShapeId, Sphere, Tag};
use crate::error::{Error, Result, quoted};

mod grains;
mod kind;
mod state;
mod sum;

pub(crate) use grains::Sequence;
pub use kind::{GrainKind, GrainMass, Radii, SizedBy};
pub(crate) use state::{FlowState, InletState, Passed};
pub(crate) use sum::Sum;

/// Largest value of [`Inlet::after`].
const MOST_BEFORE: u64 = 100_000_000;

/// A box in which spheres appear, or rigid bodies of a shape, at a rate. What is said of spheres below is also said of bodies.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Inlet {
    /// Name, which no other inlet of the scene has. It is one word without `=`, `,` and `#`, and begins with a letter or `_`.
    pub name: String,
    /// Two opposite corners of the box, in units. Spheres appear wholly inside it.
    pub corners: [DVec3; 2],
    /// How many spheres, how much mass or how much volume come in.
    pub rate: Rate,
    /// What comes in: one kind, or the kinds of a mixture with their shares, greater than 0.
    pub kinds: Vec<(GrainKind, f64)>,
    /// What the shares of a mixture count.
    pub shares: SizedBy,
    /// Velocity of a sphere that appears, in units/s.
    pub velocity: Vec3,
    /// Time in s from which on spheres come in.
    pub from: f64,
    /// Time in s up to which spheres become due, infinite if there is none.
    pub to: f64,
    /// Greatest number of spheres that come in.
    pub limit: Option<u64>,
    /// Seed of the radii and places.
    pub seed: u64,
    /// Number of steps between two times at which spheres may appear; `None` for a number that follows from the radii, the velocity
    /// and gravity.
    pub every: Option<u64>,
    /// Number of spheres that came in before the simulation began. The sequence of spheres goes on after them.
    pub after: u64,
}

/// How fast an [`Inlet`] lets spheres in. Rates are not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rate {
    /// Spheres per second.
    Number(f64),
    /// Mass per second.
    Mass(f64),
    /// Volume of the spheres per second, in units³/s.
    Volume(f64),
}

/// A box in which spheres disappear, with all that is attached to them.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Outlet {
    /// Name, which no other outlet of the scene has. It is one word without `=`, `,` and `#`, and begins with a letter or `_`.
    pub name: String,
    /// Two opposite corners of the box, in units.
    pub corners: [DVec3; 2],
    /// Number of steps between two looks at the box; `None` for a number that follows from the box and gravity.
    pub every: Option<u64>,
}

impl Inlet {
    /// Creates an inlet of spheres between two opposite corners of a box in units, with its rate. The radius is in units.
    pub fn new(name: impl Into<String>, corners: [[f64; 3]; 2], rate: Rate, radius: f64) -> Self {
        Self::of(name, corners, rate, GrainKind::spheres(radius))
    }

    /// Creates an inlet of one kind between two opposite corners of a box in units, with its rate.
    pub fn of(name: impl Into<String>, corners: [[f64; 3]; 2], rate: Rate, kind: GrainKind) -> Self {
        Self {
            name: name.into(),
            corners: corners.map(DVec3::from_array),
            rate,
            kinds: vec![(kind, 1.0)],
            shares: SizedBy::Number,
            velocity: Vec3::ZERO,
            from: 0.0,
            to: f64::INFINITY,
            limit: None,
            seed: 0,
            every: None,
            after: 0,
        }
    }

    /// Creates an inlet of rigid bodies between two opposite corners of a box in units, with its rate.
    pub fn of_bodies(name: impl Into<String>, corners: [[f64; 3]; 2], rate: Rate, shape: ShapeId) -> Self {
        Self::of(name, corners, rate, GrainKind::bodies(shape))
    }

    /// Lets in a mixture: kinds with their shares, and what the shares count. Shares of 1 and 3 are a quarter and three quarters.
    pub fn mix(mut self, kinds: impl IntoIterator<Item = (GrainKind, f64)>, shares: SizedBy) -> Self {
        (self.kinds, self.shares) = (kinds.into_iter().collect(), shares);
        self
    }

    fn each(mut self, change: impl Fn(GrainKind) -> GrainKind) -> Self {
        self.kinds = self.kinds.into_iter().map(|(kind, share)| (change(kind), share)).collect();
        self
    }

    /// Sets the distribution of the radii of all kinds, and what it counts.
    pub fn radii(self, radii: Radii, by: SizedBy) -> Self {
        self.each(|kind| kind.radii(radii, by))
    }

    /// Gives all spheres the same mass.
    pub fn mass(self, mass: f64) -> Self {
        self.each(|kind| kind.mass(mass))
    }

    /// Sets the density of all spheres, in mass/units³.
    pub fn density(self, density: f64) -> Self {
        self.each(|kind| kind.density(density))
    }

    /// Sets the material of all spheres.
    pub fn material(self, material: MaterialId) -> Self {
        self.each(|kind| kind.material(material))
    }

    /// Sets the collision group of all spheres.
    pub fn group(self, group: u16) -> Self {
        self.each(|kind| kind.group(group))
    }

    /// Sets the name, colour, look and label of all spheres.
    pub fn tag(self, tag: Tag) -> Self {
        self.each(|kind| kind.tag(tag.clone()))
    }

    /// The shapes of the rigid bodies that come in.
    pub(crate) fn shapes(&self) -> impl Iterator<Item = ShapeId> {
        self.kinds.iter().filter_map(|(kind, _)| kind.shape)
    }

    /// The smallest and the largest radius of what comes in, in units.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        let bounds = self.kinds.iter().map(|(kind, _)| kind.radii.bounds(kind.by));
        bounds.fold((f64::INFINITY, 0.0), |(small, large), (least, most)| (small.min(least), large.max(most)))
    }

    /// Sets the velocity with which spheres appear, in units/s.
    pub fn velocity(mut self, velocity: impl Into<Vec3>) -> Self {
        self.velocity = velocity.into();
        self
    }

    /// Sets when spheres come in, in s.
    pub fn during(mut self, from: f64, to: f64) -> Self {
        (self.from, self.to) = (from, to);
        self
    }

    /// Sets the greatest number of spheres that come in.
    pub fn limit(mut self, limit: u64) -> Self {
        self.limit = Some(limit);
        self
    }

    /// Sets the seed.
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Sets the number of steps between two times at which spheres may appear.
    pub fn every(mut self, steps: u64) -> Self {
        self.every = Some(steps);
        self
    }

    fn validate(&self) -> Result<()> {
        check_name("inlet.name", &self.name)?;
        check_box("inlet.box", &self.corners)?;
        let (field, rate) = match self.rate {
            Rate::Number(rate) => ("inlet.rate", rate),
            Rate::Mass(rate) => ("inlet.mass_rate", rate),
            Rate::Volume(rate) => ("inlet.volume_rate", rate),
        };
        demand(rate >= 0.0 && rate.is_finite(), field, rate, "a finite number, not negative")?;
        demand(!self.kinds.is_empty(), "inlet.mix", "empty", "at least one kind with its share")?;
        for (kind, share) in &self.kinds {
            kind.validate()?;
            demand(*share > 0.0 && share.is_finite(), "inlet.mix", share, "shares greater than 0")?;
        }
        self.validate_names()?;
        super::finite("inlet.velocity", self.velocity)?;
        demand(self.from.is_finite(), "inlet.from", self.from, "a finite number")?;
        demand(self.to >= self.from, "inlet.to", self.to, "a time that is not before `from`")?;
        check_every("inlet.every", self.every)?;
        demand(self.after <= MOST_BEFORE, "inlet.after", self.after, "a whole number up to 100000000")?;
        let large = self.bounds().1;
        let room = (self.corners[1] - self.corners[0]).min_element();
        let expected = "a box whose edges are at least as long as the largest sphere is wide; lognormal reaches to four sigma";
        demand(2.0 * large <= room, "inlet.box", format!("{} wide for a diameter of {}", room, 2.0 * large), expected)
    }

    /// In a mixture, every kind of spheres has a name of its own.
    fn validate_names(&self) -> Result<()> {
        let spheres = || self.kinds.iter().map(|(kind, _)| kind).filter(|kind| kind.shape.is_none());
        for kind in spheres().filter(|_| self.kinds.len() > 1) {
            let count = spheres().filter(|other| other.name == kind.name).count();
            demand(!kind.name.is_empty() && count == 1, "inlet.mix", quoted(&kind.name), "a name for each kind of spheres")?;
        }
        Ok(())
    }
}

impl Outlet {
    /// Creates an outlet between two opposite corners of a box, in units.
    pub fn new(name: impl Into<String>, corners: [[f64; 3]; 2]) -> Self {
        Self { name: name.into(), corners: corners.map(DVec3::from_array), every: None }
    }

    /// Sets the number of steps between two looks at the box.
    pub fn every(mut self, steps: u64) -> Self {
        self.every = Some(steps);
        self
    }

    fn validate(&self) -> Result<()> {
        check_name("outlet.name", &self.name)?;
        check_box("outlet.box", &self.corners)?;
        check_every("outlet.every", self.every)
    }

    /// Whether a point is in the box.
    pub(crate) fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.corners[0]).all() && point.cmple(self.corners[1]).all()
    }
}

pub(super) fn demand(holds: bool, field: &'static str, value: impl fmt::Display, expected: &'static str) -> Result<()> {
    if holds { Ok(()) } else { Err(Error::Invalid { field, value: value.to_string(), expected }) }
}

fn positive(field: &'static str, number: f64) -> Result<()> {
    demand(number > 0.0 && number.is_finite(), field, number, "a finite number greater than 0")
}

fn check_every(field: &'static str, every: Option<u64>) -> Result<()> {
    demand(every != Some(0), field, 0, "a number of steps, at least 1")
}

pub(super) fn check_box(field: &'static str, [low, high]: &[DVec3; 2]) -> Result<()> {
    let is_box = low.is_finite() && high.is_finite() && low.cmplt(*high).all();
    demand(is_box, field, format!("{low} to {high}"), "six finite numbers x0,y0,z0,x1,y1,z1 with x0 < x1, y0 < y1 and z0 < z1")
}

impl Scene {
    /// Adds an inlet. Simulations of the scene insert its spheres or rigid bodies.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a name that another inlet has or that is not one word, a box without volume or too small for the largest
    /// sphere, a volume rate of rigid bodies, a mixture without kinds or with kinds of the same name, and numbers that are out of
    /// range. [`Error::StaleHandle`] for a material or a shape that is
    /// not in the scene.
    pub fn add_inlet(&mut self, mut inlet: Inlet) -> Result<()> {
        for (kind, _) in &mut inlet.kinds {
            let Some(shape) = kind.shape else { continue };
            let is_volume = matches!(inlet.rate, Rate::Volume(_));
            demand(!is_volume, "inlet.volume_rate", "given with a shape", "a rate or a mass rate, which rigid bodies have")?;
            let mass = GrainMass::Mass((self.shape_mass(shape)?.mass as f32).into());
            (kind.radii, kind.by, kind.mass) = (Radii::Equal(self.shape_reach(shape)?), SizedBy::Number, mass);
        }
        inlet.validate()?;
        let is_known = self.inlets.iter().any(|known| known.name == inlet.name);
        demand(!is_known, "inlet.name", quoted(&inlet.name), "a name that no other inlet has")?;
        for (kind, _) in &inlet.kinds {
            self.material_number(kind.material)?;
            // Every sphere between the smallest and the largest one is valid, too.
            match kind.shape {
                Some(shape) => drop(self.laid(Placement::new(shape).velocity(inlet.velocity))?),
                None => self.samples(&inlet, kind).iter().try_for_each(Sphere::validate)?,
            }
        }
        self.inlets.push(inlet);
        Ok(())
    }

    /// Adds an outlet. Simulations of the scene remove the spheres that enter it.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a name that another outlet has or that is not one word, and for a box without volume.
    pub fn add_outlet(&mut self, outlet: Outlet) -> Result<()> {
        outlet.validate()?;
        let is_known = self.outlets.iter().any(|known| known.name == outlet.name);
        demand(!is_known, "outlet.name", quoted(&outlet.name), "a name that no other outlet has")?;
        self.outlets.push(outlet);
        Ok(())
    }

    /// The inlets, in order of addition.
    pub fn inlets(&self) -> &[Inlet] {
        &self.inlets
    }

    /// The outlets, in order of addition.
    pub fn outlets(&self) -> &[Outlet] {
        &self.outlets
    }

    /// Makes the inlets begin where they are after `time` seconds. `entered` has the number of spheres that came in of each.
    pub(crate) fn advance_inlets(&mut self, time: f64, entered: impl Iterator<Item = u64>) {
        for (inlet, entered) in self.inlets.iter_mut().zip(entered) {
            inlet.from -= time;
            inlet.to -= time;
            inlet.after = entered;
        }
    }
}

#[cfg(test)]
#[path = "inlet_tests.rs"]
mod tests;
