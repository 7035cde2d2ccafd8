//! What an inlet lets in: kinds of spheres or rigid bodies.

use std::fmt;
use std::str::FromStr;

use super::{check_name, demand, positive};
use crate::error::{Error, Result, quoted};
use crate::scene::{MaterialId, ShapeId, Tag};

/// Spheres of one kind, or rigid bodies of a shape, that an [`Inlet`](super::Inlet) lets in. What is said of spheres is also said of
/// bodies.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GrainKind {
    /// Name of a kind of spheres in a mixture, one word without `=`, `,` and `#`. Empty for the only kind of an inlet.
    pub name: String,
    /// Shape of the rigid bodies, which appear in random orientations; `None` for spheres.
    pub shape: Option<ShapeId>,
    /// The radii of the spheres, in units. For rigid bodies, [`Scene::add_inlet`](crate::Scene::add_inlet) sets the radius of the
    /// sphere about the centre of mass that encloses the shape.
    pub radii: Radii,
    /// What the distribution of radii counts.
    pub by: SizedBy,
    /// Mass of a sphere. For rigid bodies, [`Scene::add_inlet`](crate::Scene::add_inlet) sets that of the shape.
    pub mass: GrainMass,
    /// Material of the spheres. Parts of a shape have their own.
    pub material: Option<MaterialId>,
    /// Collision group of the spheres. Parts of a shape have their own.
    pub group: u16,
    /// Name, colour, look and label of the spheres.
    pub tag: Tag,
}

/// The radii of the spheres of an [`Inlet`](super::Inlet), in units. As text: `0.1`, `0.1..0.2`, `lognormal:0.1,0.3`.
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

/// The mass of a sphere of an [`Inlet`](super::Inlet).
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

impl GrainKind {
    /// Spheres of a radius in units.
    pub fn spheres(radius: f64) -> Self {
        Self {
            name: String::new(),
            shape: None,
            radii: Radii::Equal(radius),
            by: SizedBy::Number,
            mass: GrainMass::OfMaterial,
            material: None,
            group: 0,
            tag: Tag::default(),
        }
    }

    /// Rigid bodies of a shape.
    pub fn bodies(shape: ShapeId) -> Self {
        Self { shape: Some(shape), ..Self::spheres(0.0) }
    }

    /// Sets the name, which spheres of a mixture need.
    pub fn name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
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

    pub(crate) fn validate(&self) -> Result<()> {
        if !self.name.is_empty() {
            check_name("grain.name", &self.name)?;
        }
        self.radii.validate()?;
        match self.mass {
            GrainMass::Mass(mass) => positive("inlet.mass", mass)?,
            GrainMass::Density(density) => positive("inlet.density", density)?,
            GrainMass::OfMaterial => {}
        }
        let small = self.radii.bounds(self.by).0;
        demand(small as f32 > 0.0, "inlet.radius", small, "radii that are not 0 in f32")?;
        self.tag.validate()
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
