//! The table of contact laws, and what the file of a law with history must have (docs/physics section 4.11).
//!
//! A law with history is a line in the table below and a file of the folder `laws`, which implements [`GrainLaw`].
//! docs/extending.md explains how to add one.

use std::fmt;
use std::sync::LazyLock;

use crate::user_laws::{ContactForceLaw, MOST_PARAMETERS};

/// Declares the laws: [`ContactLaw`] and all that finds a law by its number or name.
macro_rules! laws {
    ($($(#[$doc:meta])* $law:ident $name:literal $(in $module:ident)?;)+) => {
        $($(mod $module;)?)+

        /// The law of the forces in contacts (docs/physics sections 4.3 to 4.6 and 4.11).
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum ContactLaw {
            $($(#[$doc])* $law,)+
        }

        impl ContactLaw {
            /// All laws. The place of a law is its number in the kernels.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$law),+];

            /// Name in scene files.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$law => $name,)+
                }
            }

            /// Whether contacts have a tangential spring, which is kept from step to step.
            pub const fn has_history(self) -> bool {
                self.grain().is_some()
            }

            /// The file of a law with history.
            pub(crate) const fn grain(self) -> Option<&'static dyn GrainLaw> {
                match self {
                    $(Self::$law => laws!(@file $law $($module)?),)+
                }
            }
        }

        /// The WGSL files of the laws with history: number, name, file and text.
        pub(crate) const WGSL: &[(u32, &str, &str, &str)] = &[$($((
            ContactLaw::$law.number(),
            stringify!($module),
            concat!("laws/", stringify!($module), ".wgsl"),
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/src/laws/", stringify!($module), ".wgsl")),
        ),)?)+];

        /// What the file of a law with history gives, by the number of the law. `of` is compiled for each law, so that calls in
        /// loops over contacts are direct.
        #[inline]
        pub(crate) fn of_file<T>(number: u32, of: impl FnOnce(&dyn GrainLaw) -> T) -> T {
            match number {
                $($(number if number == ContactLaw::$law.number() => of(&$module::$law),)?)+
                _ => unreachable!("the contacts of this law have no history"),
            }
        }
    };
    (@file $law:ident) => { None };
    (@file $law:ident $module:ident) => { Some(&$module::$law) };
}

laws! {
    /// The law of the thesis: stiffness and damping in proportion to the reduced mass, and friction without history.
    Thesis "thesis";
    /// Springs of constant stiffness, with a tangential spring up to Coulomb's limit (Cundall and Strack 1979).
    Linear "linear" in linear;
    /// Elastic bodies with curved surfaces (Hertz 1882, Mindlin 1949).
    HertzMindlin "hertz-mindlin" in hertz_mindlin;
    /// A law that the program defines ([`ContactForceLaw`](crate::ContactForceLaw)).
    User "user" in user;
    /// Hard contacts: a solver finds the impulses of all contacts of a frame (docs/physics section 11).
    Rigid "rigid";
    /// Chosen by the objects of the scene: see [`Scene::contact_law`](crate::Scene::contact_law). A simulation has the law that
    /// was chosen.
    #[default]
    Auto "auto";
}

impl ContactLaw {
    /// Number of the law in the kernels.
    pub(crate) const fn number(self) -> u32 {
        self as u32
    }

    /// The law of a name in a scene file.
    ///
    /// # Errors
    /// The names that are expected.
    pub(crate) fn from_name(name: &str) -> Result<Self, &'static str> {
        static NAMES: LazyLock<String> = LazyLock::new(|| {
            let (last, rest) = ContactLaw::ALL.split_last().expect("laws");
            listed(&[&[*last], rest].concat(), "or")
        });
        Self::ALL.into_iter().find(|law| law.name() == name).ok_or(NAMES.as_str())
    }
}

impl fmt::Display for ContactLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The names of laws, with a word before the last one.
fn listed(laws: &[ContactLaw], word: &str) -> String {
    let names: Vec<_> = laws.iter().map(|law| law.name()).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} {word} {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// The names of the laws with history of which something is true, with a word before the last one.
pub(crate) fn grain_names(has: impl Fn(&'static dyn GrainLaw) -> bool, word: &str) -> String {
    let laws = ContactLaw::ALL.into_iter().filter(|law| law.grain().is_some_and(&has));
    listed(&laws.collect::<Vec<_>>(), word)
}

/// What a pair of materials gives a law.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Given {
    /// Normal stiffness, in mass/s².
    pub(crate) stiffness: Option<f32>,
    /// In units/s.
    pub(crate) characteristic_velocity: Option<f32>,
    /// E* and G*, in mass/(units s²).
    pub(crate) moduli: Option<[f32; 2]>,
}

impl Given {
    pub(crate) fn young(&self) -> Option<f64> {
        self.moduli.map(|[young, _]| f64::from(young))
    }
}

/// Objects without which a law has no constants, with the message for scenes that lack something.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Needs {
    /// Objects need no material.
    Nothing,
    /// Every material has properties of its own.
    OfMaterials(&'static str),
    /// Every pair of materials that may touch has properties.
    OfPairs(&'static str),
}

/// R* and m* of two bodies, or those of one body on a wall, for estimates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reduced {
    pub(crate) radius: f64,
    pub(crate) mass: f64,
}

/// A sphere that meets equal ones, for estimates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball<'a> {
    pub(crate) radius: f64,
    pub(crate) mass: f64,
    /// Young's modulus and Poisson's ratio of its material.
    pub(crate) elastic: Option<[f64; 2]>,
    /// What its material has with every material of the scene.
    pub(crate) partners: &'a [Given],
}

