//! `cargo xtask validate` writes `docs/validation.md` and its plots. `cargo xtask web` builds the page of the browser.
//! `cargo xtask public-api` compares the public API with its listings.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use rockfall_validation::{ALL, Effort, Experiment, Outcome, Result, page, section};

mod public_api;
mod web;

/// Tasks of the project.
#[derive(Parser)]
#[command(name = "cargo xtask")]
enum Task {
    /// Compares the engine with theory and writes docs/validation.md; takes some minutes
    Validate {
        /// Run only these experiments, print their sections and write their plots; the page is left unchanged
        names: Vec<String>,
        /// Folder for the page and its plots
        #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs"))]
        out: PathBuf,
    },
    /// Builds the page of the browser, see docs/browser.md
    Web {
        /// Folder to write, which is replaced
        #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/dist"))]
        out: PathBuf,
        /// Take the development profile, which is optimised less: a quicker build of a larger page, for tests
        #[arg(long)]
        dev: bool,
    },
    /// Compares the public API of every published library with its listing, crates/NAME/public-api.txt
    PublicApi {
        /// Write the listings anew
        #[arg(long)]
        update: bool,
    },
}

fn main() -> ExitCode {
    match Task::parse() {
        Task::Validate { names, out } => validation(&names, &out),
        Task::Web { out, dev } => exit_code(web::build(&out, dev).map(|()| true)),
        Task::PublicApi { update } => exit_code(public_api::check(update)),
    }
}

/// Prints the error of a task, if it failed. `Ok(false)` is a failure that the task has reported.
fn exit_code(done: Result<bool>) -> ExitCode {
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn validation(names: &[String], out: &Path) -> ExitCode {
    let unknown = names.iter().find(|name| !ALL.iter().any(|experiment| experiment.name == *name));
    if let Some(unknown) = unknown {
        let known: Vec<&str> = ALL.iter().map(|experiment| experiment.name).collect();
        eprintln!("error: unknown experiment '{unknown}'; expected one or more of: {}", known.join(", "));
        return ExitCode::from(2);
    }
    exit_code(validate(names, out))
}

/// Runs the experiments and writes the results. Returns whether every check holds.
fn validate(names: &[String], out: &Path) -> Result<bool> {
    fs::create_dir_all(out.join("validation"))?;
    let mut sections = Vec::new();
    let mut all_hold = true;
    for experiment in ALL.iter().filter(|experiment| names.is_empty() || names.iter().any(|name| name == experiment.name)) {
        let start = Instant::now();
        let outcome = (experiment.run)(Effort::Page)?;
        eprintln!("{:12} {:6.1} s", experiment.name, start.elapsed().as_secs_f64());
        let failures = outcome.failures();
        if !failures.is_empty() {
            eprint!("{failures}");
            all_hold = false;
        }
        plot(experiment, &outcome, out)?;
        let section = section(experiment, &outcome)?;
        if !names.is_empty() {
            println!("{section}");
        }
        sections.push(section);
    }
    if names.is_empty() {
        fs::write(out.join("validation.md"), page(&sections))?;
    }
    Ok(all_hold)
}

fn plot(experiment: &Experiment, outcome: &Outcome, out: &Path) -> Result<()> {
    for chart in &outcome.charts {
        let svg = chart.svg().map_err(|error| format!("{}: {error}", experiment.name))?;
        fs::write(out.join("validation").join(chart.name).with_extension("svg"), svg)?;
    }
    Ok(())
}
