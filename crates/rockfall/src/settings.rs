//! The constants that can be changed while a simulation runs (docs/physics section 6, thesis section 2.8), the integrators
//! and the broad phases.

use std::fmt;
use std::str::FromStr;

use glam::Vec3;

use crate::error::{Error, Result, quoted};

mod integrator;

pub use crate::laws::ContactLaw;
pub use integrator::{Integrator, IntegratorChoice};

/// The fixed time step of the thesis, in s.
pub const DEFAULT_TIME_STEP: f32 = 0.02;
/// The frame of the contact law `rigid` where a scene has no time step, in s.
pub const DEFAULT_FRAME: f32 = 1.0 / 60.0;

/// The type of a constant, chosen by the name of the function that reads it.
macro_rules! value_type {
    (switch) => {
        bool
    };
    (direction) => {
        Vec3
    };
    (law) => {
        ContactLaw
    };
    (precision) => {
        Precision
    };
    ($number:ident) => {
        f32
    };
}

/// Declares [`Settings`] and its table from the table of constants.
macro_rules! settings {
    (kernel { $($kernel:tt)+ } host { $($host:tt)+ }) => {
        settings!($($kernel)+ $($host)+);
    };
    ($($(#[doc = $doc:literal])+ $name:ident: $read:ident = $default:expr, $unit:literal, $slider:expr;)+) => {
        /// The physical constants of a simulation.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub struct Settings {
            $($(#[doc = $doc])+ pub $name: value_type!($read),)+
        }

        impl Default for Settings {
            fn default() -> Self {
                Self { $($name: $default),+ }
            }
        }

        impl Settings {
            /// All constants, in the order of the fields.
            pub const TABLE: &[Constant] = &[$(Constant {
                name: stringify!($name),
                unit: $unit,
                doc: concat!($($doc),+),
                slider: $slider,
            }),+];

            /// Names that [`Settings::set`] takes.
            pub const NAMES: &[&str] = &[$(stringify!($name)),+];

            /// Sets a constant by its name, from text: a number, `on` or `off`, `x,y,z` for the direction, or the name of a
            /// contact law. Setting a contact law with history switches `collisions` off. Setting the law `rigid` sets
            /// `restitution` to 0 and `coulomb_friction` to 0.5.
            ///
            /// # Errors
            /// - [`Error::UnknownSetting`] for a name that is not in [`Settings::NAMES`].
            /// - [`Error::Invalid`] for a value that is not finite, not of the right kind, or out of range.
            pub fn set(&mut self, name: &str, value: &str) -> Result<()> {
                match name {
                    $(stringify!($name) => self.$name = $read(stringify!($name), value)?,)+
                    _ => return Err(Error::UnknownSetting { name: name.to_owned(), expected: Self::NAMES.join(", ") }),
                }
                if name == "contact_law" {
                    self.follow_law();
                }
                Ok(())
            }

            /// Returns the value of a constant as text, or `None` for an unknown name. [`Settings::set`] reads the text back to
            /// the same bits.
            pub fn get(&self, name: &str) -> Option<String> {
                match name {
                    $(stringify!($name) => Some(self.$name.to_text()),)+
                    _ => None,
                }
            }
        }
    };
}

/// An entry of [`Settings::TABLE`].
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Constant {
    /// Name for [`Settings::set`] and [`Settings::get`].
    pub name: &'static str,
    /// Unit; empty for a number without one.
    pub unit: &'static str,
    /// Meaning, in Markdown.
    pub doc: &'static str,
    /// Least and greatest value of a slider, for constants that have one.
    pub slider: Option<(f32, f32)>,
}

/// The table of all constants. Each entry has the doc, the name, the function that reads and checks a value, the default, the
/// unit, and the range of the slider in the window, if it has one. Entries of `kernel` are also fields of
/// [`Step`](crate::model::step::Step), which kernels read. [`World::set_settings`](crate::model::world::World::set_settings)
/// converts the entries of `host` to other fields.
macro_rules! constant_table {
    ($declare:ident) => {
        $declare! {
            kernel {
                /// A contact is handled as a collision when its approach velocity exceeds this times the smaller radius, in
                /// 1/s.
                activation_threshold: not_negative = 1.0, "1/s", Some((0.0, 10.0));
                /// Coefficient of restitution e: 0 fully inelastic, 1 elastic.
                restitution: from_0_to_1 = 0.75, "", Some((0.0, 1.0));
                /// Contact damping Cd in 1/s: force per approach velocity and reduced mass.
                contact_damping: not_negative = 12.5, "1/s", Some((0.0, 50.0));
                /// Contact force Cc in 1/s²: force per overlap and reduced mass.
                contact_force: not_negative = 1000.0, "1/s²", Some((0.0, 5000.0));
                /// Friction mu in 1/(s² sqrt(units/s)): force per overlap, reduced mass and square root of the sliding
                /// velocity. It falls off near rest, so bodies creep on slopes.
                friction: not_negative = 50.0, "1/(s² √(units/s))", Some((0.0, 500.0));
                /// Coefficient mu_c of Coulomb friction in contacts; 0: the thesis's friction force, which `friction` scales.
                /// Where it is positive, every contact gets a friction impulse of at most mu_c times its normal force times the
                /// time step, once per step, in place of that force.
                coulomb_friction: not_negative = 0.0, "", Some((0.0, 2.0));
                /// Coefficient of Coulomb friction in collisions: limits the tangential impulse of a collision to this times
                /// its normal impulse; 0: collisions are frictionless.
                collision_friction: not_negative = 0.0, "", Some((0.0, 2.0));
                /// Linear damping C in 1/s: every moving body loses velocity at the rate v' = -C v.
                linear_damping: not_negative = 0.0, "1/s", Some((0.0, 10.0));
                /// Angular damping C in 1/s: every moving body loses angular momentum at the rate L' = -C L.
                angular_damping: not_negative = 0.0, "1/s", Some((0.0, 10.0));
            }
            host {
                /// Contact law: `auto`, `thesis`, `rigid` or a grain law (`linear`, `hertz-mindlin`, `user`). `auto` is `rigid`
                /// in scenes with a placed body, an inlet with a shape, or a joint, and otherwise `thesis`. Grain laws keep a
                /// tangential spring for every contact, and all but `user` need materials. They do not use `contact_force`,
                /// `contact_damping`, `friction` and `resting_overlap`. Setting them by name (also in a scene text and in
                /// Python) switches `collisions` off. With `rigid`, contacts are hard: a solver takes frames of 1/60 s in
                /// substeps, and of the settings of contacts it uses `restitution` and `coulomb_friction` alone. Setting it by
                /// name sets them to 0 and 0.5. Where `auto` means `rigid`, 0.75 and 0, the defaults, count as not given, and
                /// become 0 and 0.5; a line of a scene text counts.
                contact_law: law = ContactLaw::Auto, "", None;
                /// Gravity G in units/s².
                gravity: finite = 1.0, "units/s²", Some((-10.0, 20.0));
                /// Whether collisions are handled as impulses. If not, contact forces act in collisions too.
                collisions: switch = true, "", None;
                /// Whether contacts that begin and end within one step are collisions too, between spheres without rods, and of
                /// these with boxes and polygons. So a fast sphere does not pass through a thin wall. Without `collisions` this
                /// has no effect.
                continuous_collisions: switch = false, "", None;
                /// Direction of gravity g, a unit vector. A vector of another length is normalized, except in a struct that is
                /// filled in by hand.
                gravity_direction: direction = Vec3::NEG_Y, "", None;
                /// Whether contact damping may pull bodies together (the thesis's form).
                contact_pull: switch = false, "", None;
                /// Overlap at rest in radii, F: where it is positive, `contact_force` and `contact_damping` are chosen from
                /// gravity, sizes and depth of the scene, so that bodies at rest overlap by less than F of the smaller radius.
                /// 0: they stay as they are.
                resting_overlap: fraction = 0.0, "", None;
                /// Greatest angle, in degrees, between the normals of two triangles that a sphere touches as one: facets of a mesh that
                /// meet at a smaller angle stand for a smooth wall. From 0.6 to 15.
                mesh_angle: facet_angle = 10.0, "degrees", None;
                /// Precision of the geometry of contacts: `single`, `double`, or `auto`, which chooses what the scene needs. Small or
                /// stiff bodies far from the origin need `double`.
                precision: precision = Precision::Auto, "", None;
            }
        }
    };
}
pub(crate) use constant_table;

constant_table!(settings);

impl Settings {
    /// Returns these settings with a change, for example `Settings::default().with(|settings| settings.gravity = 9.81)`.
    #[must_use]
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    /// Sets constants by their names, as [`Settings::set`] does, the contact law before all others: what follows from the law then
    /// does not replace what is given, whatever the order.
    ///
    /// # Errors
    /// As for [`Settings::set`]. Some constants are set then.
    pub fn set_all<'a>(&mut self, constants: impl Iterator<Item = (&'a str, &'a str)> + Clone) -> Result<()> {
        let (laws, others) = (constants.clone(), constants);
        let is_law = |name: &str| name == "contact_law";
        laws.filter(|(name, _)| is_law(name)).try_for_each(|(name, value)| self.set(name, value))?;
        others.filter(|(name, _)| !is_law(name)).try_for_each(|(name, value)| self.set(name, value))
    }

    /// The restitution and the coefficient of friction of the law `rigid` where nothing else is given.
    pub(crate) const RIGID: [f32; 2] = [0.0, 0.5];

    /// The settings that a contact law sets when it is set by name.
    pub(crate) const FOLLOW_LAW: [&str; 3] = ["collisions", "restitution", "coulomb_friction"];

    /// Sets what follows from the contact law.
    fn follow_law(&mut self) {
        if self.contact_law.has_history() {
            self.collisions = false;
        }
        if self.contact_law == ContactLaw::Rigid {
            [self.restitution, self.coulomb_friction] = Self::RIGID;
        }
    }

    /// Whether setting the contact law of these settings by name sets this one.
    pub(crate) fn follows_law(&self, name: &str) -> bool {
        match name {
            "collisions" => self.contact_law.has_history(),
            "restitution" | "coulomb_friction" => self.contact_law == ContactLaw::Rigid,
            _ => false,
        }
    }

    /// Checks the values of a struct that was filled in by hand.
    ///
    /// # Errors
    /// [`Error::Invalid`] as for [`Settings::set`].
    pub fn validate(&self) -> Result<()> {
        let mut copy = *self;
        for name in Self::NAMES {
            copy.set(name, &self.get(name).unwrap_or_default())?;
        }
        Ok(())
    }
}

/// Converts a value to text that is read back to the same bits.
trait ToText {
    fn to_text(&self) -> String;
}

impl ToText for f32 {
    fn to_text(&self) -> String {
        self.to_string()
    }
}

impl ToText for bool {
    fn to_text(&self) -> String {
        if *self { "on" } else { "off" }.to_owned()
    }
}

impl ToText for ContactLaw {
    fn to_text(&self) -> String {
        self.to_string()
    }
}

impl ToText for Precision {
    fn to_text(&self) -> String {
        self.to_string()
    }
}

impl ToText for Vec3 {
    fn to_text(&self) -> String {
        format!("{},{},{}", self.x, self.y, self.z)
    }
}

fn invalid(field: &'static str, value: &str, expected: &'static str) -> Error {
    Error::Invalid { field, value: quoted(value), expected }
}

fn number(field: &'static str, value: &str, expected: &'static str) -> Result<f32> {
    match value.trim().parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(invalid(field, value, expected)),
    }
}

fn finite(field: &'static str, value: &str) -> Result<f32> {
    number(field, value, "a finite number")
}

fn not_negative(field: &'static str, value: &str) -> Result<f32> {
    const EXPECTED: &str = "a finite number, not negative";
    match number(field, value, EXPECTED)? {
        number if number >= 0.0 => Ok(number),
        _ => Err(invalid(field, value, EXPECTED)),
    }
}

fn from_0_to_1(field: &'static str, value: &str) -> Result<f32> {
    const EXPECTED: &str = "a number from 0 to 1";
    match number(field, value, EXPECTED)? {
        number if (0.0..=1.0).contains(&number) => Ok(number),
        _ => Err(invalid(field, value, EXPECTED)),
    }
}

/// Reads the angle of facets.
fn facet_angle(field: &'static str, value: &str) -> Result<f32> {
    const EXPECTED: &str = "a number of degrees from 0.6 to 15";
    match number(field, value, EXPECTED)? {
        number if (0.6..=15.0).contains(&number) => Ok(number),
        _ => Err(invalid(field, value, EXPECTED)),
    }
}

/// Reads a fraction of a radius. Overlaps below a millionth of a radius are lost in the rounding of coordinates. Bodies that
/// overlap by half their radius pass through each other.
fn fraction(field: &'static str, value: &str) -> Result<f32> {
    const EXPECTED: &str = "0, or a number from 0.000001 to 0.5";
    match number(field, value, EXPECTED)? {
        number if number == 0.0 || (1e-6..=0.5).contains(&number) => Ok(number),
        _ => Err(invalid(field, value, EXPECTED)),
    }
}

fn switch(field: &'static str, value: &str) -> Result<bool> {
    match value.trim() {
        "on" | "true" | "1" => Ok(true),
        "off" | "false" | "0" => Ok(false),
        _ => Err(invalid(field, value, "on or off")),
    }
}

fn direction(field: &'static str, value: &str) -> Result<Vec3> {
    const EXPECTED: &str = "three numbers, as in 0,-1,0 or 0 -1 0, not all zero";
    // Separated by commas, or by spaces as in scene files.
    let parts: Vec<&str> = if value.contains(',') { value.split(',').collect() } else { value.split_whitespace().collect() };
    let numbers: Vec<f32> = parts
        .into_iter()
        .map(|part| number(field, part, EXPECTED))
        .collect::<Result<_>>()
        .map_err(|_| invalid(field, value, EXPECTED))?;
    let [x, y, z] = numbers[..] else {
        return Err(invalid(field, value, EXPECTED));
    };
    // Computed in f64, so that squares of huge components do not overflow and those of tiny ones do not underflow. A unit
    // vector keeps its bits.
    let wide = glam::DVec3::new(x.into(), y.into(), z.into());
    if (wide.length() - 1.0).abs() < 1e-6 {
        return Ok(Vec3::new(x, y, z));
    }
    wide.try_normalize().map(|unit| unit.as_vec3()).ok_or_else(|| invalid(field, value, EXPECTED))
}

fn law(field: &'static str, value: &str) -> Result<ContactLaw> {
    ContactLaw::from_name(value.trim()).map_err(|names| invalid(field, value, names))
}

fn precision(field: &'static str, value: &str) -> Result<Precision> {
    let precision = Precision::ALL.into_iter().find(|precision| precision.name() == value.trim());
    precision.ok_or_else(|| invalid(field, value, "auto, single or double"))
}

/// How precise the geometry of contacts is (docs/physics section 5.8).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Precision {
    /// What the scene needs: [`Scene::chosen_precision`](crate::Scene::chosen_precision).
    #[default]
    Auto,
    /// Contacts see coordinates as `f32`.
    Single,
    /// Contacts see coordinates as sums of two `f32`, with 48 bits.
    Double,
}

