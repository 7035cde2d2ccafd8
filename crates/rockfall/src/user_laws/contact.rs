//! A contact law that a program gives (docs/physics section 4.15).

use std::fmt;
use std::sync::Arc;

use crate::error::{Error, Result};
use crate::user_laws::source::Signature;
use crate::user_laws::text::LawText;

/// What the WGSL of a contact law may use and must compute.
pub(super) const SIGNATURE: Signature = Signature {
    inputs: &[("overlap", "f32"), ("speed", "f32"), ("radius", "f32"), ("mass", "f32"), ("young", "f32"), ("shear", "f32")],
    outputs: &[("normal_force", "f32"), ("tangential_stiffness", "f32"), ("tangential_damping", "f32")],
};

/// Parameters that a contact law may have.
pub(crate) const MOST_PARAMETERS: usize = 8;

/// The contact that a contact law acts in, at one force evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ContactInput<'a> {
    /// Overlap, in units. It is positive.
    pub overlap: f32,
    /// Speed at which the overlap grows, in units/s. It is negative while the bodies separate.
    pub speed: f32,
    /// Reduced radius R*, in units: 1/R* = 1/R1 + 1/R2. Boxes and polygons are flat.
    pub radius: f32,
    /// Reduced mass m*: 1/m* = 1/m1 + 1/m2. What is fixed has an infinite mass.
    pub mass: f32,
    /// E* of the two materials, in mass/(units s²); 0 unless both have `young` and `poisson`.
    pub young: f32,
    /// G* of the two materials, in mass/(units s²); 0 unless both have `young` and `poisson`.
    pub shear: f32,
    /// Values of the parameters of the law for this pair of materials, in order of declaration.
    pub parameters: &'a [f32],
}

impl ContactInput<'_> {
    /// The inputs in the order of the signature, then the parameters.
    fn arguments(&self) -> impl Iterator<Item = [f32; 4]> {
        let Self { overlap, speed, radius, mass, young, shear, parameters } = *self;
        let inputs = [overlap, speed, radius, mass, young, shear];
        inputs.into_iter().chain(parameters.iter().copied()).map(|number| [number, 0.0, 0.0, 0.0])
    }
}

/// What a contact law gives for a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactResponse {
    /// Normal force with its damping, in mass units/s². A positive one pushes the bodies apart. A negative one counts as 0.
    pub normal_force: f32,
    /// Tangential force per tangential displacement, in mass/s². A negative one counts as 0.
    pub tangential_stiffness: f32,
    /// Tangential force per tangential velocity, in mass/s. A negative one counts as 0.
    pub tangential_damping: f32,
}

impl From<f32> for ContactResponse {
    fn from(normal_force: f32) -> Self {
        Self { normal_force, ..Self::default() }
    }
}

/// A central impact of two bodies by a contact law ([`ContactForceLaw::impact`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Impact {
    /// Time from the first touch until the force ends, in s. A 20th of it is a time step that resolves the impact.
    pub seconds: f64,
    /// Largest overlap, in units.
    pub overlap: f64,
    /// Speed of the rebound per speed of the impact.
    pub restitution: f64,
}

/// The value of a parameter for a pair of materials.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PairParameter {
    /// Names of the materials, in alphabetical order.
    pub materials: [String; 2],
    /// Name of the parameter.
    pub parameter: String,
    /// Value of the parameter.
    pub value: f32,
}

