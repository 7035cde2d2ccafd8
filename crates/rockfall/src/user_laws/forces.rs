//! The force laws of a simulation, in the form in which the two backends use them.

use std::sync::Arc;

use crate::error::{Error, Result};
use crate::user_laws::{ForceInput, ForceLaw, ForceLoad};

/// The force laws of a simulation, in the order in which they act.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ForceLaws {
    laws: Arc<[ForceLaw]>,
    /// The values of the parameters of all laws.
    parameters: Arc<[f32]>,
}

/// The function of body forces that has to be replaced in kernels (`physics/forces/user.wgsl`).
#[cfg(feature = "gpu")]
const PLACE: &str = "fn add_user(i: u32, rates: ptr<function, Rates>) {}\n";

impl ForceLaws {
    /// Checks laws and compiles them.
    pub(crate) fn new(laws: &[ForceLaw]) -> Result<Self> {
        for (place, law) in laws.iter().enumerate() {
            law.check()?;
            if laws[..place].iter().any(|other| other.name() == law.name()) {
                return Err(law.error("there is another law of this name"));
            }
        }
        let values = laws.iter().flat_map(|law| law.parameters().iter().map(|(_, value)| *value));
        Ok(Self { laws: laws.into(), parameters: values.collect() })
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.laws.is_empty()
    }

    /// The values of the parameters of all laws.
    pub(crate) fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    /// Sums the loads on a sphere.
    pub(crate) fn load(&self, input: &ForceInput<'_>) -> ForceLoad {
        let mut sum = ForceLoad::default();
        for (law, own) in self.with_parameters() {
            let load = law.load(&ForceInput { parameters: own, ..*input });
            sum.force += load.force;
            sum.torque += load.torque;
        }
        sum
    }

    /// Returns the error of the first law whose result is not finite. `what` names the sphere.
    pub(crate) fn not_finite(&self, input: &ForceInput<'_>, what: &str) -> Option<Error> {
        self.with_parameters().find_map(|(law, own)| law.not_finite(&ForceInput { parameters: own, ..*input }, what))
    }

    /// The laws, each with the values of its own parameters.
    fn with_parameters(&self) -> impl Iterator<Item = (&ForceLaw, &[f32])> {
        let mut rest = &*self.parameters;
        self.laws.iter().map(move |law| {
            let (own, others) = rest.split_at(law.parameters().len());
            rest = others;
            (law, own)
        })
    }

    /// The functions of all laws, and their calls. `parameter` is the text that reads one of all their parameters.
    #[cfg(feature = "gpu")]
    fn functions_and_calls(&self, parameter: impl Fn(usize) -> String) -> Result<(String, String)> {
        use std::fmt::Write;
        let (mut functions, mut calls, mut first) = (String::new(), String::new(), 0);
        for (law, number) in self.laws.iter().zip(0..) {
            // The text has no names of its own that begin with `rockfall_`.
            let text = law.kernel_text()?.replace("rockfall_law", &format!("rockfall_law_{number}"));
            functions += &text.replace("rockfall_result", &format!("rockfall_result_{number}"));
            let count = law.parameters().len();
            let parameters: String = (first..first + count).map(|at| format!(", {}", parameter(at))).collect();
            first += count;
            // Writing to a String cannot fail.
            let _ = write!(
                calls,
                "    let law_{number} = rockfall_law_{number}(position, velocity, spin, mass, radius, time{parameters});\n    \
                 force += law_{number}.force;\n    torque += law_{number}.torque;\n"
            );
        }
        Ok((functions, calls))
    }

    /// The text that replaces [`PLACE_OF_BODIES`] in the kernel of the law `rigid`.
    ///
    /// # Errors
    /// [`Error::Law`] for a law that has no WGSL.
    #[cfg(feature = "gpu")]
    pub(crate) fn text_for_bodies(&self) -> Result<String> {
        let (functions, calls) = self.functions_and_calls(|at| format!("laws[{}u]", HEAD + at))?;
        let signature = PLACE_OF_BODIES.split('{').next().unwrap_or_default();
        Ok(format!(
            "{functions}{signature}{{\n    var force = vec3f(0.0);\n    var torque = vec3f(0.0);\n{calls}    \
             return LawLoad(force, torque);\n}}\n"
        ))
    }

    /// The text that replaces [`PLACE`] in kernels; empty without laws.
    ///
    /// # Errors
    /// [`Error::Law`] for a law that has no WGSL.
    #[cfg(feature = "gpu")]
    pub(crate) fn kernel_text(&self) -> Result<Arc<str>> {
        let (functions, calls) = self.functions_and_calls(|at| format!("float_at(step.laws_at + {at}u)"))?;
        if self.is_empty() {
            return Ok(Arc::default());
        }
        Ok(format!(
            "{functions}fn add_user(i: u32, rates: ptr<function, Rates>) {{\n    let position = state[position_at(i)].xyz;\n    \
             let velocity = state[velocity_at(i)].xyz;\n    \
             let spin = state[momentum_at(i)].xyz * state[momentum_at(i)].w;\n    \
             let mass = 1.0 / state[velocity_at(i)].w;\n    let radius = state[position_at(i)].w;\n    \
             let time = law_time();\n    \
             var force = vec3f(0.0);\n    var torque = vec3f(0.0);\n{calls}    \
             (*rates).acceleration += state[velocity_at(i)].w * force;\n    (*rates).torque += torque;\n}}\n"
        )
        .into())
    }
}

/// The function in `rigid/frame/laws.wgsl` that has to be replaced, and the numbers before the parameters in its array.
#[cfg(feature = "gpu")]
pub(crate) const PLACE_OF_BODIES: &str = "fn load_of_laws(position: vec3f, velocity: vec3f, spin: vec3f, mass: f32, radius: f32, \
    time: f32) -> LawLoad { return LawLoad(vec3f(0.0), vec3f(0.0)); }\n";
#[cfg(feature = "gpu")]
pub(crate) const HEAD: usize = 4;

/// Puts the text of laws into the text of a kernel that evaluates body forces.
#[cfg(feature = "gpu")]
pub(crate) fn with_laws(kernel: &str, laws: &str) -> String {
    if laws.is_empty() { kernel.to_owned() } else { kernel.replace(PLACE, laws) }
}

/// Whether a kernel that contains this file evaluates body forces.
#[cfg(feature = "gpu")]
pub(crate) fn takes_laws(file: &str) -> bool {
    file.contains(PLACE)
}
