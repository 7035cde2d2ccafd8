//! Shell completions and manual pages.

use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

use crate::failure::Failure;
use crate::output;

/// Options of `completions`.
#[derive(Debug, Args)]
#[command(after_help = "Example: rockfall completions bash > ~/.local/share/bash-completion/completions/rockfall")]
pub(crate) struct Completions {
    /// Shell that the script is for
    shell: Shell,
}

/// Options of `man`.
#[derive(Debug, Args)]
#[command(after_help = "Example: rockfall man run > rockfall-run.1")]
pub(crate) struct Manual {
    /// Command that the page describes [default: the whole program]
    command: Option<String>,
}

/// Prints a script that completes commands and options.
pub(crate) fn completions(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut crate::Arguments::command(), "rockfall", &mut script);
    output::print(&String::from_utf8_lossy(&script))
}

/// Prints a manual page, in roff.
pub(crate) fn manual(arguments: &Manual) -> Result<(), Failure> {
    let mut program = crate::Arguments::command();
    program.build();
    let command = match &arguments.command {
        None => program,
        Some(name) => program.find_subcommand(name).cloned().ok_or_else(|| {
            let known: Vec<&str> = program.get_subcommands().map(clap::Command::get_name).collect();
            Failure::usage(format!("unknown command {name}: expected one of {}", known.join(", ")))
        })?,
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(command)
        .render(&mut page)
        .map_err(|error| Failure::Run(format!("the manual page cannot be written: {error}")))?;
    output::print(&String::from_utf8_lossy(&page))
}