type Function = Arc<dyn Fn(&ContactInput<'_>) -> ContactResponse + Send + Sync>;

/// A contact law that the program defines: the normal force, and the stiffness and damping of the tangential spring. The law belongs
/// to the setting `contact_law user`. Friction, the memory of the spring, rolling and twisting resistance and cohesion are those of
/// the other grain laws.
///
/// A law has WGSL text, a function of Rust of the same meaning, or both. The GPU needs the WGSL. The CPU backend calls the function,
/// or evaluates the WGSL if there is no function, which is slower.
///
/// The text is the body of a function. It reads `overlap`, `speed`, `radius`, `mass`, `young`, `shear` and the parameters (all
/// `f32`), with the units of [`ContactInput`], and sets `normal_force` and, for friction, `tangential_stiffness` and
/// `tangential_damping` (`f32`), which are 0 at the start. It may use scalars and vectors, operators, built-in functions, `if`, and
/// loops of up to 10,000 rounds in all.
///
/// The law gives the damping too. The `restitution` of a pair and of the scene has no effect on it.
///
/// ```
/// use rockfall::{ContactForceLaw, Integrator, Options, Scene, Simulation, Sphere};
///
/// # fn main() -> rockfall::Result<()> {
/// // F = k d².
/// let law = ContactForceLaw::new("square")
///     .parameter("k", 1e6)
///     .wgsl("normal_force = k * overlap * overlap;")
///     .function(|contact| contact.parameters[0] * contact.overlap * contact.overlap);
/// let mut scene = Scene::new();
/// scene.settings.gravity = 0.0;
/// let ball = scene.add_sphere(Sphere::new([0.0, 0.0, 0.0], 0.1).mass(2.0).velocity([1.0, 0.0, 0.0]))?;
/// scene.add_sphere(Sphere::new([0.2, 0.0, 0.0], 0.1).mass(2.0))?;
/// let options = Options::new().integrator(Integrator::VelocityVerlet).contact_force_law(law);
/// let mut simulation = Simulation::with_options(scene, options)?;
/// simulation.run(200, 2e-4)?;
/// // The balls have exchanged their velocities.
/// assert!(simulation.sphere(ball)?.velocity.length() < 1e-3);
/// simulation.set_contact_law_parameter("k", 2e6)?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct ContactForceLaw {
    text: LawText,
    pairs: Vec<PairParameter>,
    function: Option<Function>,
}

/// Laws are equal if their names, parameters and texts are equal and they have the same function.
impl PartialEq for ContactForceLaw {
    fn eq(&self, other: &Self) -> bool {
        let same_function = match (&self.function, &other.function) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        };
        same_function && self.text == other.text && self.pairs == other.pairs
    }
}

impl fmt::Debug for ContactForceLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut law = f.debug_struct("ContactForceLaw");
        law.field("name", &self.text.name).field("parameters", &self.text.parameters).field("pairs", &self.pairs);
        law.field("wgsl", &self.text.wgsl).field("has_function", &self.function.is_some()).finish_non_exhaustive()
    }
}

impl ContactForceLaw {
    /// Creates a law without parameters, text or function.
    pub fn new(name: impl Into<String>) -> Self {
        Self { text: LawText::new(name.into()), pairs: Vec::new(), function: None }
    }

    /// Declares a parameter and its value for all pairs of materials. The WGSL reads it by its name. A law has up to 8 parameters.
    /// Their values can be changed while the simulation runs
    /// ([`Simulation::set_contact_law_parameter`](crate::Simulation::set_contact_law_parameter)).
    pub fn parameter(mut self, name: impl Into<String>, value: f32) -> Self {
        self.text.add_parameter(name.into(), value);
        self
    }

    /// Sets the value of a parameter for the contacts of two materials, which are given by their names.
    pub fn pair_parameter(mut self, materials: [&str; 2], parameter: impl Into<String>, value: f32) -> Self {
        self.put_pair(materials, parameter.into(), value);
        self
    }

    /// Sets the WGSL text. It is checked when the law is given to a simulation, or by [`ContactForceLaw::check`].
    pub fn wgsl(mut self, text: impl Into<String>) -> Self {
        self.text.set_wgsl(text.into());
        self
    }

