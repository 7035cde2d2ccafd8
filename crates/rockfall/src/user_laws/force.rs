//! A force law: what a program gives, and what becomes of it.

use std::fmt;
use std::sync::Arc;

use glam::Vec3;

use crate::error::{Error, Result};
use crate::user_laws::source::Signature;
use crate::user_laws::text::LawText;

/// What the WGSL of a force law may use and must compute.
pub(super) const SIGNATURE: Signature = Signature {
    inputs: &[
        ("position", "vec3f"),
        ("velocity", "vec3f"),
        ("angular_velocity", "vec3f"),
        ("mass", "f32"),
        ("radius", "f32"),
        ("time", "f32"),
    ],
    outputs: &[("force", "vec3f"), ("torque", "vec3f")],
};

/// The sphere that a force law acts on, at one force evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ForceInput<'a> {
    /// Position of the centre, in units.
    pub position: Vec3,
    /// Velocity of the centre, in units/s.
    pub velocity: Vec3,
    /// Angular velocity, in rad/s.
    pub angular_velocity: Vec3,
    /// Mass.
    pub mass: f32,
    /// Radius, in units.
    pub radius: f32,
    /// Time since the start of the simulation, in s.
    pub time: f32,
    /// Values of the parameters of the law, in order of declaration.
    pub parameters: &'a [f32],
}

impl ForceInput<'_> {
    /// The inputs in the order of the signature, then the parameters.
    fn arguments(&self) -> impl Iterator<Item = [f32; 4]> {
        let vectors = [self.position, self.velocity, self.angular_velocity].map(|vector| vector.extend(0.0).to_array());
        let scalar = |number: f32| [number, 0.0, 0.0, 0.0];
        let scalars = [self.mass, self.radius, self.time].map(scalar);
        vectors.into_iter().chain(scalars).chain(self.parameters.iter().copied().map(scalar))
    }
}

/// Force and torque on a sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceLoad {
    /// Force at the centre, in mass units/s².
    pub force: Vec3,
    /// Torque about the centre, in mass units²/s².
    pub torque: Vec3,
}

impl From<Vec3> for ForceLoad {
    fn from(force: Vec3) -> Self {
        Self { force, torque: Vec3::ZERO }
    }
}

type Function = Arc<dyn Fn(&ForceInput<'_>) -> ForceLoad + Send + Sync>;

/// A force on every moving sphere that the program defines: a field, drag, a magnet. It also moves rods and capsules, through the
/// spheres at their ends.
///
/// A law has WGSL text, a function of Rust of the same meaning, or both. The GPU needs the WGSL. The CPU backend calls the function,
/// or evaluates the WGSL if there is no function, which is slower.
///
/// The text is the body of a function. It reads `position`, `velocity`, `angular_velocity` (`vec3f`), `mass`, `radius`, `time`
/// (`f32`) and the parameters (`f32`), with the units of [`ForceInput`], and sets `force` and, if it needs to, `torque` (`vec3f`),
/// which are 0 at the start. It may use scalars and vectors, operators, built-in functions, `if`, and loops of up to 10,000 rounds in
/// all.
///
/// ```
/// use rockfall::{ForceLaw, Options, Scene, Simulation, Sphere};
///
/// # fn main() -> rockfall::Result<()> {
/// let trap = ForceLaw::new("trap")
///     .parameter("k", 4.0)
///     .wgsl("force = -k * position;")
///     .function(|body| -body.parameters[0] * body.position);
/// let mut scene = Scene::new();
/// scene.settings.gravity = 0.0;
/// let ball = scene.add_sphere(Sphere::new([1.0, 0.0, 0.0], 0.1).mass(1.0))?;
/// let mut simulation = Simulation::with_options(scene, Options::new().force_law(trap))?;
/// // A quarter of the period of 2 pi / sqrt(k / m).
/// simulation.run(100, std::f32::consts::PI / 400.0)?;
/// assert!(simulation.sphere(ball)?.position.x.abs() < 1e-3);
/// simulation.set_force_law_parameter("trap", "k", 9.0)?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct ForceLaw {
    text: LawText,
    function: Option<Function>,
}