impl Precision {
    /// All precisions.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Single, Self::Double];

    /// Name in scene files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Single => "single",
            Self::Double => "double",
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// How pairs that may touch are found. All methods give the same results; their lists may differ in pairs that do not touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BroadPhase {
    /// Brute force or the grid, whichever is faster for the number of objects and the backend.
    #[default]
    Auto,
    /// Tests every mover against every object, tile by tile (thesis section 2.5.1).
    BruteForce,
    /// Like brute force, but with objects kept roughly sorted along x, in blocks. Pairs of blocks whose intervals along x do
    /// not meet are skipped, as the thesis proposes in section 2.5.1.
    SortAndSkip,
    /// Uses a hashed grid of several levels, for any number, sizes and distribution of objects.
    Grid,
}

/// From this number of objects on, the grid is faster than brute force on a GPU: measured at 1,024 spheres on an NVIDIA H200.
const GRID_FROM: usize = 1_000;
/// The same on the CPU. Measured on two cores, where they are equally fast between 32 and 64 bodies, and the grid two to four
/// times as fast from 500 on (docs/performance.md).
const GRID_FROM_ON_CPU: usize = 50;

impl BroadPhase {
    /// Returns this broad phase, or the one that `Auto` chooses for this number of objects, on the CPU or on a GPU.
    pub fn resolve(self, objects: usize, on_cpu: bool) -> Self {
        let least = if on_cpu { GRID_FROM_ON_CPU } else { GRID_FROM };
        match self {
            Self::Auto if objects < least => Self::BruteForce,
            Self::Auto => Self::Grid,
            chosen => chosen,
        }
    }
}

impl fmt::Display for BroadPhase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Auto => "auto",
            Self::BruteForce => "brute-force",
            Self::SortAndSkip => "sort-and-skip",
            Self::Grid => "grid",
        })
    }
}

impl FromStr for BroadPhase {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "auto" => Ok(Self::Auto),
            "brute-force" => Ok(Self::BruteForce),
            "sort-and-skip" => Ok(Self::SortAndSkip),
            "grid" => Ok(Self::Grid),
            _ => Err(invalid("broad-phase", text, "auto, brute-force, sort-and-skip or grid")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_takes_brute_force_for_few_objects_and_the_grid_for_more() {
        for (on_cpu, least) in [(true, GRID_FROM_ON_CPU), (false, GRID_FROM)] {
            assert_eq!(BroadPhase::Auto.resolve(least - 1, on_cpu), BroadPhase::BruteForce);
            assert_eq!(BroadPhase::Auto.resolve(least, on_cpu), BroadPhase::Grid);
            assert_eq!(BroadPhase::BruteForce.resolve(9 * least, on_cpu), BroadPhase::BruteForce);
            assert_eq!(BroadPhase::Grid.resolve(1, on_cpu), BroadPhase::Grid);
        }
    }
}
