//! The line `@run`.

use std::str::FromStr;

use super::Reader;
use super::line::{Line, RUN, Wrong};
use crate::error::{Error, nearest, quoted};
use crate::scene::run::{FROM_ONE, PARTS, RunDefaults, SPEED, TIME_STEP};
use crate::settings::{ContactLaw, Integrator, IntegratorChoice};

const KEYS: [&str; 6] = ["dt", "integrator", "steps", "every", "substeps", "speed"];

impl Reader<'_> {
    pub(super) fn run(&mut self, line: &str, number: usize) -> Line<()> {
        let words: Vec<&str> = line.split_ascii_whitespace().skip(1).collect();
        if !words.iter().any(|word| word.contains('=')) {
            return self.not_understood(number, RUN.wrong("line", format!("no value, expected {}", RUN.form())));
        }
        if let Some(before) = self.run_at.replace(number) {
            return Err(RUN.wrong("line", format!("given again after line {before}, expected one @run line")));
        }
        words.into_iter().try_for_each(|word| read(word, &mut self.scene.run))
    }

    /// Checks the integrator when all settings are known. Returns the wrong line.
    pub(super) fn check_run(&self) -> Result<(), (usize, Wrong)> {
        let law = self.scene.settings.contact_law;
        match (self.run_at, self.scene.run.integrator) {
            (Some(line), Some(IntegratorChoice::Given(Integrator::Rk4))) if law.has_history() => Err((line, refused(law))),
            _ => Ok(()),
        }
    }
}

fn refused(law: ContactLaw) -> Wrong {
    RUN.wrong(
        "integrator",
        format!("rk4 is not possible with the contact law {law}, expected auto, symplectic-euler or velocity-verlet"),
    )
}

/// Reads a word KEY=VALUE.
fn read(word: &str, run: &mut RunDefaults) -> Line<()> {
    let Some((key, value)) = word.split_once('=') else {
        return Err(RUN.wrong(&quoted(word), format!("expected KEY=VALUE with a key of {}", KEYS.join(", "))));
    };
    match key {
        "dt" => put(&mut run.dt, key, value, TIME_STEP, |dt: &f32| dt.is_finite() && *dt > 0.0),
        "integrator" => {
            let known = value.parse().map_err(|error| match error {
                Error::Invalid { expected, .. } => {
                    RUN.wrong(key, format!("{} is not allowed, expected {expected}", quoted(value)))
                }
                other => RUN.wrong(key, other.to_string()),
            });
            once(&mut run.integrator, key, known?)
        }
        "steps" => put(&mut run.steps, key, value, FROM_ONE, |steps| *steps > 0),
        "every" => put(&mut run.every, key, value, FROM_ONE, |every| *every > 0),
        // The solver of the contact law `rigid` chooses.
        "substeps" if value == "auto" => Ok(()),
        "substeps" => put(&mut run.substeps, key, value, PARTS, |parts| (1..=RunDefaults::MAX_SUBSTEPS).contains(parts)),
        "speed" => put(&mut run.speed, key, value, SPEED, |speed: &f64| speed.is_finite() && *speed > 0.0),
        _ => {
            let known = || format!("expected one of {}", KEYS.join(", "));
            let hint = nearest(key, &KEYS).map_or_else(known, |near| format!("did you mean {near}?"));
            Err(RUN.wrong(&quoted(key), format!("an unknown key, {hint}")))
        }
    }
}

fn put<T: FromStr>(place: &mut Option<T>, key: &str, value: &str, expected: &str, is_allowed: impl Fn(&T) -> bool) -> Line<()> {
    match value.parse().ok().filter(is_allowed) {
        Some(number) => once(place, key, number),
        None => Err(RUN.wrong(key, format!("{} is not allowed, expected {expected}", quoted(value)))),
    }
}

fn once<T>(place: &mut Option<T>, key: &str, value: T) -> Line<()> {
    match place.replace(value) {
        None => Ok(()),
        Some(_) => Err(RUN.wrong(key, "given twice in the line")),
    }
}

#[cfg(test)]
#[path = "run_tests.rs"]
mod tests;
