//! The command line of rockfall: parses arguments, calls the library and prints results.

use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

mod aftermath;
mod bench;
mod check;
mod devices;
mod evolve;
mod failure;
mod fields;
mod files;
mod generate;
mod hints;
mod import;
#[cfg(feature = "view")]
mod input;
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

/// Rigid-body physics engine that runs on the GPU or the CPU.
#[derive(Debug, Parser)]
#[command(
    name = "rockfall",
    version = env!("ROCKFALL_VERSION"),
    after_help = "Exit codes: 0 success, 1 the run failed, 2 wrong usage or a bad scene, 130 interrupted by Ctrl-C or SIGTERM."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate a scene and print a summary.
    Run(run::Arguments),
    /// Check a scene: count its objects, warn of suspicious lines and report whether the time step is short enough.
    Check(check::Arguments),
    /// Measure the speed of steps and of their stages.
    Bench(bench::Arguments),
    /// Evolve creatures that walk, run, jump or climb.
    Evolve(evolve::Arguments),
    /// List the devices that a scene can run on.
    Devices,
    /// Generate a scene of any size.
    Generate(generate::Arguments),
    /// Import a robot of a URDF or MJCF file as a scene.
    Import(import::Arguments),
    /// Compute density, velocity, stress and temperature on a grid from a state.
    Fields(fields::Arguments),
    /// Write a picture or a film of a scene, a checkpoint or a trajectory to a file.
    #[cfg(feature = "view")]
    Render(render::Arguments),
    /// Show a scene, a checkpoint or a trajectory in a window and interact with it; F1 lists the keys.
    #[cfg(feature = "window")]
    View(view::Arguments),
    /// Print a script that completes commands and options in a shell.
    Completions(shell::Completions),
    /// Print a manual page, in roff.
    Man(shell::Manual),
}

fn main() -> ExitCode {
    let mut command = Arguments::command();
    let matches = command.try_get_matches_from_mut(std::env::args_os()).unwrap_or_else(|mut error| {
        let words: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
        hints::add(&mut error, &command, &words);
        error.exit()
    });
    let arguments = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    // In all commands: exit code 130 does not depend on what a command does.
    let interrupt = interrupt::Interrupt::listen();
    let given = run::Given(matches.subcommand().map_or(&matches, |(_, matches)| matches));
    let result = match arguments.command {
        Command::Run(arguments) => run::run(&arguments, &given, interrupt),
        Command::Check(arguments) => check::check(&arguments),
        Command::Bench(arguments) => bench::bench(&arguments),
        Command::Evolve(arguments) => evolve::evolve(&arguments, interrupt),
        Command::Devices => devices::devices(),
        Command::Generate(arguments) => generate::generate(&arguments),
        Command::Import(arguments) => import::import(&arguments),
        Command::Fields(arguments) => fields::fields(&arguments),
        #[cfg(feature = "view")]
        Command::Render(arguments) => render::render(&arguments, &given, interrupt),
        #[cfg(feature = "window")]
        Command::View(arguments) => view::view(&arguments, &given),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man(arguments) => shell::manual(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => output::report(failure),
    }
}