    /// Sets the function of Rust, which returns the normal force, or a [`ContactResponse`]. It must depend on its argument alone: it
    /// is called from several threads in any order, and several times for a contact, also with other overlaps and speeds.
    pub fn function<R: Into<ContactResponse>>(
        mut self,
        function: impl Fn(&ContactInput<'_>) -> R + Send + Sync + 'static,
    ) -> Self {
        self.function = Some(Arc::new(move |input| function(input).into()));
        self
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.text.name
    }

    /// Names and values of the parameters for all pairs of materials, in order of declaration.
    pub fn parameters(&self) -> &[(String, f32)] {
        &self.text.parameters
    }

    /// The parameters of pairs of materials.
    pub fn pair_parameters(&self) -> &[PairParameter] {
        &self.pairs
    }

    /// The WGSL text, if the law has one.
    pub fn wgsl_text(&self) -> Option<&str> {
        self.text.wgsl.as_deref()
    }

    /// Whether the law has a function of Rust.
    pub fn has_function(&self) -> bool {
        self.function.is_some()
    }

    /// Checks names, values and the WGSL text.
    ///
    /// # Errors
    /// [`Error::Law`] with the line and column of the text if something is wrong with it.
    pub fn check(&self) -> Result<()> {
        self.text.check(&SIGNATURE, self.has_function())?;
        let count = self.text.parameters.len();
        if count > MOST_PARAMETERS {
            return Err(self.error(format!("it has {count} parameters, expected at most {MOST_PARAMETERS}")));
        }
        self.pairs.iter().try_for_each(|pair| {
            self.text.place_of(&pair.parameter)?;
            self.text.check_value(&pair.parameter, pair.value)
        })
    }

    /// Changes the value of a parameter for all pairs of materials that have no value of their own.
    ///
    /// # Errors
    /// [`Error::Law`] for a name that is not declared and for a value that is not finite.
    pub fn set_parameter(&mut self, name: &str, value: f32) -> Result<()> {
        self.text.set_parameter(name, value)
    }

    /// Changes the value of a parameter for the contacts of two materials, which are given by their names.
    ///
    /// # Errors
    /// [`Error::Law`] for a name that is not declared and for a value that is not finite.
    pub fn set_pair_parameter(&mut self, materials: [&str; 2], name: &str, value: f32) -> Result<()> {
        self.text.check_value(name, value)?;
        self.text.place_of(name)?;
        self.put_pair(materials, name.to_owned(), value);
        Ok(())
    }

    /// Replaces all parameters of pairs.
    ///
    /// # Errors
    /// [`Error::Law`] for a name that is not declared.
    pub(crate) fn replace_pairs(&mut self, pairs: Vec<PairParameter>) -> Result<()> {
        self.pairs = pairs;
        self.pairs.iter().try_for_each(|pair| self.text.place_of(&pair.parameter).map(drop))
    }

    fn put_pair(&mut self, materials: [&str; 2], parameter: String, value: f32) {
        let mut materials = materials.map(str::to_owned);
        materials.sort();
        match self.pairs.iter_mut().find(|pair| pair.materials == materials && pair.parameter == parameter) {
            Some(known) => known.value = value,
            None => self.pairs.push(PairParameter { materials, parameter, value }),
        }
    }

    /// An error about the law as a whole.
    pub(crate) fn error(&self, message: impl Into<String>) -> Error {
        self.text.error(message)
    }

    /// The function of WGSL for kernels.
    #[cfg(feature = "gpu")]
    pub(super) fn kernel_text(&self) -> Result<Arc<str>> {
        self.text.kernel_text(&SIGNATURE, "ContactForceLaw::wgsl")
    }

    /// Hash of the text; 0 without a text.
    pub(crate) fn text_hash(&self) -> u64 {
        self.text.hash()
    }

    /// Evaluates the law as the CPU backend does: by its function or, if it has none, by its WGSL. If `contact` has no parameters,
    /// those for all pairs of materials are used.
    ///
    /// # Errors
    /// As for [`ContactForceLaw::check`].
    pub fn response(&self, contact: &ContactInput<'_>) -> Result<ContactResponse> {
        self.with_parameters(contact, |contact| self.evaluate(contact))
    }

    /// Checks the law, and applies a function to `contact`. If it has no parameters, it gets those for all pairs of materials.
    fn with_parameters<T>(&self, contact: &ContactInput<'_>, apply: impl FnOnce(&ContactInput<'_>) -> T) -> Result<T> {
        self.check()?;
        let values: Vec<f32> = self.text.parameters.iter().map(|(_, value)| *value).collect();
        let parameters = if contact.parameters.is_empty() { &values } else { contact.parameters };
        if parameters.len() != values.len() {
            return Err(self.error(format!("expected {} parameters, got {}", values.len(), parameters.len())));
        }
        Ok(apply(&ContactInput { parameters, ..*contact }))
    }

    /// Evaluates the law on the CPU. The law must have been checked.
    #[inline]
    pub(crate) fn evaluate(&self, contact: &ContactInput<'_>) -> ContactResponse {
        if let Some(function) = &self.function {
            return function(contact);
        }
        let Some(program) = self.text.program() else { return ContactResponse::default() };
        let [[normal_force, ..], [tangential_stiffness, ..], [tangential_damping, ..]] = program.run(contact.arguments());
        ContactResponse { normal_force, tangential_stiffness, tangential_damping }
    }

