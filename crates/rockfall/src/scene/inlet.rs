//! Inlets, which insert spheres or rigid bodies while a simulation runs, and outlets, which remove them (docs/physics section 2.15).

use std::fmt;
use std::str::FromStr;

use glam::{DVec3, Vec3};

use super::tag::check_name;
use super::{MaterialId, Placement, Scene, ShapeId, Sphere, Tag};
use crate::error::{Error, Result, quoted};

mod grains;
mod state;
mod sum;

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
    /// Shape of the rigid bodies that appear, in random orientations; `None` for spheres.
    pub shape: Option<ShapeId>,
    /// The radii of the spheres, in units. For rigid bodies, [`Scene::add_inlet`] sets the radius of the sphere about the centre of mass
    /// that encloses the shape.
    pub radii: Radii,
    /// What the distribution of radii counts.
    pub by: SizedBy,
    /// Mass of a sphere. For rigid bodies, [`Scene::add_inlet`] sets that of the shape.
    pub mass: GrainMass,
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
    /// Material of the spheres. Parts of a shape have their own.
    pub material: Option<MaterialId>,
    /// Collision group of the spheres. Parts of a shape have their own.
    pub group: u16,
    /// Name, colour, look and label of the spheres.
    pub tag: Tag,
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

/// The radii of the spheres of an [`Inlet`], in units. As text: `0.1`, `0.1..0.2`, `lognormal:0.1,0.3`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Radii {
    /// All spheres have the same radius.
    Equal(f64),
    /// Every radius between the two is as likely as any other.
    Uniform(f64, f64),
    /// The logarithm of the radius has a normal distribution with this standard deviation about the logarithm of the median. Radii
    /// beyond four standard deviations are left out.
    LogNormal {
        /// Median.
        median: f64,
        /// Standard deviation of the natural logarithm.
        sigma: f64,
    },
}

/// What a distribution of radii counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum SizedBy {
    /// Spheres.
    #[default]
    Number,
    /// Their mass.
    Mass,
}

