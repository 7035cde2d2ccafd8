//! Adds hints to errors of the command line: what the user most likely wanted to write.

use std::path::Path;

use clap::Command;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use rockfall::{Look, Settings};

/// Adds a hint to an error about `arguments`, the words after the name of the program.
pub(crate) fn add(error: &mut Error, command: &Command, arguments: &[String]) {
    let Some(ContextValue::String(word)) =
        error.get(ContextKind::InvalidArg).or_else(|| error.get(ContextKind::InvalidSubcommand)).cloned()
    else {
        return;
    };
    let hint = match error.kind() {
        ErrorKind::InvalidSubcommand => left_out(&word).or_else(|| scene(&word)),
        ErrorKind::UnknownArgument => of_argument(&word, command, arguments),
        _ => None,
    };
    if let Some(hint) = hint {
        error.remove(ContextKind::SuggestedArg);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![StyledStr::from(hint)]));
    }
}

/// How to get a command that this program was built without.
fn left_out(word: &str) -> Option<String> {
    let is_missing = word == "view" && cfg!(not(feature = "window")) || word == "render" && cfg!(not(feature = "view"));
    is_missing.then(|| format!("this program was built without '{word}': build it with its default features"))
}

/// The command that runs a scene whose name stands in the place of a command.
fn scene(word: &str) -> Option<String> {
    let path = Path::new(word);
    let is_scene = path.is_file() || path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("txt"));
    is_scene.then(|| format!("to run this scene, use 'rockfall run {word}'"))
}

fn of_argument(word: &str, command: &Command, arguments: &[String]) -> Option<String> {
    // The word without its value, in the place where it was found.
    let at = arguments.iter().position(|argument| argument.split('=').next() == Some(word));
    let value = at.and_then(|at| {
        let own = arguments[at].split_once('=').map(|(_, value)| value);
        own.or_else(|| arguments.get(at + 1).map(String::as_str)).filter(|value| value.parse::<f64>().is_ok())
    });
    if word == "--look" {
        let value =
            at.and_then(|at| arguments[at].split_once('=').map(|(_, value)| value).or(arguments.get(at + 1).map(|x| &**x)));
        let name = value.filter(|value| Look::ALL.iter().any(|look| look.to_string() == **value)).unwrap_or("NAME");
        return Some(format!("looks are in the scene: a line '@look {name}' above the objects"));
    }
    if let Some(name) = word.strip_prefix("--") {
        return constant(name, value.unwrap_or("VALUE")).or_else(|| time(name));
    }
    if word.starts_with('-') {
        let long = arguments.iter().filter_map(|argument| long_option(argument.strip_prefix('-')?, command));
        return long.map(|name| format!("options of several letters begin with two dashes: '--{name}'")).next();
    }
    // The value of `--set NAME VALUE`.
    let before = arguments.get(at?.checked_sub(2)?..at?)?;
    (before[0] == "--set").then(|| format!("a constant is set with NAME=VALUE: '--set {}={word}'", before[1]))
}

fn constant(name: &str, value: &str) -> Option<String> {
    let name = name.replace('-', "_");
    Settings::NAMES.contains(&name.as_str()).then(|| format!("{name} is a constant: '--set {name}={value}'"))
}

fn time(name: &str) -> Option<String> {
    let is_time = ["time", "duration", "seconds", "t-end", "end-time"].contains(&name);
    is_time.then(|| "the simulated time is '--steps <N>' times '--dt <S>'".to_owned())
}

/// The long option that a word names, of any command.
fn long_option(word: &str, command: &Command) -> Option<String> {
    let name = word.split('=').next().filter(|name| name.len() > 1)?;
    let known = |command: &Command| command.get_arguments().any(|argument| argument.get_long() == Some(name));
    (known(command) || command.get_subcommands().any(known)).then(|| name.to_owned())
}