    /// Returns why the response is not finite, with the line of the text that is the cause; `None` if it is finite.
    pub(crate) fn not_finite(&self, contact: &ContactInput<'_>, what: &str) -> Option<Error> {
        let ContactResponse { normal_force, tangential_stiffness, tangential_damping } = self.evaluate(contact);
        let values = [normal_force, tangential_stiffness, tangential_damping];
        let ((name, _), value) = SIGNATURE.outputs.iter().zip(values).find(|(_, value)| !value.is_finite())?;
        let message = format!("the {name} of {what} is {value}, which is not finite");
        Some(self.text.not_finite(message, what, contact.arguments()))
    }

    /// Energy of the elastic normal force at the overlap of a contact: the integral of the force over the overlap, at speed 0.
    pub(crate) fn energy(&self, contact: &ContactInput<'_>) -> f64 {
        /// Intervals of Simpson's rule. The overlap is d s², so that powers of d that are half integers are smooth in s.
        const PARTS: u32 = 16;
        let at = |place: u32| {
            let s = f64::from(place) / f64::from(PARTS);
            let overlap = (f64::from(contact.overlap) * s * s) as f32;
            if place == 0 { 0.0 } else { self.push(&ContactInput { overlap, speed: 0.0, ..*contact }) * s }
        };
        let weight = |place: u32| if place == PARTS { 1.0 } else { f64::from(2 + 2 * (place % 2)) };
        let sum: f64 = (1..=PARTS).map(|place| weight(place) * at(place)).sum();
        2.0 * f64::from(contact.overlap) * sum / (3.0 * f64::from(PARTS))
    }

    fn push(&self, contact: &ContactInput<'_>) -> f64 {
        if contact.overlap > 0.0 { f64::from(self.evaluate(contact).normal_force).max(0.0) } else { 0.0 }
    }

    /// Computes a central impact, in which `contact.speed` is the speed of approach and `contact.overlap` is ignored. It shows the
    /// time step and the restitution of a law. `None` if the law does not make the bodies rebound.
    ///
    /// # Errors
    /// As for [`ContactForceLaw::response`].
    pub fn impact(&self, contact: &ContactInput<'_>) -> Result<Option<Impact>> {
        self.with_parameters(contact, |contact| self.rebound(contact))
    }

    fn rebound(&self, contact: &ContactInput<'_>) -> Option<Impact> {
        /// Time steps per time in which the impact would reach its depth at constant speed.
        const STEPS: f64 = 1000.0;
        let (mass, start) = (f64::from(contact.mass), f64::from(contact.speed));
        let depth = self.depth(contact)?;
        let step = depth / start / STEPS;
        let push = |overlap: f64, speed: f64| {
            self.push(&ContactInput { overlap: overlap as f32, speed: speed as f32, ..*contact }) / mass
        };
        let (mut overlap, mut speed, mut most, mut time) = (0.0, start, 0.0_f64, 0.0);
        // A law without an end of the impact, for example one that damps without a limit.
        for _ in 0..(200.0 * STEPS) as u32 {
            let rate = |x: f64, v: f64| (v, -push(x, v));
            let (x1, v1) = rate(overlap, speed);
            let (x2, v2) = rate(overlap + 0.5 * step * x1, speed + 0.5 * step * v1);
            let (x3, v3) = rate(overlap + 0.5 * step * x2, speed + 0.5 * step * v2);
            let (x4, v4) = rate(overlap + step * x3, speed + step * v3);
            overlap += step / 6.0 * (x1 + 2.0 * (x2 + x3) + x4);
            speed += step / 6.0 * (v1 + 2.0 * (v2 + v3) + v4);
            time += step;
            most = most.max(overlap);
            if speed < 0.0 && push(overlap, speed) <= 0.0 {
                return Some(Impact { seconds: time, overlap: most, restitution: -speed / start });
            }
        }
        None
    }

    /// The overlap at which the elastic energy is that of the impact, within a factor of 2.
    fn depth(&self, contact: &ContactInput<'_>) -> Option<f64> {
        let wanted = 0.5 * f64::from(contact.mass) * f64::from(contact.speed).powi(2);
        if !(wanted.is_finite() && wanted > 0.0 && contact.speed > 0.0 && contact.radius > 0.0) {
            return None;
        }
        let energy = |overlap: f32| self.energy(&ContactInput { overlap, ..*contact });
        let mut depth = contact.radius;
        while energy(depth) > wanted {
            depth *= 0.5;
        }
        while depth > 0.0 && energy(depth) < wanted && depth < 1e3 * contact.radius {
            depth *= 2.0;
        }
        (energy(depth) >= wanted && depth > 0.0).then_some(depth.into())
    }
}
