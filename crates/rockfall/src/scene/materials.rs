//! Materials of objects, and the properties of pairs of materials (docs/physics section 4.10).

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result, quoted};
use crate::scene::Scene;
use crate::scene::registry::Handle;

/// Handle of a [`Material`].
pub type MaterialId = Handle<Material>;

/// Maximum number of materials of a scene. The kernels read a table with a row for every pair of them.
pub const MAX_MATERIALS: usize = 255;

/// A material: a name and constants of the solid. Constants that are `None` are not known.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Material {
    /// Name, which differs from the names of all other materials of the scene. It has no white space, `=` and `#`, and is not
    /// `-`.
    pub name: String,
    /// Density in mass/units³, greater than 0.
    pub density: Option<f32>,
    /// Young's modulus in mass/(units s²), greater than 0.
    pub young: Option<f32>,
    /// Poisson's ratio, at least 0 and less than 0.5.
    pub poisson: Option<f32>,
}

impl Material {
    /// Creates a material without constants.
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), density: None, young: None, poisson: None }
    }

    /// Sets the density, in mass/units³.
    pub fn density(mut self, density: f32) -> Self {
        self.density = Some(density);
        self
    }

    /// Sets Young's modulus, in mass/(units s²).
    pub fn young(mut self, young: f32) -> Self {
        self.young = Some(young);
        self
    }

    /// Sets Poisson's ratio.
    pub fn poisson(mut self, poisson: f32) -> Self {
        self.poisson = Some(poisson);
        self
    }

    /// Names of the constants in scene files: `@material NAME density=D young=E poisson=N`.
    pub(crate) const KEYS: [&'static str; 3] = ["density", "young", "poisson"];

    /// The constant of a name in [`Material::KEYS`].
    pub(crate) fn constant(&mut self, key: &str) -> Option<&mut Option<f32>> {
        match key {
            "density" => Some(&mut self.density),
            "young" => Some(&mut self.young),
            "poisson" => Some(&mut self.poisson),
            _ => None,
        }
    }

    fn validate(&self) -> Result<()> {
        let has = |letter: char| letter.is_whitespace() || letter == '=' || letter == '#' || letter.is_control();
        if self.name.is_empty() || self.name == "-" || self.name.contains(has) {
            return Err(Error::Invalid {
                field: "material.name",
                value: quoted(&self.name),
                expected: "a word other than `-`, without = and #",
            });
        }
        known("material.density", self.density, |density| density > 0.0, "a finite number greater than 0")?;
        known("material.young", self.young, |young| young > 0.0, "a finite number greater than 0")?;
        known("material.poisson", self.poisson, |poisson| (0.0..0.5).contains(&poisson), "at least 0 and less than 0.5")
    }
}

/// Properties of the contacts between two materials, or of a material with itself. Properties that are `None` follow from the
/// rules of [`Scene::pair`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Pair {
    /// Coefficient of restitution e, from 0 to 1.
    pub restitution: Option<f32>,
    /// Coefficient of Coulomb friction, not negative. With the thesis's contact law, it takes the place of
    /// [`Settings::coulomb_friction`](crate::Settings::coulomb_friction),
    /// [`Settings::collision_friction`](crate::Settings::collision_friction) and
    /// [`Settings::friction`](crate::Settings::friction) in the contacts of the pair.
    pub friction: Option<f32>,
    /// Normal stiffness k_n of the law `linear`, in mass/s², greater than 0.
    pub stiffness: Option<f32>,
    /// Characteristic velocity of the law `linear`, in units/s, greater than 0. Where the pair has no stiffness, its stiffness is that
    /// with which an impact at this velocity is as deep as by Hertz's theory.
    pub characteristic_velocity: Option<f32>,
    /// Coefficient of rolling friction mu_r of the laws with history, without a unit, not negative: a sphere on a slope does not roll
    /// where tan(slope) < mu_r. The thesis's law has no rolling resistance.
    pub rolling_friction: Option<f32>,
    /// Model of the rolling resistance; [`RollingModel::SpringDashpot`] where it is `None`.
    pub rolling_model: Option<RollingModel>,
    /// Damping ratio of [`RollingModel::SpringDashpot`], not negative; 0.3 where it is `None`.
    pub rolling_damping: Option<f32>,
    /// Coefficient of twisting friction of the laws with history, without a unit, not negative.
    pub twisting_friction: Option<f32>,
    /// Surface energy gamma of the laws with history, in mass/s² (J/m²), not negative: objects in contact attract each other
    /// (docs/physics section 4.13).
    pub surface_energy: Option<f32>,
    /// Model of the attraction; [`CohesionModel::Dmt`] where it is `None`.
    pub cohesion: Option<CohesionModel>,
}

