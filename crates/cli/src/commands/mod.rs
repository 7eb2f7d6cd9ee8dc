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
pub(crate) use identify::{History, LeftOut};
pub(crate) use reproduce::{Drawing, Section, Table};

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
        Command::Evaluate(args) => evaluate::run(args),
        Command::Reproduce(args) => reproduce::run(args),
        Command::Completions(args) => completions::run(args),
        Command::Man => man::run(),
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
