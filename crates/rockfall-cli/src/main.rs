//! The command line of rockfall: it parses, calls the library and prints.

use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

mod bench;
mod check;
mod devices;
mod failure;
mod generate;
mod interrupt;
mod options;
mod output;
mod picture;
mod progress;
#[cfg(feature = "view")]
mod render;
mod run;
mod shell;
mod source;
mod summary;
#[cfg(feature = "window")]
mod view;

/// A rigid-body physics engine that lives on the GPU.
#[derive(Debug, Parser)]
#[command(
    name = "rockfall",
    version = env!("ROCKFALL_VERSION"),
    disable_help_subcommand = true,
    after_help = "Exit code: 0 done, 1 the run failed, 2 wrong usage or a bad scene, 130 a run that Ctrl-C or SIGTERM ended."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene and tell what became of it.
    Run(run::Arguments),
    /// Read a scene: count its objects, tell what is odd, and whether the time step is short enough.
    Check(check::Arguments),
    /// Measure how fast steps are, stage by stage.
    Bench(bench::Arguments),
    /// List the devices that a scene can run on.
    Devices,
    /// Make a scene of any size.
    Generate(generate::Arguments),
    /// Draw a scene into a file.
    #[cfg(feature = "view")]
    Render(render::Arguments),
    /// Open a window on a scene: look, play, change constants; F1 shows the keys.
    #[cfg(feature = "window")]
    View(view::Arguments),
    /// Print a script that completes commands and options in a shell.
    Completions(shell::Completions),
    /// Print a manual page, in roff.
    Man(shell::Manual),
}

fn main() -> ExitCode {
    let matches = Arguments::command().get_matches();
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    let given = run::Given(matches.subcommand().map_or(&matches, |(_, matches)| matches));
    let result = match arguments.command {
        Command::Run(arguments) => run::run(&arguments, &given),
        Command::Check(arguments) => check::check(&arguments),
        Command::Bench(arguments) => bench::bench(&arguments),
        Command::Devices => devices::devices(),
        Command::Generate(arguments) => generate::generate(&arguments),
        #[cfg(feature = "view")]
        Command::Render(arguments) => render::render(&arguments),
        #[cfg(feature = "window")]
        Command::View(arguments) => view::view(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man(arguments) => shell::manual(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => output::report(failure),
    }
}
