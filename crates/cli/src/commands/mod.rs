//! What each command does.
mod completions;
mod demo;
mod evaluate;
mod fit;
mod identify;
mod man;
mod outline;
mod reproduce;
mod simulate;
mod track;

pub(crate) use evaluate::{Acquisition, Evaluation, Found, MethodResult, Report, Setting, Statistics};
pub(crate) use fit::{FittedOutline, Parts};
pub(crate) use reproduce::{Drawing, Section, Table};

use crate::args::{Cli, Command};
use crate::failure::Failure;
use crate::interrupt;

/// Runs the command that was asked for.
pub(crate) fn run(cli: &Cli) -> Result<(), Failure> {
    interrupt::leave_nothing_unfinished();
    match &cli.command {
        Command::Demo(args) => demo::run(args),
        Command::Simulate(args) => simulate::run(args),
        Command::Fit(args) => fit::run(args),
        Command::Identify(args) => identify::run(args),
        Command::Track(args) => track::run(args),
        Command::Outline(args) => outline::run(args),
        Command::Evaluate(args) => evaluate::run(args),
        Command::Reproduce(args) => reproduce::run(args),
        Command::Completions(args) => completions::run(args),
        Command::Man => man::run(),
    }
}

/// The command line as it could be typed again.
fn command_line() -> String {
    let arguments = std::env::args_os().skip(1).map(|argument| quoted(&argument.to_string_lossy()));
    std::iter::once("freeform".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// An argument as it could be typed.
pub(crate) fn quoted(argument: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=:+@%".contains(c);
    if !argument.is_empty() && argument.chars().all(is_plain) {
        argument.to_owned()
    } else {
        format!("'{}'", argument.replace('\'', r"'\''"))
    }
}
