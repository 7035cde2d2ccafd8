//! Options of a simulation: backend and methods.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result, quoted};
use crate::settings::{BroadPhase, IntegratorChoice};
use crate::user_laws::{ContactForceLaw, ForceLaw};

/// The backend that runs a simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Backend {
    /// The CPU for a scene of up to 64 spheres and rods (128 in a browser), which it computes faster than a GPU. Otherwise a hardware
    /// GPU if there is one, and the CPU if there is none.
    #[default]
    Auto,
    /// A GPU, or software Vulkan if there is no hardware.
    Gpu,
    /// The CPU, on all threads.
    Cpu,
}

macro_rules! names {
    ($type:ident, $field:literal, $($variant:ident = $name:literal),*) => {
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self {
                    $(Self::$variant => $name,)*
                })
            }
        }

        impl FromStr for $type {
            type Err = Error;

            fn from_str(text: &str) -> Result<Self> {
                match text {
                    $($name => Ok(Self::$variant),)*
                    _ => Err(Error::Invalid {
                        field: $field,
                        value: quoted(text),
                        expected: concat!("one of:", $(" ", $name),*),
                    }),
                }
            }
        }
    };
}

names!(Backend, "backend", Auto = "auto", Gpu = "gpu", Cpu = "cpu");

/// An optimization that can be left out, to measure what it is worth or to look for a fault in it. Results do not depend on any of
/// them. `docs/performance.md` in the repository describes them and gives what each is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Optimization {
    /// The phase of positions of small scenes in one function on the CPU.
    JoinedSteps,
    /// Pair lists that are rebuilt in only every 2nd, 4th or 8th step on a GPU.
    ListInterval,
    /// AABBs that are placed half a step ahead of their bodies.
    Lead,
    /// Two portions of steps under way on a GPU at the same time.
    Portions,
    /// Memory in spatial order.
    SpatialOrder,
    /// A workgroup for each large sphere.
    LargeSpheres,
    /// A workgroup for each pair list of a large sphere or long rod.
    LongMovers,
    /// All sweeps over few collisions in one dispatch.
    SweepsAtOnce,
}

names!(
    Optimization,
    "optimization",
    JoinedSteps = "joined-steps",
    ListInterval = "list-interval",
    Lead = "lead",
    Portions = "portions",
    SpatialOrder = "spatial-order",
    LargeSpheres = "large-spheres",
    LongMovers = "long-movers",
    SweepsAtOnce = "sweeps-at-once"
);

impl Optimization {
    /// All optimizations that can be left out.
    pub const ALL: [Self; 8] = [
        Self::JoinedSteps,
        Self::ListInterval,
        Self::Lead,
        Self::Portions,
        Self::SpatialOrder,
        Self::LargeSpheres,
        Self::LongMovers,
        Self::SweepsAtOnce,
    ];
}

/// Options that stay the same for the whole life of a simulation.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// The backend that runs the simulation.
    pub backend: Backend,
    /// The number of the GPU, from 0, in the list of [`devices`](crate::devices()); `None` for the best one.
    pub device: Option<usize>,
    /// The integrator. By default it is that of [`Scene::run`](crate::Scene::run), or follows from the contact law
    /// ([`IntegratorChoice::Auto`]).
    pub integrator: IntegratorChoice,
    /// The method that finds pairs of objects that may touch.
    pub broad_phase: BroadPhase,
    /// Initial capacity of the pair lists, in 32-bit words of entries. The lists grow as needed.
    pub pair_capacity: Option<u32>,
    /// Whether the simulation continues when the state of a body stops being finite. The body is then stopped at its last
    /// position and counted in [`Report::non_finite`](crate::Report::non_finite).
    pub keep_going: bool,
    /// Optimizations that the simulation leaves out. This does not change results.
    pub without: Vec<Optimization>,
    /// Forces that the program defines, in the order in which they act.
    pub force_laws: Vec<ForceLaw>,
    /// The contact law that the program defines, for the setting `contact_law user`.
    pub contact_force_law: Option<ContactForceLaw>,
}

impl Options {
    /// Creates the default options.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets the backend.
    pub fn backend(mut self, backend: Backend) -> Self {
        self.backend = backend;
        self
    }

    /// Chooses a GPU by its number in the list of [`devices`](crate::devices()). [`Backend::Auto`] becomes [`Backend::Gpu`].
    pub fn device(mut self, number: usize) -> Self {
        self.device = Some(number);
        if self.backend == Backend::Auto {
            self.backend = Backend::Gpu;
        }
        self
    }

    /// Sets the integrator.
    pub fn integrator(mut self, integrator: impl Into<IntegratorChoice>) -> Self {
        self.integrator = integrator.into();
        self
    }

    /// Sets the method that finds pairs.
    pub fn broad_phase(mut self, broad_phase: BroadPhase) -> Self {
        self.broad_phase = broad_phase;
        self
    }

    /// Sets the initial capacity of the pair lists, in 32-bit words of entries.
    pub fn pair_capacity(mut self, words: u32) -> Self {
        self.pair_capacity = Some(words);
        self
    }

    /// Leaves out an optimization. May be called several times.
    pub fn without(mut self, optimization: Optimization) -> Self {
        self.without.push(optimization);
        self
    }

    /// Adds a force that the program defines. May be called several times.
    pub fn force_law(mut self, law: ForceLaw) -> Self {
        self.force_laws.push(law);
        self
    }

    /// Gives the contact law that the program defines. A simulation of a scene with another contact law then does as if the scene
    /// had `set contact_law user`, which also switches collisions off.
    pub fn contact_force_law(mut self, law: ContactForceLaw) -> Self {
        self.contact_force_law = Some(law);
        self
    }

    /// Whether the simulation uses an optimization where it applies.
    pub fn uses(&self, optimization: Optimization) -> bool {
        !self.without.contains(&optimization)
    }

    /// Sets whether the simulation continues when the state of a body stops being finite.
    pub fn keep_going(mut self, keep_going: bool) -> Self {
        self.keep_going = keep_going;
        self
    }
}

/// The backend that a simulation runs on.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BackendInfo {
    /// [`Backend::Gpu`] or [`Backend::Cpu`].
    pub kind: Backend,
    /// The device's name, for example `NVIDIA H200 (Vulkan)` or `CPU, 8 threads`.
    pub device: String,
    /// Driver and its version; empty on the CPU.
    pub driver: String,
    /// The reason for the choice.
    pub reason: String,
}