/// Model of the resistance to rolling (docs/physics section 4.12).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RollingModel {
    /// `a`: a torque of constant size against the rolling. Bodies on a slope creep.
    ConstantTorque,
    /// `c`: a spring that yields, and a dashpot. Bodies on a slope come to rest.
    #[default]
    SpringDashpot,
}

impl fmt::Display for RollingModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ConstantTorque => "a",
            Self::SpringDashpot => "c",
        })
    }
}

impl FromStr for RollingModel {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "a" => Ok(Self::ConstantTorque),
            "c" => Ok(Self::SpringDashpot),
            _ => Err(Error::Invalid { field: "pair.rolling_model", value: quoted(text), expected: "a or c" }),
        }
    }
}

/// Model of the attraction in contacts (docs/physics section 4.13).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum CohesionModel {
    /// `dmt` (Derjaguin, Muller and Toporov): a constant force 4 pi gamma R* while two objects overlap. It suits small and hard
    /// bodies.
    #[default]
    Dmt,
    /// `jkr` (Johnson, Kendall and Roberts): a neck that sticks until the objects are apart by a short distance. It takes a
    /// force of 3 pi gamma R* to pull them apart. It suits large and soft bodies, and needs the law `hertz-mindlin`.
    Jkr,
}

impl fmt::Display for CohesionModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Dmt => "dmt",
            Self::Jkr => "jkr",
        })
    }
}

impl FromStr for CohesionModel {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "dmt" => Ok(Self::Dmt),
            "jkr" => Ok(Self::Jkr),
            _ => Err(Error::Invalid { field: "pair.cohesion", value: quoted(text), expected: "dmt or jkr" }),
        }
    }
}

impl Pair {
    /// Sets the coefficient of restitution.
    pub fn restitution(mut self, restitution: f32) -> Self {
        self.restitution = Some(restitution);
        self
    }

    /// Sets the coefficient of Coulomb friction.
    pub fn friction(mut self, friction: f32) -> Self {
        self.friction = Some(friction);
        self
    }

    /// Sets the normal stiffness of the law `linear`, in mass/s².
    pub fn stiffness(mut self, stiffness: f32) -> Self {
        self.stiffness = Some(stiffness);
        self
    }

    /// Sets the characteristic velocity of the law `linear`, in units/s.
    pub fn characteristic_velocity(mut self, characteristic_velocity: f32) -> Self {
        self.characteristic_velocity = Some(characteristic_velocity);
        self
    }

    /// Sets the coefficient of rolling friction.
    pub fn rolling_friction(mut self, rolling_friction: f32) -> Self {
        self.rolling_friction = Some(rolling_friction);
        self
    }

    /// Sets the model of the rolling resistance.
    pub fn rolling_model(mut self, rolling_model: RollingModel) -> Self {
        self.rolling_model = Some(rolling_model);
        self
    }

    /// Sets the damping ratio of the rolling resistance.
    pub fn rolling_damping(mut self, rolling_damping: f32) -> Self {
        self.rolling_damping = Some(rolling_damping);
        self
    }

    /// Sets the coefficient of twisting friction.
    pub fn twisting_friction(mut self, twisting_friction: f32) -> Self {
        self.twisting_friction = Some(twisting_friction);
        self
    }

    /// Sets the surface energy, in mass/s².
    pub fn surface_energy(mut self, surface_energy: f32) -> Self {
        self.surface_energy = Some(surface_energy);
        self
    }

    /// Sets the model of the attraction.
    pub fn cohesion(mut self, cohesion: CohesionModel) -> Self {
        self.cohesion = Some(cohesion);
        self
    }

    /// Name in scene files of the model of rolling resistance, which is a word.
    pub(crate) const MODEL: &'static str = "rolling_model";
    /// Name in scene files of the model of cohesion, which is a word.
    pub(crate) const COHESION: &'static str = "cohesion";

    /// Names of the properties in scene files: `@pair NAME NAME restitution=e friction=mu ...`.
    pub(crate) const KEYS: [&'static str; 10] = [
        "restitution",
        "friction",
        "stiffness",
        "characteristic_velocity",
        "rolling_friction",
        Self::MODEL,
        "rolling_damping",
        "twisting_friction",
        "surface_energy",
        Self::COHESION,
    ];

