//! What a simulation runs on, and how.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result, quoted};
use crate::settings::{BroadPhase, Integrator};

/// Where a simulation runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Backend {
    /// A hardware GPU where there is one, else the CPU.
    #[default]
    Auto,
    /// A GPU, software Vulkan included.
    Gpu,
    /// The CPU, on all its threads.
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

/// Choices that hold for a simulation's whole life.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Options {
    /// Where it runs.
    pub backend: Backend,
    /// How it advances.
    pub integrator: Integrator,
    /// How it finds pairs.
    pub broad_phase: BroadPhase,
    /// Words that the entries of the pair lists may take at the start; they grow as needed.
    pub pair_capacity: Option<u32>,
    /// Go on when a body's state stops being finite: it is stopped where it was and counted in the report.
    pub keep_going: bool,
    /// Whether small scenes without rods run whole steps in one dispatch on a GPU, which changes no result. `None`: where it is
    /// faster, which it is on all but software.
    pub join_steps: Option<bool>,
}

impl Options {
    /// The defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sets where it runs.
    pub fn backend(mut self, backend: Backend) -> Self {
        self.backend = backend;
        self
    }

    /// Sets how it advances.
    pub fn integrator(mut self, integrator: Integrator) -> Self {
        self.integrator = integrator;
        self
    }

    /// Sets how it finds pairs.
    pub fn broad_phase(mut self, broad_phase: BroadPhase) -> Self {
        self.broad_phase = broad_phase;
        self
    }

    /// Sets how many words the entries of the pair lists may take at the start.
    pub fn pair_capacity(mut self, words: u32) -> Self {
        self.pair_capacity = Some(words);
        self
    }

    /// Sets whether small scenes run whole steps in one dispatch.
    pub fn join_steps(mut self, join: bool) -> Self {
        self.join_steps = Some(join);
        self
    }

    /// Sets whether to go on when a body's state stops being finite.
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
    /// Why it was chosen.
    pub reason: String,
}