/// The mass of a sphere of an [`Inlet`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum GrainMass {
    /// That of the density of the material; 1 without one.
    #[default]
    OfMaterial,
    /// The same for all spheres.
    Mass(f64),
    /// A density in mass/units³.
    Density(f64),
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
    /// Creates an inlet between two opposite corners of a box in units, with its rate. The radius is in units.
    pub fn new(name: impl Into<String>, corners: [[f64; 3]; 2], rate: Rate, radius: f64) -> Self {
        Self {
            name: name.into(),
            corners: corners.map(DVec3::from_array),
            rate,
            shape: None,
            radii: Radii::Equal(radius),
            by: SizedBy::Number,
            mass: GrainMass::OfMaterial,
            velocity: Vec3::ZERO,
            from: 0.0,
            to: f64::INFINITY,
            limit: None,
            seed: 0,
            every: None,
            after: 0,
            material: None,
            group: 0,
            tag: Tag::default(),
        }
    }

    /// Creates an inlet of rigid bodies between two opposite corners of a box in units, with its rate.
    pub fn of_bodies(name: impl Into<String>, corners: [[f64; 3]; 2], rate: Rate, shape: ShapeId) -> Self {
        Self { shape: Some(shape), ..Self::new(name, corners, rate, 0.0) }
    }

    /// Sets the distribution of the radii, and what it counts.
    pub fn radii(mut self, radii: Radii, by: SizedBy) -> Self {
        (self.radii, self.by) = (radii, by);
        self
    }

    /// Gives all spheres the same mass.
    pub fn mass(mut self, mass: f64) -> Self {
        self.mass = GrainMass::Mass(mass);
        self
    }

    /// Sets the density of the spheres, in mass/units³.
    pub fn density(mut self, density: f64) -> Self {
        self.mass = GrainMass::Density(density);
        self
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

    /// Sets the material of the spheres.
    pub fn material(mut self, material: MaterialId) -> Self {
        self.material = Some(material);
        self
    }

    /// Sets the collision group of the spheres.
    pub fn group(mut self, group: u16) -> Self {
        self.group = group;
        self
    }

    /// Sets the name, colour, look and label of the spheres.
    pub fn tag(mut self, tag: Tag) -> Self {
        self.tag = tag;
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
        self.radii.validate()?;
        match self.mass {
            GrainMass::Mass(mass) => positive("inlet.mass", mass)?,
            GrainMass::Density(density) => positive("inlet.density", density)?,
            GrainMass::OfMaterial => {}
        }
        super::finite("inlet.velocity", self.velocity)?;
        demand(self.from.is_finite(), "inlet.from", self.from, "a finite number")?;
        demand(self.to >= self.from, "inlet.to", self.to, "a time that is not before `from`")?;
        check_every("inlet.every", self.every)?;
        demand(self.after <= MOST_BEFORE, "inlet.after", self.after, "a whole number up to 100000000")?;
        self.tag.validate()?;
        let (small, large) = self.radii.bounds(self.by);
        let room = (self.corners[1] - self.corners[0]).min_element();
        let expected = "a box whose edges are at least as long as the largest sphere is wide; lognormal reaches to four sigma";
        demand(2.0 * large <= room, "inlet.box", format!("{} wide for a diameter of {}", room, 2.0 * large), expected)?;
        demand(small as f32 > 0.0, "inlet.radius", small, "radii that are not 0 in f32")
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

impl Radii {
    fn validate(&self) -> Result<()> {
        match *self {
            Self::Equal(radius) => positive("inlet.radius", radius),
            Self::Uniform(from, to) => {
                positive("inlet.radius", from)?;
                demand(to.is_finite() && to >= from, "inlet.radius", to, "a finite number that is not less than the first one")
            }
            Self::LogNormal { median, sigma } => {
                positive("inlet.radius", median)?;
                demand((0.0..=1.0).contains(&sigma), "inlet.radius", sigma, "a sigma from 0 to 1")
            }
        }
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

impl fmt::Display for Radii {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Equal(radius) => write!(f, "{radius}"),
            Self::Uniform(from, to) => write!(f, "{from}..{to}"),
            Self::LogNormal { median, sigma } => write!(f, "lognormal:{median},{sigma}"),
        }
    }
}

impl FromStr for Radii {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let pair = |text: &str, between: &str| {
            let (one, other) = text.split_once(between)?;
            Some((one.parse().ok()?, other.parse().ok()?))
        };
        let log_normal = text.strip_prefix("lognormal:").and_then(|rest| pair(rest, ","));
        let found = match (log_normal, pair(text, "..")) {
            (Some((median, sigma)), _) => Some(Self::LogNormal { median, sigma }),
            (None, Some((from, to))) => Some(Self::Uniform(from, to)),
            (None, None) => text.parse().ok().map(Self::Equal),
        };
        let expected = "a radius r, a range a..b or lognormal:median,sigma";
        found.ok_or_else(|| Error::Invalid { field: "inlet.radius", value: quoted(text), expected })
    }
}

impl fmt::Display for SizedBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Mass { "mass" } else { "number" })
    }
}

impl FromStr for SizedBy {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "number" => Ok(Self::Number),
            "mass" => Ok(Self::Mass),
            _ => Err(Error::Invalid { field: "inlet.by", value: quoted(text), expected: "number or mass" }),
        }
    }
}

impl Scene {
    /// Adds an inlet. Simulations of the scene insert its spheres or rigid bodies.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a name that another inlet has or that is not one word, a box without volume or too small for the largest
    /// sphere, a volume rate of rigid bodies, and numbers that are out of range. [`Error::StaleHandle`] for a material or a shape that is
    /// not in the scene.
    pub fn add_inlet(&mut self, mut inlet: Inlet) -> Result<()> {
        if let Some(shape) = inlet.shape {
            let is_volume = matches!(inlet.rate, Rate::Volume(_));
            demand(!is_volume, "inlet.volume_rate", "given with a shape", "a rate or a mass rate, which rigid bodies have")?;
            let mass = GrainMass::Mass((self.shape_mass(shape)?.mass as f32).into());
            (inlet.radii, inlet.by, inlet.mass) = (Radii::Equal(self.shape_reach(shape)?), SizedBy::Number, mass);
        }
        inlet.validate()?;
        self.material_number(inlet.material)?;
        let is_known = self.inlets.iter().any(|known| known.name == inlet.name);
        demand(!is_known, "inlet.name", quoted(&inlet.name), "a name that no other inlet has")?;
        // Every sphere between the smallest and the largest one is valid, too.
        match inlet.shape {
            Some(shape) => drop(self.laid(Placement::new(shape).velocity(inlet.velocity))?),
            None => self.samples(&inlet).iter().try_for_each(Sphere::validate)?,
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
