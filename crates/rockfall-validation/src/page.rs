//! Text of the page: the description, the numbers and the plots of each experiment.

use std::fmt::Write as _;

use crate::experiments::Experiment;
use crate::number::digits;
use crate::outcome::Outcome;
use crate::{Error, Result};

/// Returns the section of an experiment: its text with the facts filled in, a table of its checks, and its plots.
///
/// # Errors
/// Returns an error if the text names a fact that the experiment does not provide.
pub fn section(experiment: &Experiment, outcome: &Outcome) -> Result<String> {
    let mut text = format!("## {}\n\n{}", experiment.title, experiment.text.trim_end());
    for (name, value) in &outcome.facts {
        text = text.replace(&format!("{{{{{name}}}}}"), value);
    }
    if let Some(at) = text.find("{{") {
        let unknown: String = text[at..].chars().take(30).collect();
        return Err(Error::from(format!("experiments/{}.md: no fact with the name in '{unknown}'", experiment.name)));
    }
    text.push_str("\n\n| quantity | theory | measured | bound |\n|---|---|---|---|\n");
    for check in &outcome.checks {
        let [theory, measured, bound] = [check.theory, check.measured, check.bound].map(digits);
        let _ = writeln!(text, "| {} | {theory} | {measured} | ±{bound} |", check.what);
    }
    for chart in &outcome.charts {
        let _ = write!(text, "\n![{}](validation/{}.svg)\n", chart.title, chart.name);
    }
    Ok(text)
}

/// Returns the whole page from its sections in order.
pub fn page(sections: &[String]) -> String {
    format!("{}\n{}", include_str!("page.md"), sections.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn experiment(text: &'static str) -> Experiment {
        Experiment { name: "fall", title: "Fall", text, run: |_| Ok(Outcome::default()) }
    }

    #[test]
    fn facts_and_checks_are_filled_in() {
        let mut outcome = Outcome::default();
        outcome.fact("height", 2.5);
        outcome.check("time (s)", 1.0, 1.25, 0.5);
        let text = section(&experiment("From {{height}} units.\n"), &outcome).unwrap();
        assert!(text.starts_with("## Fall\n\nFrom 2.5 units.\n\n|"), "{text}");
        assert!(text.contains("| time (s) | 1 | 1.25 | ±0.5 |"), "{text}");
    }

    #[test]
    fn a_missing_fact_is_an_error() {
        let error = section(&experiment("From {{height}} units."), &Outcome::default()).unwrap_err();
        assert!(error.to_string().contains("{{height}}"), "{error}");
    }
}