    /// The property of a name in [`Pair::KEYS`], if it is a number.
    pub(crate) fn property(&mut self, key: &str) -> Option<&mut Option<f32>> {
        match key {
            "restitution" => Some(&mut self.restitution),
            "friction" => Some(&mut self.friction),
            "stiffness" => Some(&mut self.stiffness),
            "characteristic_velocity" => Some(&mut self.characteristic_velocity),
            "rolling_friction" => Some(&mut self.rolling_friction),
            "rolling_damping" => Some(&mut self.rolling_damping),
            "twisting_friction" => Some(&mut self.twisting_friction),
            "surface_energy" => Some(&mut self.surface_energy),
            _ => None,
        }
    }

    fn validate(&self) -> Result<()> {
        known("pair.restitution", self.restitution, |e| (0.0..=1.0).contains(&e), "a number from 0 to 1")?;
        known("pair.friction", self.friction, |mu| mu >= 0.0, "a finite number, not negative")?;
        known("pair.stiffness", self.stiffness, |stiffness| stiffness > 0.0, "a finite number greater than 0")?;
        let speed = self.characteristic_velocity;
        known("pair.characteristic_velocity", speed, |speed| speed > 0.0, "a finite number greater than 0")?;
        known("pair.rolling_friction", self.rolling_friction, |mu| mu >= 0.0, "a finite number, not negative")?;
        known("pair.rolling_damping", self.rolling_damping, |ratio| ratio >= 0.0, "a finite number, not negative")?;
        known("pair.twisting_friction", self.twisting_friction, |mu| mu >= 0.0, "a finite number, not negative")?;
        known("pair.surface_energy", self.surface_energy, |gamma| gamma >= 0.0, "a finite number, not negative")
    }

    /// Mixes the properties of two materials, each with itself. A property that only one of them has is taken from it.
    fn mixed(one: Self, other: Self) -> Self {
        let mean = |one: Option<f32>, other: Option<f32>, of: fn(f32, f32) -> f32| match (one, other) {
            (Some(one), Some(other)) => Some(of(one, other)),
            (one, other) => one.or(other),
        };
        Self {
            restitution: mean(one.restitution, other.restitution, geometric_mean),
            friction: mean(one.friction, other.friction, geometric_mean),
            stiffness: mean(one.stiffness, other.stiffness, harmonic_mean),
            characteristic_velocity: mean(one.characteristic_velocity, other.characteristic_velocity, geometric_mean),
            rolling_friction: mean(one.rolling_friction, other.rolling_friction, geometric_mean),
            rolling_model: match (one.rolling_model, other.rolling_model) {
                (Some(one), Some(other)) if one != other => Some(RollingModel::SpringDashpot),
                (one, other) => one.or(other),
            },
            rolling_damping: mean(one.rolling_damping, other.rolling_damping, geometric_mean),
            twisting_friction: mean(one.twisting_friction, other.twisting_friction, geometric_mean),
            surface_energy: mean(one.surface_energy, other.surface_energy, geometric_mean),
            cohesion: match (one.cohesion, other.cohesion) {
                (Some(one), Some(other)) if one != other => Some(CohesionModel::Dmt),
                (one, other) => one.or(other),
            },
        }
    }

    /// These properties, with those that are not given taken from another pair.
    fn or(self, other: Self) -> Self {
        Self {
            restitution: self.restitution.or(other.restitution),
            friction: self.friction.or(other.friction),
            stiffness: self.stiffness.or(other.stiffness),
            characteristic_velocity: self.characteristic_velocity.or(other.characteristic_velocity),
            rolling_friction: self.rolling_friction.or(other.rolling_friction),
            rolling_model: self.rolling_model.or(other.rolling_model),
            rolling_damping: self.rolling_damping.or(other.rolling_damping),
            twisting_friction: self.twisting_friction.or(other.twisting_friction),
            surface_energy: self.surface_energy.or(other.surface_energy),
            cohesion: self.cohesion.or(other.cohesion),
        }
    }
}

/// sqrt(a b), computed in f64 so that the mean of equal numbers is that number.
fn geometric_mean(one: f32, other: f32) -> f32 {
    (f64::from(one) * f64::from(other)).sqrt() as f32
}

fn invalid(field: &'static str, value: impl fmt::Debug, expected: &'static str) -> Error {
    Error::Invalid { field, value: format!("{value:?}"), expected }
}

/// 2 / (1 / a + 1 / b): the stiffness of half of one spring behind half of the other.
fn harmonic_mean(one: f32, other: f32) -> f32 {
    let [one, other] = [one, other].map(f64::from);
    (2.0 * one * other / (one + other)) as f32
}

