//! Long calls in portions, between which signals are handled.

use std::time::{Duration, Instant};

use pyo3::prelude::*;

/// Time after which a run looks for signals such as Ctrl-C.
pub(crate) const PATIENCE: Duration = Duration::from_millis(50);

/// What stops a call on all processes. The greatest of all processes counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stop {
    No,
    Interrupt,
    Failure,
}

/// Calls a function with numbers of steps that take about [`PATIENCE`], and handles signals in between.
pub(crate) fn in_portions(py: Python<'_>, steps: u64, mut run: impl FnMut(u64) -> PyResult<()>) -> PyResult<()> {
    let (mut left, mut portion) = (steps, 16);
    while left > 0 {
        let count = left.min(portion);
        let start = Instant::now();
        run(count)?;
        left -= count;
        portion = next_portion(portion, start.elapsed());
        py.check_signals()?;
    }
    Ok(())
}

/// The number of steps after a portion that took a time.
pub(crate) fn next_portion(portion: u64, taken: Duration) -> u64 {
    if taken < PATIENCE / 2 {
        portion.saturating_mul(2)
    } else if taken > PATIENCE {
        (portion / 2).max(1)
    } else {
        portion
    }
}
