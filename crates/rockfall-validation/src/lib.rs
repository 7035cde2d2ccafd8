//! rockfall held against theory.
//!
//! An [`Experiment`] computes something of which theory knows the outcome, and says how far the two may lie apart. The tests run
//! every experiment and fail where a bound is exceeded; `cargo xtask validate` runs the same code, longer where that shows more,
//! and writes `docs/validation.md` with the numbers and plots that it found.

mod chart;
mod experiments;
mod measure;
mod number;
mod outcome;
mod page;

pub use chart::{Axis, Chart, Mark};
pub use experiments::{ALL, Experiment};
pub use outcome::{Check, Outcome};
pub use page::{page, section};

/// What an experiment fails with.
pub type Error = Box<dyn std::error::Error + Send + Sync>;
/// The result of an experiment.
pub type Result<T> = std::result::Result<T, Error>;

/// How much an experiment may compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Some seconds: enough for the bounds.
    Test,
    /// As much as the page shows.
    Page,
}

impl Effort {
    /// One of two, by effort.
    pub fn pick<T>(self, test: T, page: T) -> T {
        match self {
            Self::Test => test,
            Self::Page => page,
        }
    }
}