impl Ball<'_> {
    /// R* and m* of two such spheres.
    pub(crate) fn reduced(&self) -> Reduced {
        Reduced { radius: 0.5 * self.radius, mass: 0.5 * self.mass }
    }
}

/// Constants of a pair of materials for a law with history, from the table of pairs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constants {
    /// The first constant of the law: k_n in mass/s², or E* in mass/(units s²).
    pub(crate) normal: f32,
    /// The second constant of the law: k_t in mass/s², or G* in mass/(units s²).
    pub(crate) tangential: f32,
    /// Damping force per velocity and sqrt(stiffness reduced mass).
    pub(crate) damping: f32,
    /// Coefficient of friction.
    pub(crate) friction: f32,
    /// Coefficient of rolling friction.
    pub(crate) rolling: f32,
    /// Ratio of rolling damping; negative for the model of constant torque.
    pub(crate) rolling_damping: f32,
    /// Coefficient of twisting friction.
    pub(crate) twisting: f32,
    /// DMT: pull-off force per R*, in mass/s². JKR: -(pi gamma / (4 E*))^(1/3), in units^(1/3).
    pub(crate) cohesion: f32,
}

/// Properties of two bodies that a law depends on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bodies {
    /// R*, in units.
    pub(crate) radius: f32,
    /// m*.
    pub(crate) mass: f32,
}

/// A contact, at one force evaluation. With JKR cohesion, the overlap is that of a contact without attraction and with the same
/// contact radius.
#[derive(Clone, Copy)]
pub(crate) struct Contact<'a> {
    pub(crate) constants: &'a Constants,
    pub(crate) bodies: &'a Bodies,
    /// In units.
    pub(crate) overlap: f32,
    /// Speed at which the overlap grows, in units/s.
    pub(crate) approach: f32,
    /// The overlap in the last step, or `None` for a new contact.
    pub(crate) before: Option<f32>,
    /// Whether contacts resist rolling and twisting, which takes the normal stiffness.
    pub(crate) resists: bool,
    /// The law that the program defines, and the values of its parameters for the contact.
    pub(crate) program: Option<(&'a ContactForceLaw, [f32; MOST_PARAMETERS])>,
}

/// Stiffness of a contact at its present overlap.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stiffness {
    /// Derivative of the elastic normal force by the overlap, in mass/s².
    pub(crate) normal: f32,
    /// Tangential force per tangential displacement, in mass/s².
    pub(crate) tangential: f32,
    /// Elastic normal force, as a fraction of `normal` times the overlap.
    pub(crate) share: f32,
    /// Energy of the normal spring, as a fraction of `normal` times the square of the overlap.
    pub(crate) energy_share: f32,
    /// While the contact unloads: the tangential stiffness per that in the last step, with which the tangential displacement
    /// shrinks. Otherwise 1.
    pub(crate) unloading: f32,
}

impl Stiffness {
    /// The answer of a law whose damping follows from the stiffness.
    fn answer(self, contact: &Contact) -> Answer {
        let press =
            (self.share * self.normal * contact.overlap + self.dashpot(self.normal, contact) * contact.approach).max(0.0);
        Answer { press, dashpot: self.dashpot(self.tangential, contact), stiffness: self }
    }

    /// The slopes of such a law.
    fn slopes(self, contact: &Contact) -> [f32; 2] {
        [self.normal, self.dashpot(self.normal, contact)]
    }

    fn dashpot(self, stiffness: f32, contact: &Contact) -> f32 {
        contact.constants.damping * (stiffness * contact.bodies.mass).sqrt()
    }

    /// The energy of the normal spring.
    fn energy(self, contact: &Contact) -> f64 {
        f64::from(self.energy_share) * f64::from(self.normal) * f64::from(contact.overlap).powi(2)
    }
}

/// What a law gives for a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Answer {
    pub(crate) stiffness: Stiffness,
    /// Normal force N without cohesion, at least 0.
    pub(crate) press: f32,
    /// Tangential force per tangential velocity, in mass/s.
    pub(crate) dashpot: f32,
}