fn known(field: &'static str, value: Option<f32>, is_right: impl Fn(f32) -> bool, expected: &'static str) -> Result<()> {
    match value {
        Some(value) if !(value.is_finite() && is_right(value)) => Err(invalid(field, value, expected)),
        _ => Ok(()),
    }
}

/// The properties that were given for pairs, by the indices of the materials, the lower one first.
pub(crate) type Pairs = BTreeMap<(u16, u16), Pair>;

/// Materials.
impl Scene {
    /// Adds a material.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a constant that is out of range, for a name that is not one word or that another material has,
    /// and for more than [`MAX_MATERIALS`] materials.
    pub fn add_material(&mut self, material: Material) -> Result<MaterialId> {
        material.validate()?;
        if self.find_material(&material.name).is_some() {
            return Err(Error::Invalid {
                field: "material.name",
                value: quoted(&material.name),
                expected: "a name that no other material has",
            });
        }
        if self.materials.len() == MAX_MATERIALS {
            return Err(invalid("materials", self.materials.len() + 1, "at most 255 materials"));
        }
        Ok(self.materials.add(material))
    }

    /// Changes the constants of a material. Its name cannot be changed. Masses that were computed from its density stay.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] when it is not in the scene, [`Error::Invalid`] as for [`Scene::add_material`]. Nothing is changed
    /// then.
    pub fn update_material(&mut self, id: MaterialId, change: impl FnOnce(&mut Material)) -> Result<()> {
        let mut material = self.materials.get(id)?.clone();
        let name = material.name.clone();
        change(&mut material);
        material.name = name;
        material.validate()?;
        *self.materials.get_mut(id)? = material;
        Ok(())
    }

    /// Sets the properties of the contacts between two materials. It replaces all properties given before.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] for a material that is not in the scene, [`Error::Invalid`] for a property that is out of range.
    pub fn set_pair(&mut self, one: MaterialId, other: MaterialId, pair: Pair) -> Result<()> {
        let key = self.pair_key(one, other)?;
        pair.validate()?;
        self.pairs.insert(key, pair);
        Ok(())
    }

    /// The properties that were given for two materials, or `None`.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] for a material that is not in the scene.
    pub fn given_pair(&self, one: MaterialId, other: MaterialId) -> Result<Option<Pair>> {
        Ok(self.pairs.get(&self.pair_key(one, other)?).copied())
    }

    /// The properties of the contacts between two materials. `None` stands for objects without a material.
    ///
    /// A property that is not given for the pair is the mean of the values that are given for each material with itself: the
    /// harmonic mean of stiffnesses, the geometric mean of all others. If only one of them is given, it is that value. If none is given, the property is `None`, and the constants of
    /// the scene hold.
    ///
    /// # Errors
    /// [`Error::StaleHandle`] for a material that is not in the scene.
    pub fn pair(&self, one: Option<MaterialId>, other: Option<MaterialId>) -> Result<Pair> {
        Ok(self.pair_of_numbers(self.material_number(one)?, self.material_number(other)?))
    }

    /// The material with a name.
    pub fn find_material(&self, name: &str) -> Option<MaterialId> {
        let index = self.materials.objects().iter().position(|material| material.name == name)?;
        Some(self.materials.handle_at(index))
    }

    fn pair_key(&self, one: MaterialId, other: MaterialId) -> Result<(u16, u16)> {
        let [one, other] = [self.materials.index(one)? as u16, self.materials.index(other)? as u16];
        Ok((one.min(other), one.max(other)))
    }

    /// Number of a material in tags and tables: its index plus 1, or 0 for none.
    pub(crate) fn material_number(&self, material: Option<MaterialId>) -> Result<u16> {
        material.map_or(Ok(0), |id| Ok(self.materials.index(id)? as u16 + 1))
    }

    /// The material of a number (see [`Scene::material_number`]).
    pub(crate) fn material_of_number(&self, number: u16) -> Option<MaterialId> {
        usize::from(number).checked_sub(1).map(|index| self.materials.handle_at(index))
    }

    /// [`Scene::pair`] for two numbers of materials.
    pub(crate) fn pair_of_numbers(&self, one: u16, other: u16) -> Pair {
        let given = |one: u16, other: u16| {
            let key = (one.min(other).checked_sub(1)?, one.max(other).checked_sub(1)?);
            self.pairs.get(&key).copied()
        };
        let itself = |number: u16| given(number, number).unwrap_or_default();
        given(one, other).unwrap_or_default().or(Pair::mixed(itself(one), itself(other)))
    }
}
