//! What each command does.
mod completions;
mod demo;
mod fit;
mod identify;
mod outline;
mod simulate;
mod track;

pub(crate) use fit::{FittedOutline, Parts};
pub(crate) use identify::History;

use crate::args::{Cli, Command};
use crate::failure::Failure;

/// Runs the command that was asked for.
pub(crate) fn run(cli: &Cli) -> Result<(), Failure> {
    match &cli.command {
        Command::Demo(args) => demo::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Fit(args) => fit::run(args),
        Command::Identify(args) => identify::run(args),
        Command::Track(args) => track::run(args),
        Command::Outline(args) => outline::run(args),
        Command::Completions(args) => completions::run(args),
    }
}

/// The command line as it could be typed again.
fn command_line() -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:+@%".contains(c);
    let quote = |argument: String| {
        if !argument.is_empty() && argument.chars().all(plain) {
            argument
        } else {
            format!("'{}'", argument.replace('\'', r"'\''"))
        }
    };
    let arguments = std::env::args_os().skip(1).map(|argument| quote(argument.to_string_lossy().into_owned()));
    std::iter::once("freeform".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}