/// The functions that the WGSL file of each law with history has: what follows its name, the parameter, its type and that of
/// the result.
const FUNCTIONS: [(&str, &str, &str, &str); 5] = [
    ("answer", "contact", "LawContact", "Answer"),
    ("slopes", "contact", "LawContact", "vec2f"),
    ("relative_force", "overlap", "f32", "f32"),
    ("stiffness_by_force", "ratio", "f32", "f32"),
    ("stiffness_by_overlap", "ratio", "f32", "f32"),
];

/// The text of `laws/chosen.wgsl`: functions that call those of the law of the kernel.
pub(crate) fn chosen() -> String {
    let mut text = String::from("// requires model/step.wgsl physics/laws/stiffness.wgsl");
    WGSL.iter().for_each(|(.., file, _)| text.extend([" ", file]));
    text += "\n\n";
    let constant = |name: &str| format!("LAW_{}", name.to_uppercase());
    for (number, name, ..) in WGSL {
        text += &format!("const {}: u32 = {number}u;\n", constant(name));
    }
    for (function, parameter, kind, result) in FUNCTIONS {
        text += &format!("\nfn law_{function}({parameter}: {kind}) -> {result} {{\n");
        for (_, name, ..) in WGSL {
            let law = constant(name);
            text += &format!("    if LAW == {law} {{\n        return {name}_{function}({parameter});\n    }}\n");
        }
        // Not reached: kernels of other laws do not call these functions.
        text += &format!("    return {result}();\n}}\n");
    }
    text
}

/// A contact law with history. Everything else is common to these laws: the tangential spring, Coulomb's limit, resistance
/// to rolling and twisting, cohesion, and where the history is kept (`physics/laws`).
///
/// No method has a default: a law decides each of them.
pub(crate) trait GrainLaw: Sync {
    /// What a scene must have.
    fn needs(&self) -> Needs;

    /// The two constants of a pair of materials ([`Constants::normal`] and [`Constants::tangential`]).
    fn constants(&self, given: &Given) -> Option<[f32; 2]>;

    /// Elastic force and stiffness at an overlap, in units in which the law has no constants. The damping follows from the
    /// coefficient of restitution by them. `None` for a law with a damping of its own.
    fn unit_impact(&self) -> Option<fn(f64) -> (f64, f64)>;

    /// Whether necks (JKR cohesion) may hold contacts together: the elastic force is that of round elastic bodies, and the
    /// constants are E* and G*.
    fn has_necks(&self) -> bool;

    /// Whether the elastic force has a potential that the program knows, so that energies are complete.
    fn has_potential(&self) -> bool;

    /// Overlap under a force, and the power of the overlap to which the force is proportional.
    fn overlap_under(&self, given: &Given, bodies: Reduced, force: f64) -> Option<(f64, f64)>;

    /// Depth of an elastic impact at a speed, and the power of the depth to which what makes the law stiffer is in inverse
    /// proportion.
    fn depth_at(&self, given: &Given, bodies: Reduced, speed: f64) -> Option<(f64, f64)>;

    /// Shortest time in which a sphere reacts at any speed, in s.
    fn reaction_time(&self, ball: &Ball) -> Option<f64>;

    /// Whether the reaction time is the Rayleigh time. If not, it is that of an impact.
    fn reacts_by_waves(&self) -> bool;

    /// Shortest time of an elastic impact at a speed, in s. `None` for a law with which it does not depend on the speed.
    fn impact_time(&self, ball: &Ball, speed: f64) -> Option<f64>;

    /// Stiffness, normal force and tangential damping of a contact. `NAME_answer` in WGSL.
    fn answer(&self, contact: &Contact) -> Answer;

    /// Derivatives of the normal force by the overlap and by the speed, for time steps of `dt`. `NAME_slopes` in WGSL.
    fn slopes(&self, contact: &Contact, dt: f32) -> [f32; 2];

    /// Energy of the elastic normal force.
    fn energy(&self, contact: &Contact) -> f64;

    /// Elastic force at an overlap up to a constant factor. 0 for a law whose contacts share no springs with neighbours.
    /// `NAME_relative_force` in WGSL.
    fn relative_force(&self, overlap: f32) -> f32;

    /// Ratio of the stiffnesses of two contacts, from that of their elastic forces. `NAME_stiffness_by_force` in WGSL.
    fn stiffness_by_force(&self, ratio: f32) -> f32;

    /// Ratio of the stiffnesses of two contacts, from that of R* times the overlap. `NAME_stiffness_by_overlap` in WGSL.
    fn stiffness_by_overlap(&self, ratio: f32) -> f32;
}

#[cfg(test)]
mod tests;