/// Laws are equal if their names, parameters and texts are equal and they have the same function.
impl PartialEq for ForceLaw {
    fn eq(&self, other: &Self) -> bool {
        let same_function = match (&self.function, &other.function) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        };
        same_function && self.text == other.text
    }
}

impl fmt::Debug for ForceLaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut law = f.debug_struct("ForceLaw");
        law.field("name", &self.text.name).field("parameters", &self.text.parameters).field("wgsl", &self.text.wgsl);
        law.field("has_function", &self.function.is_some()).finish_non_exhaustive()
    }
}

impl ForceLaw {
    /// Creates a law without parameters, text or function. A simulation has at most one law of a name.
    pub fn new(name: impl Into<String>) -> Self {
        Self { text: LawText::new(name.into()), function: None }
    }

    /// Declares a parameter, a number that can be changed while the simulation runs
    /// ([`Simulation::set_force_law_parameter`](crate::Simulation::set_force_law_parameter)). The WGSL reads it by its name.
    pub fn parameter(mut self, name: impl Into<String>, value: f32) -> Self {
        self.text.add_parameter(name.into(), value);
        self
    }

    /// Sets the WGSL text. It is checked when the law is given to a simulation, or by [`ForceLaw::check`].
    pub fn wgsl(mut self, text: impl Into<String>) -> Self {
        self.text.set_wgsl(text.into());
        self
    }

    /// Sets the function of Rust, which returns the force, or force and torque. It must depend on its argument alone: it is called
    /// from several threads in any order.
    pub fn function<L: Into<ForceLoad>>(mut self, function: impl Fn(&ForceInput<'_>) -> L + Send + Sync + 'static) -> Self {
        self.function = Some(Arc::new(move |input| function(input).into()));
        self
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.text.name
    }

    /// Names and values of the parameters, in order of declaration.
    pub fn parameters(&self) -> &[(String, f32)] {
        &self.text.parameters
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
        self.text.check(&SIGNATURE, self.has_function())
    }

    /// Changes the value of a parameter.
    ///
    /// # Errors
    /// [`Error::Law`] for a name that is not declared and for a value that is not finite.
    pub fn set_parameter(&mut self, name: &str, value: f32) -> Result<()> {
        self.text.set_parameter(name, value)
    }

    /// An error about the law as a whole.
    pub(crate) fn error(&self, message: impl Into<String>) -> Error {
        self.text.error(message)
    }

    /// The function of WGSL for kernels.
    #[cfg(feature = "gpu")]
    pub(super) fn kernel_text(&self) -> Result<Arc<str>> {
        self.text.kernel_text(&SIGNATURE, "ForceLaw::wgsl")
    }

    /// Hash of the text; 0 without a text.
    pub(crate) fn text_hash(&self) -> u64 {
        self.text.hash()
    }

    /// Computes force and torque on the CPU. The law must have been checked.
    #[inline]
    pub(super) fn load(&self, input: &ForceInput<'_>) -> ForceLoad {
        if let Some(function) = &self.function {
            return function(input);
        }
        let Some(program) = self.text.program() else { return ForceLoad::default() };
        let [force, torque] = program.run(input.arguments()).map(Vec3::from_array);
        ForceLoad { force, torque }
    }

    /// Returns why the force or torque is not finite, with the line of the text that is the cause; `None` if both are finite.
    pub(super) fn not_finite(&self, input: &ForceInput<'_>, what: &str) -> Option<Error> {
        let ForceLoad { force, torque } = self.load(input);
        if force.is_finite() && torque.is_finite() {
            return None;
        }
        let vector = if force.is_finite() { torque } else { force };
        let name = if force.is_finite() { "torque" } else { "force" };
        let message = format!("the {name} on {what} is {vector}, which is not finite");
        Some(self.text.not_finite(message, what, input.arguments()))
    }
}
