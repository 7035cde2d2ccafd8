//! Results of an experiment.

use std::fmt::Write as _;

use crate::chart::Chart;
use crate::number::digits;

/// A measured number and the value that theory gives for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// Name of the quantity, with its unit.
    pub what: String,
    /// Value from theory.
    pub theory: f64,
    /// Measured value.
    pub measured: f64,
    /// Largest allowed difference between the two.
    pub bound: f64,
}

impl Check {
    /// Returns whether the difference is within the bound.
    pub fn holds(&self) -> bool {
        (self.measured - self.theory).abs() <= self.bound
    }
}

/// Numbers and plots of an experiment.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Comparisons with theory.
    pub checks: Vec<Check>,
    /// Plots, in the order of the page.
    pub charts: Vec<Chart>,
    /// Values for the text of the page, with the names that the text has in double braces.
    pub facts: Vec<(&'static str, String)>,
}

impl Outcome {
    /// Adds a comparison with theory. The two values may differ by `bound`.
    pub fn check(&mut self, what: impl Into<String>, theory: f64, measured: f64, bound: f64) {
        self.checks.push(Check { what: what.into(), theory, measured, bound });
    }

    /// Adds a number for the text of the page.
    pub fn fact(&mut self, name: &'static str, number: f64) {
        self.facts.push((name, digits(number)));
    }

    /// Describes the checks that do not hold, one per line. Empty if all hold.
    pub fn failures(&self) -> String {
        let mut text = String::new();
        for Check { what, theory, measured, bound } in self.checks.iter().filter(|check| !check.holds()) {
            let _ = writeln!(text, "{what}: {measured}, expected {theory} within {bound}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_holds_within_its_bound_and_fails_for_nan() {
        let check = |measured| Check { what: String::new(), theory: 1.0, measured, bound: 0.5 };
        assert!(check(1.5).holds() && check(0.5).holds());
        assert!(!check(1.6).holds() && !check(f64::NAN).holds());
        let mut outcome = Outcome::default();
        outcome.check("a speed", 1.0, 1.2, 0.5);
        assert_eq!(outcome.failures(), "");
        outcome.check("a length", 1.0, 2.0, 0.5);
        assert_eq!(outcome.failures(), "a length: 2, expected 1 within 0.5\n");
    }
}
