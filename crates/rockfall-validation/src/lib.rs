//! Validation of rockfall against theory.
//!
//! An [`Experiment`] computes quantities for which theory gives an expected value, and sets a bound on each difference. The
//! tests run every experiment and fail if a bound is exceeded. `cargo xtask validate` runs the same code, in a longer form
//! where that shows more, and writes `docs/validation.md` with the resulting numbers and plots.

mod chart;
mod experiments;
mod granular;
mod measure;
mod number;
mod outcome;
mod page;

pub use chart::{Axis, Chart, Mark};
pub use experiments::{ALL, Experiment};
pub use outcome::{Check, Outcome};
pub use page::{page, section};

/// Error of an experiment.
pub type Error = Box<dyn std::error::Error + Send + Sync>;
/// Result of an experiment.
pub type Result<T> = std::result::Result<T, Error>;

/// Amount of computation in an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Some seconds: enough to check the bounds.
    Test,
    /// The full experiment, as shown on the page.
    Page,
}

impl Effort {
    /// Returns the value for this effort.
    pub fn pick<T>(self, test: T, page: T) -> T {
        match self {
            Self::Test => test,
            Self::Page => page,
        }
    }
}
